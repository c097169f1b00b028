// SPDX-License-Identifier: Apache-2.0
#include "trim/trim_offset.h"

#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "ground/numbers/disjoint_sets.h"
#include "judge/soup.h"
#include "offset/offset_surface.h"
#include "trim/cut_faces.h"
#include "trim/join_pieces.h"
#include "trim/point_in_face.h"

namespace vdb_offset::cad {
namespace {

// Points of a piece that are held against the source, and what share of the distance is enough: to both sides of a cut
// distances part slowly where faces are nearly parallel.
constexpr std::size_t kPointsOfPiece = 8;
constexpr double kEnough = 0.995;

// Whether a piece is at the distance from the source, by most of its points.
bool is_at_distance(const FacePiece& piece, const Soup& source, double far) {
  const Handle(Geom_Surface) surface = surface_of(piece.face);
  const std::vector<gp_Pnt2d> points = points_in_face(piece.face, kPointsOfPiece);
  const auto good = std::count_if(points.begin(), points.end(), [&](const gp_Pnt2d& uv) {
    return source.closest(surface->Value(uv.X(), uv.Y())).distance > kEnough * far;
  });
  return 2 * static_cast<std::size_t>(good) > points.size();
}

// Faces that hang together by edges, as shells; none if an edge has not two faces that run against each other.
std::vector<TopoDS_Shell> closed_shells(const std::vector<FacePiece>& pieces) {
  TopTools_IndexedMapOfShape edges;
  std::vector<std::array<int, 2>> faces_of;  // by edge: those that have it forward and reversed
  DisjointSets groups(pieces.size());
  for (int i = 0; i < static_cast<int>(pieces.size()); i++)
    for (TopExp_Explorer e(pieces[i].face, TopAbs_EDGE); e.More(); e.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
      const std::size_t edge = static_cast<std::size_t>(edges.Add(e.Current())) - 1;
      if (edge >= faces_of.size()) faces_of.push_back({-1, -1});
      int& face = faces_of[edge][e.Current().Orientation() == TopAbs_REVERSED];
      if (face >= 0) return {};
      face = i;
    }
  for (const std::array<int, 2>& two : faces_of) {
    if (two[0] < 0 || two[1] < 0) return {};
    groups.join(static_cast<std::uint32_t>(two[0]), static_cast<std::uint32_t>(two[1]));
  }
  std::vector<TopoDS_Shell> shells(pieces.size());
  for (int i = 0; i < static_cast<int>(pieces.size()); i++) {
    TopoDS_Shell& shell = shells[groups.first(static_cast<std::uint32_t>(i))];
    if (shell.IsNull()) BRep_Builder().MakeShell(shell);
    BRep_Builder().Add(shell, pieces[i].face);
    shell.Closed(true);
  }
  shells.erase(std::remove_if(shells.begin(), shells.end(), [](const TopoDS_Shell& s) { return s.IsNull(); }),
               shells.end());
  return shells;
}

double volume_in(const TopoDS_Shell& shell) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shell, properties);
  return properties.Mass();
}

// A solid of one shell that encloses it and others that are cavities; null if they are more than one body.
TopoDS_Shape solid_of(std::vector<TopoDS_Shell> shells) {
  const auto outer = std::partition(shells.begin(), shells.end(), [](const auto& s) { return volume_in(s) > 0; });
  if (outer - shells.begin() != 1) return {};
  TopoDS_Solid solid;
  BRep_Builder().MakeSolid(solid);
  for (const TopoDS_Shell& shell : shells) BRep_Builder().Add(solid, shell);
  return solid;
}

// Which pieces each face of the source is left with: nothing, a face, or a compound of some.
void report_pieces(const TopoDS_Shape& untrimmed, const std::vector<FacePiece>& pieces, OffsetCadResult& result) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(untrimmed, TopAbs_FACE, faces);
  for (std::size_t k = 0; k < result.made_of.size(); k++) {
    if (result.made_of[k].IsNull()) continue;
    const int number = faces.FindIndex(result.made_of[k]) - 1;
    std::vector<TopoDS_Face> left;
    for (const FacePiece& p : pieces)
      if (p.of == number) left.push_back(p.face);
    TopoDS_Compound several;
    if (left.size() > 1) BRep_Builder().MakeCompound(several);
    for (std::size_t i = 0; left.size() > 1 && i < left.size(); i++) BRep_Builder().Add(several, left[i]);
    result.made_of[k] = left.empty() ? TopoDS_Shape() : left.size() == 1 ? TopoDS_Shape(left.front()) : several;
    if (left.empty()) result.faces[k] = CadFace::Swallowed;
  }
}

}  // namespace

OffsetCadResult trim_offset(const TopoDS_Shape& source, OffsetCadResult offset, double distance) {
  const TopoDS_Shape untrimmed = offset.shape;
  const double far = std::abs(distance);
  const Soup soup(source, 0.01 * far, 0.05 * far, 0.25);
  std::vector<FacePiece> pieces = cut_faces(untrimmed);
  pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                              [&](const FacePiece& piece) { return !is_at_distance(piece, soup, far); }),
               pieces.end());
  join_pieces(pieces, 1e-3 * far);
  const std::vector<TopoDS_Shell> shells = closed_shells(pieces);
  offset.shape = shells.empty() ? TopoDS_Shape() : solid_of(shells);
  if (shells.empty()) offset.gaps.emplace_back("faces cross, and what is left of them is not closed");
  else if (offset.shape.IsNull()) offset.gaps.emplace_back("the offset falls apart");
  report_pieces(untrimmed, pieces, offset);
  return offset;
}

}  // namespace vdb_offset::cad
