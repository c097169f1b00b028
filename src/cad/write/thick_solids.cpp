// SPDX-License-Identifier: Apache-2.0
#include "write/thick_solids.h"

#include <BOPTools_AlgoTools.hxx>
#include <BRepAlgoAPI_BuilderAlgo.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>

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

/// Two shells of which the open faces lie in each other's surface, cut along each other's edges there.
class CutShells {
 public:
  CutShells(const TopoDS_Shape& larger, const TopoDS_Shape& smaller, const std::vector<Opening>& openings,
            ThickSolids& made)
      : larger_(larger), smaller_(smaller), openings_(openings), made_(made) {}

  /// The closed solids between the two, which go on in the surfaces of the open faces: there, they are what lies in one
  /// of the two faces alone. Walls that hang together nowhere are solids each. None if that does not close.
  /// \param is_outward whether the offset is the larger one
  std::vector<TopoDS_Shape> joined(bool is_outward) {
    TopTools_ListOfShape both;
    both.Append(larger_);
    both.Append(smaller_);
    cut_.SetArguments(both);
    cut_.SetNonDestructive(true);
    cut_.Build();
    if (!cut_.IsDone()) return {};
    builder_.MakeShell(shell_);
    TopTools_MapOfShape open;
    for (const Opening& each : openings_) {
      const std::vector<TopoDS_Face> of_source = faces_left(each.source), of_offset = faces_left(each.offset);
      add_rim(is_outward ? of_offset : of_source, is_outward ? of_source : of_offset, each);
      open.Add(each.source);
      for (TopExp_Explorer face(each.offset, TopAbs_FACE); face.More(); face.Next()) open.Add(face.Current());
    }
    for (const bool is_turned : {false, true})
      for (TopExp_Explorer face(is_turned ? smaller_ : larger_, TopAbs_FACE); face.More(); face.Next())
        if (!open.Contains(face.Current()))
          for (const TopoDS_Face& left : faces_left(face.Current())) add(left, is_turned, face.Current());
    if (!BRep_Tool::IsClosed(shell_)) return {};
    TopTools_ListOfShape parts;
    BOPTools_AlgoTools::MakeConnexityBlocks(shell_, TopAbs_EDGE, TopAbs_FACE, parts);
    std::vector<TopoDS_Shape> solids;
    for (const TopoDS_Shape& part : parts) solids.push_back(solid_of(part));
    return solids;
  }

 private:
  /// What faces have become, looking as these do.
  std::vector<TopoDS_Face> faces_left(const TopoDS_Shape& of) {
    std::vector<TopoDS_Face> left;
    for (TopExp_Explorer face(of, TopAbs_FACE); face.More(); face.Next()) {
      const TopTools_ListOfShape& pieces = cut_.Modified(face.Current());
      if (pieces.IsEmpty()) left.push_back(TopoDS::Face(face.Current()));
      for (const TopoDS_Shape& piece : pieces)
        left.push_back(TopoDS::Face(piece.Oriented(face.Current().Orientation())));
    }
    return left;
  }

  TopoDS_Solid solid_of(const TopoDS_Shape& faces) const {
    TopoDS_Shell shell;
    builder_.MakeShell(shell);
    for (TopExp_Explorer face(faces, TopAbs_FACE); face.More(); face.Next()) builder_.Add(shell, face.Current());
    shell.Closed(true);
    TopoDS_Solid solid;
    builder_.MakeSolid(solid);
    builder_.Add(solid, shell);
    return solid;
  }

  void add(const TopoDS_Face& face, bool is_turned, const TopoDS_Shape& original) {
    builder_.Add(shell_, is_turned ? face.Reversed() : TopoDS_Shape(face));
    if (!face.IsSame(original)) made_.cut.emplace_back(original, face);
  }

  void add_rim(const std::vector<TopoDS_Face>& of_larger, const std::vector<TopoDS_Face>& of_smaller,
               const Opening& opening) {
    const auto is_in = [](const TopoDS_Face& face, const std::vector<TopoDS_Face>& faces) {
      return std::any_of(faces.begin(), faces.end(), [&](const TopoDS_Face& each) { return each.IsSame(face); });
    };
    for (const bool is_turned : {false, true})
      for (const TopoDS_Face& face : is_turned ? of_smaller : of_larger)
        if (!is_in(face, is_turned ? of_larger : of_smaller)) add(face, is_turned, opening.source);
  }

  const TopoDS_Shape larger_, smaller_;
  const std::vector<Opening>& openings_;
  ThickSolids& made_;
  BRepAlgoAPI_BuilderAlgo cut_;
  BRep_Builder builder_;
  TopoDS_Shell shell_;
};

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

ThickSolids thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward,
                         const std::vector<Opening>& openings) {
  const std::vector<TopoDS_Shape> from = shells_in(source), to = shells_in(offset);
  ThickSolids made;
  for (std::size_t i = 0; i < from.size() && from.size() == to.size(); ++i) {
    const TopoDS_Shape &larger = is_outward ? to[i] : from[i], &smaller = is_outward ? from[i] : to[i];
    const std::vector<Opening> open = in_shell(from[i], openings);
    std::vector<TopoDS_Shape> solids;
    if (open.empty()) solids.push_back(between(larger, smaller));
    else solids = CutShells(larger, smaller, open, made).joined(is_outward);
    if (solids.empty()) return {};
    made.solids.insert(made.solids.end(), solids.begin(), solids.end());
  }
  return made;
}

}  // namespace vdb_offset::cad
