// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/random_part.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <numbers>
#include <vector>

#include "cad/proof/numbers.h"
#include "cad/proof/parts.h"
#include "cad/proof/step_files.h"

namespace cad_proof {
namespace {

/// The solid of a result, if it has one and no more, and that is good.
TopoDS_Shape one_solid(const TopoDS_Shape& shape) {
  TopoDS_Shape found;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    if (!found.IsNull()) return {};
    found = solid.Current();
  }
  if (found.IsNull() || !BRepCheck_Analyzer(found).IsValid()) return {};
  return volume_of(found) > 100 ? found : TopoDS_Shape();
}

// What is drawn is drawn in lists in braces, or by itself: compilers take the arguments of a call in any order.
class PartMaker {
 public:
  explicit PartMaker(std::uint64_t seed) : numbers_(seed) {}

  TopoDS_Shape make() {
    TopoDS_Shape part = base();
    for (int k = numbers_.whole(0, 3); k > 0; --k) part = changed(part);
    if (numbers_.is_likely(0.5)) part = edges_broken(part);
    return turned(one_solid(part));
  }

 private:
  TopoDS_Shape base() {
    switch (numbers_.whole(0, 6)) {
      case 0:
        return box({});
      case 1:
        return extruded();
      case 2:
        return revolved();
      case 3:
        return lofted_polygons();
      case 4:
        return lofted_splines();
      case 5:
        return fused();
      default:
        return primitive();
    }
  }
  TopoDS_Shape box(const gp_Pnt& from) {
    const gp_Vec size{numbers_.between(12, 40), numbers_.between(12, 40), numbers_.between(12, 40)};
    return BRepPrimAPI_MakeBox(from, from.Translated(size)).Shape();
  }
  TopoDS_Shape fused() {
    const TopoDS_Shape one = primitive();
    return BRepAlgoAPI_Fuse(one, box({})).Shape();
  }

  gp_Ax2 axes() {
    const gp_Pnt at{numbers_.between(2, 25), numbers_.between(2, 25), numbers_.between(-5, 15)};
    const gp_Dir oblique{numbers_.between(-1, 1), numbers_.between(-1, 1), 1.0};
    const gp_Dir along[] = {gp_Dir(0, 0, 1), gp_Dir(1, 0, 0), gp_Dir(0, 1, 0), oblique};
    return {at, along[numbers_.whole(0, 3)]};
  }
  TopoDS_Shape primitive() {
    const gp_Ax2 place = axes();
    const double radius = numbers_.between(5, 15), height = numbers_.between(10, 40);
    const double other = numbers_.between(0, 1.5) * radius, around = numbers_.between(1.3, 2.5) * radius;
    const bool is_part = numbers_.is_likely(0.2);
    const double angle = is_part ? numbers_.between(0.4, 1.8) * std::numbers::pi : 2 * std::numbers::pi;
    switch (numbers_.whole(0, 3)) {
      case 0:
        return BRepPrimAPI_MakeCylinder(place, radius, height, angle).Shape();
      case 1:
        return BRepPrimAPI_MakeCone(place, radius, other, height, angle).Shape();
      case 2:
        return BRepPrimAPI_MakeSphere(place, radius).Shape();
      default:
        return BRepPrimAPI_MakeTorus(place, around, radius, angle).Shape();
    }
  }

  /// Points round an axis; `wave` makes them go in and out.
  std::vector<gp_Pnt> ring(int count, double radius, double wave, double z, double twist) {
    std::vector<gp_Pnt> points;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * (k + twist) / count, r = radius * (1 + numbers_.between(-wave, wave));
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
    return points;
  }
  TopoDS_Shape extruded() {
    const int count = numbers_.whole(3, 8);
    const double radius = numbers_.between(12, 25), wave = numbers_.between(0, 0.4);
    const std::vector<gp_Pnt> points = ring(count, radius, wave, 0, 0);
    const TopoDS_Shape face =
        points.size() > 4 && numbers_.is_likely(0.3) ? face_of(closed_spline(points)) : polygon(points);
    const gp_Vec way{0, numbers_.is_likely(0.3) ? 8.0 : 0.0, numbers_.between(10, 40)};
    return BRepPrimAPI_MakePrism(face, way).Shape();
  }
  TopoDS_Shape revolved() {
    std::vector<gp_Pnt> outline;
    const double inner = numbers_.is_likely(0.5) ? 0 : numbers_.between(4, 10);
    const int steps = numbers_.whole(2, 4);
    double z = 0;
    outline.emplace_back(inner, 0, 0);
    for (int k = 0; k < steps; ++k) {
      outline.emplace_back(inner + numbers_.between(5, 20), 0, z);
      z += numbers_.between(4, 15);
    }
    outline.emplace_back(inner + numbers_.between(5, 20), 0, z);
    outline.emplace_back(inner, 0, z);
    const double angle = numbers_.is_likely(0.7) ? 2 * std::numbers::pi : numbers_.between(0.5, 1.5) * std::numbers::pi;
    return BRepPrimAPI_MakeRevol(polygon(outline), gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1)), angle).Shape();
  }
  TopoDS_Shape lofted_polygons() {
    const int corners = numbers_.whole(3, 6), sections = numbers_.whole(2, 3);
    const bool is_ruled = numbers_.is_likely(0.4);
    std::vector<std::vector<gp_Pnt>> outlines;
    for (int k = 0; k < sections; ++k) {
      const double radius = numbers_.between(10, 22), z = k * numbers_.between(14, 20);
      outlines.push_back(ring(corners, radius, 0.1, z, 0.1 * k));
    }
    return loft(outlines, is_ruled);
  }
  TopoDS_Shape lofted_splines() {
    const int points = numbers_.whole(5, 9), sections = numbers_.whole(2, 4);
    std::vector<TopoDS_Edge> outlines;
    for (int k = 0; k < sections; ++k) {
      const double radius = numbers_.between(12, 20), z = k * numbers_.between(12, 16);
      outlines.push_back(closed_spline(ring(points, radius, 0.12, z, 0)));
    }
    return loft(outlines, numbers_.is_likely(0.3));
  }

  TopoDS_Shape changed(const TopoDS_Shape& part) {
    const bool is_box = numbers_.is_likely(0.3);
    const gp_Pnt near{numbers_.between(-5, 20), numbers_.between(-5, 20), numbers_.between(-5, 20)};
    const TopoDS_Shape tool = smaller(is_box ? box(near) : primitive());
    const TopoDS_Shape made =
        numbers_.is_likely(0.65) ? BRepAlgoAPI_Cut(part, tool).Shape() : BRepAlgoAPI_Fuse(part, tool).Shape();
    const TopoDS_Shape good = one_solid(made);
    return good.IsNull() ? part : good;
  }
  TopoDS_Shape smaller(const TopoDS_Shape& shape) {
    gp_Trsf scale;
    scale.SetScale(gp_Pnt(8, 8, 8), numbers_.between(0.3, 0.9));
    return BRepBuilderAPI_Transform(shape, scale).Shape();
  }

  /// Some edges rounded, or chamfered, as far as OpenCASCADE does it.
  TopoDS_Shape edges_broken(const TopoDS_Shape& part) {
    const double size = numbers_.between(0.8, 4), share = numbers_.between(0.1, 1);
    const bool is_round = numbers_.is_likely(0.7);
    std::vector<int> chosen;
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(part, TopAbs_EDGE, edges);
    for (int k = 1; k <= edges.Extent(); ++k)
      if (numbers_.is_likely(share)) chosen.push_back(k);
    try {
      BRepFilletAPI_MakeFillet fillet(part);
      BRepFilletAPI_MakeChamfer chamfer(part);
      for (const int k : chosen)
        if (is_round) fillet.Add(size, TopoDS::Edge(edges(k)));
        else chamfer.Add(size, TopoDS::Edge(edges(k)));
      const TopoDS_Shape made = one_solid(is_round ? fillet.Shape() : chamfer.Shape());
      return made.IsNull() ? part : made;
    } catch (const Standard_Failure&) {
      return part;
    }
  }
  TopoDS_Shape turned(const TopoDS_Shape& part) {
    if (part.IsNull() || numbers_.is_likely(0.5)) return part;
    gp_Trsf turn;
    const gp_Dir axis{numbers_.between(-1, 1), numbers_.between(-1, 1), 0.7};
    turn.SetRotation(gp_Ax1(gp_Pnt(3, 4, 5), axis), numbers_.between(0, 2 * std::numbers::pi));
    return BRepBuilderAPI_Transform(part, turn, Standard_True).Shape();
  }

  Numbers numbers_;
};

}  // namespace

TopoDS_Shape random_part(std::uint64_t seed) {
  try {
    return PartMaker(seed).make();
  } catch (const Standard_Failure&) {
    return {};
  }
}

double random_share(std::uint64_t seed) {
  Numbers numbers(seed + 1000003);
  const double share = numbers.between(0.005, 0.05);
  return numbers.is_likely(0.5) ? share : -share;
}

}  // namespace cad_proof
