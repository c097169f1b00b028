// SPDX-License-Identifier: Apache-2.0
#include "write/thick_solids.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>

namespace vdb_offset::cad {
namespace {

std::vector<TopoDS_Shape> shells_in(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> shells;
  for (TopExp_Explorer shell(shape, TopAbs_SHELL); shell.More(); shell.Next()) shells.push_back(shell.Current());
  return shells;
}

/// The solid between two shells around each other. The material of the thick solid lies outside of the source's where
/// the offset is the larger, around cavities as well.
TopoDS_Solid between(const TopoDS_Shape& larger, const TopoDS_Shape& smaller) {
  TopoDS_Solid solid;
  BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, larger);
  builder.Add(solid, smaller.Reversed());
  return solid;
}

/// What lies between the larger and the smaller faces of openings: in the surface of each, and looking as that does.
/// Openings side by side share the edges between their rims.
void find_rims(std::vector<Opening>& openings, bool is_outward) {
  TopTools_ListOfShape larger, smaller;
  for (const Opening& each : openings) {
    (is_outward ? smaller : larger).Append(each.source);
    for (TopExp_Explorer face(each.offset, TopAbs_FACE); face.More(); face.Next())
      (is_outward ? larger : smaller).Append(face.Current());
  }
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(larger);
  cut.SetTools(smaller);
  cut.Build();
  if (!cut.IsDone()) return;
  const auto add_rim = [&](const TopoDS_Shape& face, Opening& to) {
    for (TopTools_ListOfShape::Iterator rim(cut.Modified(face)); rim.More(); rim.Next())
      to.rim.push_back(TopoDS::Face(rim.Value().Oriented(to.source.Orientation())));
  };
  for (Opening& each : openings) {
    if (!is_outward) add_rim(each.source, each);
    for (TopExp_Explorer face(each.offset, TopAbs_FACE); is_outward && face.More(); face.Next())
      add_rim(face.Current(), each);
  }
}

/// A closed solid of the faces of two shells, but for openings, and their rims; null if that is not closed.
TopoDS_Shape joined(const TopoDS_Shape& larger, const TopoDS_Shape& smaller, const std::vector<Opening>& openings) {
  TopTools_MapOfShape open;
  for (const Opening& each : openings) {
    open.Add(each.source);
    for (TopExp_Explorer face(each.offset, TopAbs_FACE); face.More(); face.Next()) open.Add(face.Current());
  }
  TopoDS_Shell shell;
  BRep_Builder builder;
  builder.MakeShell(shell);
  const auto add_faces = [&](const TopoDS_Shape& from, bool is_turned) {
    for (TopExp_Explorer face(from, TopAbs_FACE); face.More(); face.Next())
      if (!open.Contains(face.Current())) builder.Add(shell, is_turned ? face.Current().Reversed() : face.Current());
  };
  add_faces(larger, false);
  add_faces(smaller, true);
  for (const Opening& each : openings)
    for (const TopoDS_Face& face : each.rim) builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  if (!shell.Closed()) return {};
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  return solid;
}

/// Which openings are in a shell.
std::vector<Opening> in_shell(const TopoDS_Shape& shell, const std::vector<Opening>& openings) {
  TopTools_MapOfShape faces;
  for (TopExp_Explorer face(shell, TopAbs_FACE); face.More(); face.Next()) faces.Add(face.Current());
  std::vector<Opening> found;
  for (const Opening& each : openings)
    if (faces.Contains(each.source)) found.push_back(each);
  return found;
}

}  // namespace

std::vector<TopoDS_Shape> thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward,
                                       std::vector<Opening>& openings) {
  const std::vector<TopoDS_Shape> from = shells_in(source), to = shells_in(offset);
  if (from.size() != to.size()) return {};
  if (!openings.empty()) find_rims(openings, is_outward);
  std::vector<TopoDS_Shape> solids;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const TopoDS_Shape &larger = is_outward ? to[i] : from[i], &smaller = is_outward ? from[i] : to[i];
    const std::vector<Opening> open = in_shell(from[i], openings);
    solids.push_back(open.empty() ? between(larger, smaller) : joined(larger, smaller, open));
    if (solids.back().IsNull()) return {};
  }
  return solids;
}

}  // namespace vdb_offset::cad
