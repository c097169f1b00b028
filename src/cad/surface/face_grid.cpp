// SPDX-License-Identifier: Apache-2.0
#include "surface/face_grid.h"

#include <Adaptor3d_IsoCurve.hxx>
#include <BRepAdaptor_Curve.hxx>
#include <BRepMesh_DataStructureOfDelaun.hxx>
#include <BRepMesh_Delaun.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <Geom2d_Curve.hxx>
#include <NCollection_IncAllocator.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Standard_NullObject.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Vec2d.hxx>

namespace vdb_offset::cad {
namespace {

constexpr double kLeastGap = 0.3;      // of points of the grid from the border, in steps
constexpr double kLeftOut = 1e-3;      // at each end of a line that is measured, of its range
constexpr double kMostMissed = 0.1;    // by trimming curves that meet, in steps
constexpr double kSamePoint = 1e-9;    // in steps
constexpr double kMostAreaOff = 1e-6;  // of the face's, in (u, v)

/// How many lines a curve takes.
template <class Curve>
int lines_along(const Curve& curve, const IMeshTools_Parameters& parameters) {
  return GCPnts_TangentialDeflection(curve, parameters.Angle, parameters.Deflection).NbPoints() - 1;
}

double distance_from(const gp_Pnt2d& a, const gp_Pnt2d& b, const gp_Pnt2d& point) {
  const gp_Vec2d along(a, b);
  const double length2 = along.SquareMagnitude();
  const double t = length2 > 0 ? std::clamp(gp_Vec2d(a, point).Dot(along) / length2, 0.0, 1.0) : 0;
  return gp_Pnt2d(a.XY() + along.XY() * t).Distance(point);
}

/// \throw Standard_NullObject if there is none
Handle(Geom2d_Curve) trim_of(const TopoDS_Edge& edge, const TopoDS_Face& face, double& first, double& last) {
  Handle(Geom2d_Curve) trim = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (trim.IsNull()) throw Standard_NullObject("an edge without a trimming curve");
  return trim;
}

/// The points of an edge, as triangles know them.
Handle(Poly_PolygonOnTriangulation) polygon_of(const FaceGrid::Side& side) {
  const auto count = static_cast<int>(side.points.size());
  TColStd_Array1OfInteger nodes(1, count);
  TColStd_Array1OfReal parameters(1, count);
  for (int k = 0; k < count; ++k) {
    nodes.SetValue(k + 1, side.points[k] + 1);
    parameters.SetValue(k + 1, side.parameters[k]);
  }
  return new Poly_PolygonOnTriangulation(nodes, parameters);
}

double cross(const gp_Pnt2d& a, const gp_Pnt2d& b, const gp_Pnt2d& c) { return gp_Vec2d(a, b).Crossed(gp_Vec2d(a, c)); }

}  // namespace

FaceGrid::FaceGrid(const TopoDS_Face& face, const IMeshTools_Parameters& parameters)
    : face_(TopoDS::Face(face.Oriented(TopAbs_FORWARD))), parameters_(parameters), surface_(face_) {}

void FaceGrid::make_triangles() {
  choose_steps();
  for (TopExp_Explorer wire(face_, TopAbs_WIRE); wire.More(); wire.Next())
    if (!add_border(TopoDS::Wire(wire.Current()))) return;
  const auto border_points = static_cast<int>(points_.size());
  add_inner_points();
  const std::vector<std::array<int, 3>> found = triangles(border_points);
  double area = 0;
  for (const auto& [a, b, c] : found) area += std::abs(cross(points_[a].uv, points_[b].uv, points_[c].uv)) / 2;
  if (!found.empty() && std::abs(area - border_area()) <= kMostAreaOff * area) keep(found);
}

/// As many steps across the face as its most bent line of three takes.
void FaceGrid::choose_steps() {
  const std::array<double, 2> first = {surface_.FirstUParameter(), surface_.FirstVParameter()},
                              last = {surface_.LastUParameter(), surface_.LastVParameter()};
  const Handle(BRepAdaptor_Surface) surface = new BRepAdaptor_Surface(surface_);
  for (const int i : {0, 1}) {
    int count = 1;
    for (const double share : {0.25, 0.5, 0.75}) {
      const double at = first[1 - i] + share * (last[1 - i] - first[1 - i]);
      // A little less than the face: of a range that is longer than a period by a rounding only that would be left.
      const double less = kLeftOut * (last[i] - first[i]);
      const Adaptor3d_IsoCurve line(surface, i == 0 ? GeomAbs_IsoV : GeomAbs_IsoU, at, first[i] + less, last[i] - less);
      count = std::max(count, lines_along(line, parameters_));
    }
    step_[i] = (last[i] - first[i]) / count;
  }
}

int FaceGrid::add(const gp_Pnt2d& uv, const gp_Pnt& at) {
  points_.push_back({uv, at});
  return static_cast<int>(points_.size()) - 1;
}

/// The edges of a wire, each from where the one before it ends: as OpenCASCADE puts them, or where their trimming
/// curves miss each other too far for that, as the wire has them; none if that is no way round either.
std::vector<TopoDS_Edge> FaceGrid::in_turn(const TopoDS_Wire& wire) const {
  std::vector<TopoDS_Edge> edges, listed;
  for (BRepTools_WireExplorer found(wire, face_); found.More(); found.Next()) edges.push_back(found.Current());
  for (TopExp_Explorer found(wire, TopAbs_EDGE); found.More(); found.Next())
    listed.push_back(TopoDS::Edge(found.Current()));
  if (edges.size() == listed.size() && is_way_round(edges)) return edges;
  if (!is_way_round(listed)) listed.clear();
  return listed;
}

bool FaceGrid::is_way_round(const std::vector<TopoDS_Edge>& edges) const {
  const auto end_of = [&](const TopoDS_Edge& edge, bool is_last) {
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) trim = trim_of(edge, face_, first, last);
    return in_steps(trim->Value(is_last == (edge.Orientation() == TopAbs_REVERSED) ? first : last));
  };
  for (std::size_t k = 0; k < edges.size(); ++k)
    if (end_of(edges[k], true).Distance(end_of(edges[(k + 1) % edges.size()], false)) > kMostMissed) return false;
  return true;
}

bool FaceGrid::add_border(const TopoDS_Wire& wire) {
  const std::vector<TopoDS_Edge> edges = in_turn(wire);
  if (edges.empty()) return false;
  std::vector<int> round;
  for (const TopoDS_Edge& edge : edges) {
    const std::vector<EdgePoint> along = divided(edge);
    const bool is_turned = edge.Orientation() == TopAbs_REVERSED;
    const bool is_last = &edge == &edges.back();
    Side side{edge, {}, std::vector<int>(along.size())};
    // It begins where the one before it ends, and the last one ends where the first begins.
    for (std::size_t k = 0; k < along.size(); ++k) {
      const std::size_t i = is_turned ? along.size() - 1 - k : k;
      if (k == 0 && !round.empty()) side.points[i] = round.back();
      else if (k + 1 == along.size() && is_last) side.points[i] = round.front();
      else round.push_back(side.points[i] = add(in_steps(along[i].uv), along[i].at));
    }
    for (const EdgePoint& point : along) side.parameters.push_back(point.parameter);
    sides_.push_back(std::move(side));
  }
  for (std::size_t k = 0; k < round.size(); ++k) border_.push_back({round[k], round[(k + 1) % round.size()]});
  return true;
}

/// Divides an edge as it is divided already, or anew.
std::vector<FaceGrid::EdgePoint> FaceGrid::divided(const TopoDS_Edge& edge) const {
  std::vector<EdgePoint> along;
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) trim = trim_of(edge, face_, first, last);
  const auto add = [&](double parameter, const gp_Pnt& at) {
    along.push_back({parameter, trim->Value(parameter), at});
  };
  Handle(Poly_PolygonOnTriangulation) known;
  Handle(Poly_Triangulation) mesh;
  TopLoc_Location place;
  BRep_Tool::PolygonOnTriangulation(edge, known, mesh, place, 1);
  if (!known.IsNull() && known->HasParameters()) {
    for (int k = 1; k <= known->NbNodes(); ++k)
      add(known->Parameter(k), mesh->Node(known->Node(k)).Transformed(place.Transformation()));
  } else if (BRep_Tool::Degenerated(edge)) {
    for (const double end : {first, last}) add(end, BRep_Tool::Pnt(TopExp::FirstVertex(edge)));
  } else {
    const BRepAdaptor_Curve curve(edge);
    const GCPnts_TangentialDeflection points(curve, parameters_.Angle, parameters_.Deflection);
    for (int k = 1; k <= points.NbPoints(); ++k) add(points.Parameter(k), points.Value(k));
  }
  return along;
}

/// Inside of the border by an odd number of lines to one side, and not at it.
bool FaceGrid::is_inner(const gp_Pnt2d& uv) const {
  bool is_inside = false;
  for (const auto& [from, to] : border_) {
    const gp_Pnt2d &a = points_[from].uv, &b = points_[to].uv;
    if (distance_from(a, b, uv) < kLeastGap) return false;
    if ((a.Y() > uv.Y()) == (b.Y() > uv.Y())) continue;
    if (uv.X() < a.X() + (b.X() - a.X()) * (uv.Y() - a.Y()) / (b.Y() - a.Y())) is_inside = !is_inside;
  }
  return is_inside;
}

void FaceGrid::add_inner_points() {
  const gp_Pnt2d first = in_steps({surface_.FirstUParameter(), surface_.FirstVParameter()}),
                 last = in_steps({surface_.LastUParameter(), surface_.LastVParameter()});
  for (double u = first.X() + 1; u < last.X() - 0.5; ++u)
    for (double v = first.Y() + 1; v < last.Y() - 0.5; ++v) {
      if (!is_inner({u, v})) continue;
      const gp_Pnt2d uv = from_steps({u, v});
      add({u, v}, surface_.Value(uv.X(), uv.Y()));
    }
}

double FaceGrid::border_area() const {
  double area = 0;
  for (const auto& [a, b] : border_) area += points_[a].uv.XY().Crossed(points_[b].uv.XY()) / 2;
  return area;
}

/// By OpenCASCADE's own triangulation of points, within the border.
std::vector<std::array<int, 3>> FaceGrid::triangles(int border_points) const {
  const auto count = static_cast<int>(points_.size());
  const Handle(BRepMesh_DataStructureOfDelaun) mesh =
      new BRepMesh_DataStructureOfDelaun(new NCollection_IncAllocator, count);
  mesh->Data()->SetCellSize(1);
  mesh->Data()->SetTolerance(kSamePoint);
  IMeshData::VectorOfInteger order(count);
  for (int k = 0; k < count; ++k) {
    const BRepMesh_Vertex point(points_[k].uv.XY(), k, k < border_points ? BRepMesh_Frontier : BRepMesh_Free);
    order.Append(mesh->AddNode(point, true));
  }
  for (const auto& [a, b] : border_) mesh->AddLink(BRepMesh_Edge(a + 1, b + 1, BRepMesh_Frontier));
  const int cells = 1 + static_cast<int>(std::sqrt(count));
  const BRepMesh_Delaun delaun(mesh, order, cells, cells);
  std::vector<std::array<int, 3>> found;
  for (IMeshData::IteratorOfMapOfInteger it(mesh->ElementsOfDomain()); it.More(); it.Next()) {
    int nodes[3];  // NOLINT(modernize-avoid-c-arrays): as OpenCASCADE has them
    mesh->ElementNodes(mesh->GetElement(it.Key()), nodes);
    found.push_back({nodes[0] - 1, nodes[1] - 1, nodes[2] - 1});
  }
  return found;
}

/// Gives the face the triangles, and its edges their points.
void FaceGrid::keep(const std::vector<std::array<int, 3>>& triangles) const {
  const TopLoc_Location place = face_.Location();
  const gp_Trsf to_own = place.Transformation().Inverted();
  const Handle(Poly_Triangulation) mesh =
      new Poly_Triangulation(static_cast<int>(points_.size()), static_cast<int>(triangles.size()), true);
  mesh->Deflection(parameters_.Deflection);
  for (int k = 0; k < mesh->NbNodes(); ++k) {
    mesh->SetNode(k + 1, points_[k].at.Transformed(to_own));
    mesh->SetUVNode(k + 1, from_steps(points_[k].uv));
  }
  for (int t = 0; t < mesh->NbTriangles(); ++t)
    mesh->SetTriangle(t + 1, Poly_Triangle(triangles[t][0] + 1, triangles[t][1] + 1, triangles[t][2] + 1));
  const BRep_Builder builder;
  builder.UpdateFace(face_, mesh);
  for (const Side& side : sides_) {
    // A seam is gone along twice.
    const auto back = std::find_if(sides_.begin(), sides_.end(), [&](const Side& other) {
      return other.edge.IsSame(side.edge) && other.edge.Orientation() != side.edge.Orientation();
    });
    const TopoDS_Edge edge = TopoDS::Edge(side.edge.Oriented(TopAbs_FORWARD));
    if (back == sides_.end()) builder.UpdateEdge(edge, polygon_of(side), mesh, place);
    else if (side.edge.Orientation() == TopAbs_FORWARD)
      builder.UpdateEdge(edge, polygon_of(side), polygon_of(*back), mesh, place);
  }
}

}  // namespace vdb_offset::cad
