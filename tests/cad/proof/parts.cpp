// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/parts.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <numbers>

namespace cad_proof {
namespace {

constexpr double kPi = std::numbers::pi;

gp_Ax2 upright(double x, double y, double z) { return {gp_Pnt(x, y, z), gp_Dir(0, 0, 1)}; }

TopoDS_Shape cut(const TopoDS_Shape& from, const TopoDS_Shape& what) { return BRepAlgoAPI_Cut(from, what).Shape(); }

/// Rounds the edges whose middle is asked for.
TopoDS_Shape rounded(const TopoDS_Shape& shape, double radius, const std::function<bool(const gp_Pnt&)>& is_asked_for) {
  BRepFilletAPI_MakeFillet fillet(shape);
  for (TopExp_Explorer edge(shape, TopAbs_EDGE); edge.More(); edge.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
    if (is_asked_for(curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)))
      fillet.Add(radius, TopoDS::Edge(edge.Current()));
  }
  return fillet.Shape();
}

TopoDS_Shape block() { return BRepPrimAPI_MakeBox(40, 30, 20).Shape(); }

TopoDS_Shape drilled() {
  const TopoDS_Shape one = cut(block(), BRepPrimAPI_MakeCylinder(upright(12, 15, -1), 4, 22).Shape());
  const TopoDS_Shape two = cut(one, BRepPrimAPI_MakeCylinder(upright(28, 15, 8), 6, 22).Shape());
  return cut(two, BRepPrimAPI_MakeBox(gp_Pnt(-1, -1, 14), gp_Pnt(41, 6, 30)).Shape());
}

TopoDS_Shape rounded_block() {
  return rounded(block(), 4, [](const gp_Pnt&) { return true; });
}

TopoDS_Shape bracket() {
  const TopoDS_Shape foot = BRepPrimAPI_MakeBox(40, 24, 6).Shape();
  const TopoDS_Shape back = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(6, 24, 30)).Shape();
  const TopoDS_Shape both = BRepAlgoAPI_Fuse(foot, back).Shape();
  const TopoDS_Shape bent =
      rounded(both, 5, [](const gp_Pnt& p) { return std::abs(p.X() - 6) < 1e-6 && std::abs(p.Z() - 6) < 1e-6; });
  const TopoDS_Shape one = cut(bent, BRepPrimAPI_MakeCylinder(upright(28, 12, -1), 4, 20).Shape());
  const gp_Ax2 level(gp_Pnt(-1, 12, 20), gp_Dir(1, 0, 0));
  return cut(one, BRepPrimAPI_MakeCylinder(level, 3, 20).Shape());
}

TopoDS_Shape flange() {
  const TopoDS_Shape half = polygon({{8, 0, 0}, {30, 0, 0}, {30, 0, 6}, {16, 0, 6}, {12, 0, 20}, {8, 0, 20}});
  TopoDS_Shape turned = BRepPrimAPI_MakeRevol(half, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape();
  for (int k = 0; k < 4; ++k)
    turned = cut(turned, BRepPrimAPI_MakeCylinder(
                             upright(23 * std::cos(k * kPi / 2 + 0.3), 23 * std::sin(k * kPi / 2 + 0.3), -1), 3, 8)
                             .Shape());
  return turned;
}

TopoDS_Shape frustum() {
  return cut(BRepPrimAPI_MakeCone(20, 12, 24).Shape(), BRepPrimAPI_MakeCylinder(upright(0, 0, -1), 6, 26).Shape());
}

TopoDS_Shape bend() { return BRepPrimAPI_MakeTorus(gp_Ax2(), 24, 7, 1.3 * kPi).Shape(); }

std::vector<gp_Pnt> ring(int count, double radius, double wave, double z) {
  std::vector<gp_Pnt> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * kPi * k / count, r = radius * (1 + wave * std::cos(2 * angle));
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

TopoDS_Shape duct() { return loft({ring(4, 20, 0, 0), ring(4, 15, 0.1, 18), ring(4, 18, 0.2, 36)}, false); }

TopoDS_Shape vase() {
  return loft(
      {closed_spline(ring(8, 16, 0.1, 0)), closed_spline(ring(8, 20, 0.15, 15)), closed_spline(ring(8, 14, 0.2, 32))},
      false);
}

TopoDS_Shape hollow() { return cut(block(), BRepPrimAPI_MakeBox(gp_Pnt(7, 8, 6), gp_Pnt(31, 22, 13)).Shape()); }

}  // namespace

TopoDS_Shape face_of(const TopoDS_Edge& closed) {
  return BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(closed).Wire(), Standard_True).Shape();
}

TopoDS_Shape polygon(const std::vector<gp_Pnt>& corners) {
  BRepBuilderAPI_MakePolygon outline;
  for (const gp_Pnt& corner : corners) outline.Add(corner);
  outline.Close();
  return BRepBuilderAPI_MakeFace(outline.Wire(), Standard_True).Shape();
}

TopoDS_Edge closed_spline(const std::vector<gp_Pnt>& points) {
  Handle(TColgp_HArray1OfPnt) all = new TColgp_HArray1OfPnt(1, static_cast<int>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) all->SetValue(static_cast<int>(k) + 1, points[k]);
  GeomAPI_Interpolate spline(all, Standard_True, 1e-9);
  spline.Perform();
  return BRepBuilderAPI_MakeEdge(spline.Curve()).Edge();
}

TopoDS_Shape loft(const std::vector<TopoDS_Edge>& outlines, bool is_ruled) {
  BRepOffsetAPI_ThruSections sections(Standard_True, is_ruled, 1e-6);
  for (const TopoDS_Edge& outline : outlines) sections.AddWire(BRepBuilderAPI_MakeWire(outline).Wire());
  sections.CheckCompatibility(Standard_False);
  return sections.Shape();
}

TopoDS_Shape loft(const std::vector<std::vector<gp_Pnt>>& outlines, bool is_ruled) {
  BRepOffsetAPI_ThruSections sections(Standard_True, is_ruled, 1e-6);
  for (const auto& corners : outlines) {
    BRepBuilderAPI_MakePolygon outline;
    for (const gp_Pnt& corner : corners) outline.Add(corner);
    outline.Close();
    sections.AddWire(outline.Wire());
  }
  sections.CheckCompatibility(Standard_False);
  return sections.Shape();
}

const std::vector<std::pair<std::string, std::function<TopoDS_Shape()>>>& parts() {
  static const std::vector<std::pair<std::string, std::function<TopoDS_Shape()>>> all = {
      {"block", block},     {"drilled", drilled}, {"rounded", rounded_block},
      {"bracket", bracket}, {"flange", flange},   {"frustum", frustum},
      {"bend", bend},       {"duct", duct},       {"vase", vase},
      {"hollow", hollow}};
  return all;
}

}  // namespace cad_proof
