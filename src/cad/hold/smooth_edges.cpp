// SPDX-License-Identifier: Apache-2.0
#include "hold/smooth_edges.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <gp_Pnt2d.hxx>
#include <iterator>

#include "ground/numbers/disjoint_sets.h"
#include "offset/offset_surface.h"

namespace vdb_offset::cad {
namespace {

// Normals that are farther apart along an edge make it sharp, in radians. As in place.cpp.
constexpr double kSmoothBend = 0.06;
// Where along an edge that is looked at.
constexpr double kPlacesAlong[] = {0.03, 0.25, 0.5, 0.75, 0.97};

/// The normals of a face along an edge of it, towards the outside.
class NormalsAlong {
 public:
  NormalsAlong(const TopoDS_Edge& edge, const TopoDS_Face& face)
      : surface_(surface_of(face)), sign_(face.Orientation() == TopAbs_REVERSED ? -1 : 1) {
    curve_ = BRep_Tool::CurveOnSurface(edge, face, first_, last_);
    BRepTools::UVBounds(face, range_.u0, range_.u1, range_.v0, range_.v1);
  }
  bool are_known() const { return !curve_.IsNull(); }
  gp_Vec at(double part) const {
    const gp_Pnt2d uv = curve_->Value(first_ + part * (last_ - first_));
    return unit_normal(*surface_, uv.X(), uv.Y(), range_) * sign_;
  }

 private:
  Handle(Geom_Surface) surface_;
  Handle(Geom2d_Curve) curve_;
  Box2 range_{};
  double sign_, first_ = 0, last_ = 0;
};

bool is_smooth(const TopoDS_Edge& edge, const std::array<TopoDS_Face, 2>& faces) {
  const NormalsAlong a(edge, faces[0]), b(edge, faces[1]);
  if (!a.are_known() || !b.are_known()) return false;
  return std::all_of(std::begin(kPlacesAlong), std::end(kPlacesAlong), [&](double part) {
    const gp_Vec n = a.at(part), m = b.at(part);
    return n.Magnitude() < 0.5 || m.Magnitude() < 0.5 || n.Angle(m) < kSmoothBend;
  });
}

}  // namespace

std::vector<SmoothEdge> smooth_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  std::vector<std::size_t> numbers;  // of each face of that map
  std::size_t count = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next(), ++count)
    if (faces.Add(face.Current()) > static_cast<int>(numbers.size())) numbers.push_back(count);
  TopTools_IndexedDataMapOfShapeListOfShape edges;
  TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_EDGE, TopAbs_FACE, edges);
  std::vector<SmoothEdge> smooth;
  for (int e = 1; e <= edges.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(edges.FindKey(e));
    const TopTools_ListOfShape& around = edges(e);
    if (around.Extent() != 2 || BRep_Tool::Degenerated(edge)) continue;
    const std::array<TopoDS_Face, 2> both = {TopoDS::Face(around.First()), TopoDS::Face(around.Last())};
    if (!is_smooth(edge, both)) continue;
    const auto number = [&](const TopoDS_Face& face) {
      return numbers[static_cast<std::size_t>(faces.FindIndex(face) - 1)];
    };
    smooth.push_back({edge, both, {number(both[0]), number(both[1])}});
  }
  return smooth;
}

std::vector<std::uint32_t> smooth_pieces(const std::vector<SmoothEdge>& edges, std::size_t faces) {
  DisjointSets pieces(faces);
  for (const SmoothEdge& edge : edges)
    pieces.join(static_cast<std::uint32_t>(edge.numbers[0]), static_cast<std::uint32_t>(edge.numbers[1]));
  return std::move(pieces).firsts();
}

}  // namespace vdb_offset::cad
