// SPDX-License-Identifier: Apache-2.0
// What the worker's judge says of offsets that are right, and of some that look like it, and what its grids cover. A
// program of its own, as it is linked to OpenCASCADE.
#include <unistd.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <array>
#include <cmath>
#include <cstdio>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <gp_Vec.hxx>

#include "judge/judge.h"
#include "judge/moved_faces.h"
#include "judge/soup.h"
#include "surface/face_grid.h"
#include "surface/make_triangles.h"
#include "write/own_process.h"

namespace {

TopoDS_Shape upright(double from, double to, double radius) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, from), gp_Dir(0, 0, 1)), radius, to - from).Shape();
}

TopoDS_Shape block(double grown) {
  return BRepPrimAPI_MakeBox(gp_Pnt(-20 - grown, -20 - grown, -grown), gp_Pnt(20 + grown, 20 + grown, 30 + grown))
      .Shape();
}

double height_of(const TopoDS_Shape& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return properties.CentreOfMass().Z();
}

/// A block with two blind holes from below and above, which end in each other: a bore whose groove has closed is not
/// that.
TopoDS_Shape holes_in_each_other(double d) {
  const TopoDS_Shape lower = BRepAlgoAPI_Cut(block(d), upright(-5, 10 + d, 5 - d)).Shape();
  const TopoDS_Shape upper = BRepAlgoAPI_Cut(block(d), upright(11 - d, 40, 5 - d)).Shape();
  BRepBuilderAPI_Sewing sewing(1e-6);
  for (TopExp_Explorer face(lower, TopAbs_FACE); face.More(); face.Next())
    if (height_of(face.Current()) < 29) sewing.Add(face.Current());
  // Of the upper one the top, and what is not the lower one's, or the sides'.
  for (TopExp_Explorer face(upper, TopAbs_FACE); face.More(); face.Next()) {
    const double z = height_of(face.Current());
    if (z > 1 && !(z > 14.9 && z < 15.1)) sewing.Add(face.Current());
  }
  sewing.Perform();
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(sewing.SewedShape())).Solid();
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

/// A ball with a cavity that is one, its middle at x, wherever that lies.
TopoDS_Shape balls(double outer, double inner, double x) {
  const TopoDS_Shape void_of = BRepPrimAPI_MakeSphere(gp_Pnt(x, 0, 0), inner).Shape();
  TopoDS_Solid solid;
  BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, TopExp_Explorer(BRepPrimAPI_MakeSphere(outer).Shape(), TopAbs_SHELL).Current());
  builder.Add(solid, TopExp_Explorer(void_of, TopAbs_SHELL).Current().Reversed());
  return solid;
}

/// Of uneven distances: whether shells lie in each other as they have to.
bool is_nested(const char* what, bool expected, const TopoDS_Shape& source, const TopoDS_Shape& result,
               const vdb_offset::cad::AskedDistance& asked) {
  const vdb_offset::cad::Verdict verdict = vdb_offset::cad::judge_offset(source, result, result, asked, {});
  std::printf("%s: %s\n", what, verdict.is_good ? "good" : "not good");
  for (const std::string& fault : verdict.faults) std::printf("  %s\n", fault.c_str());
  return verdict.is_good == expected;
}

/// Whether grids over (u, v) in place of OpenCASCADE's triangles have a shape's area, less what flat triangles take.
bool is_covered(const char* what, double area, const TopoDS_Shape& shape) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = 0.01;
  parameters.Angle = 0.1;
  vdb_offset::cad::make_triangles(shape, parameters);
  double found = 0;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
    const TopoDS_Face& face = TopoDS::Face(each.Current());
    BRep_Builder().UpdateFace(face, Handle(Poly_Triangulation)());
    vdb_offset::cad::FaceGrid(face, parameters).make_triangles();
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    for (int t = 1; !mesh.IsNull() && t <= mesh->NbTriangles(); ++t) {
      std::array<int, 3> n{};
      mesh->Triangle(t).Get(n[0], n[1], n[2]);
      const gp_Pnt a = mesh->Node(n[0]), b = mesh->Node(n[1]), c = mesh->Node(n[2]);
      found += gp_Vec(a, b).Crossed(gp_Vec(a, c)).Magnitude() / 2;
    }
  }
  std::printf("%s: %.6g of %.6g\n", what, found, area);
  constexpr double kMostLess = 0.005;
  return found <= area * (1 + 1e-9) && found > area * (1 - kMostLess);
}

bool are_grids_right() {
  const TopoDS_Shape plate = BRepAlgoAPI_Cut(block(0), upright(-5, 40, 5)).Shape();
  const double around = 2 * M_PI * 5;
  bool all = is_covered("a ball", 4 * M_PI * 100, BRepPrimAPI_MakeSphere(10).Shape());
  all = is_covered("a ring", 4 * M_PI * M_PI * 30, BRepPrimAPI_MakeTorus(10, 3).Shape()) && all;
  all = is_covered("a cone with its apex", M_PI * (60 + 36), BRepPrimAPI_MakeCone(6, 0, 8).Shape()) && all;
  return is_covered("a bored block", 2 * 1600 + 4 * 1200 - around * 5 + around * 30, plate) && all;
}

bool are_shells_right() {
  const vdb_offset::cad::AskedDistance both{0.5, 1, 1, false}, inward{0, 3, 3, false};
  const TopoDS_Shape source = balls(10, 3, 6);
  bool all = is_nested("a cavity that stays within", true, source, balls(9.5, 2.5, 6), both);
  // Passed by the wall, and now beside the ball; and around it.
  all = is_nested("a cavity that is outside", false, source, balls(7, 3, 11), both) && all;
  return is_nested("a cavity around its ball", false, balls(10, 8, 0), balls(7, 8, 0), inward) && all;
}

bool is_as_expected(const char* what, bool expected, const TopoDS_Shape& source, const TopoDS_Shape& result, double d) {
  const vdb_offset::cad::Verdict verdict =
      vdb_offset::cad::judge_offset(source, result, result, vdb_offset::cad::AskedDistance::even(d), {});
  std::printf("%s: %s\n", what, verdict.is_good ? "good" : "not good");
  for (const std::string& fault : verdict.faults) std::printf("  %s\n", fault.c_str());
  return verdict.is_good == expected;
}

/// Whether points are found to be in a ring, by rays, and in one with a hole in its surface, by solid angles.
bool are_turns_right() {
  constexpr int kPoints = 4000;
  constexpr double kMajor = 10, kMinor = 3, kClear = 0.05;
  const vdb_offset::cad::Soup ring(BRepPrimAPI_MakeTorus(kMajor, kMinor).Shape(), 0.01, 0.01, 0.1);
  int wrong = 0, inside = 0;
  for (int i = 0; i < kPoints; ++i) {  // points of Halton's sequence
    const auto halton = [&](int base) {
      double f = 1, r = 0;
      for (int n = i + 1; n > 0; n /= base) r += (f /= base) * (n % base);
      return r;
    };
    const gp_Pnt p(28 * halton(2) - 14, 28 * halton(3) - 14, 8 * halton(5) - 4);
    const double off = std::hypot(std::hypot(p.X(), p.Y()) - kMajor, p.Z()) - kMinor;
    if (std::abs(off) < kClear) continue;
    inside += off < 0;
    wrong += std::abs(ring.turns(p) - (off < 0 ? 1 : 0)) > 1e-9;
  }
  std::printf("a ring: %d of %d points inside, %d wrong\n", inside, kPoints, wrong);
  return ring.is_closed() && wrong == 0 && inside > kPoints / 10;
}

/// Whether a process that takes too long, by the clock, is ended, and says so, if it has kept nothing.
bool is_time_limited() {
  std::string gap;
  const auto waits = [](const vdb_offset::cad::Keep&) {
    ::sleep(20);
    return std::string("late");
  };
  const bool is_ended = !vdb_offset::cad::in_own_process(waits, {0, 0.2}, gap);
  const auto keeps = [](const vdb_offset::cad::Keep& keep) {
    keep("the first, which is longer");
    keep("kept");
    ::sleep(20);
    return std::string("late");
  };
  std::string none;
  const auto kept = vdb_offset::cad::in_own_process(keeps, {0, 0.2}, none);
  std::printf("a process that waits: %s\n", gap.c_str());
  const auto reply = vdb_offset::cad::in_own_process([](const auto&) { return std::string("in time"); }, {5, 5}, none);
  return is_ended && kept && *kept == "kept" && gap.find("too long") != std::string::npos && reply &&
         *reply == "in time";
}

/// Of parallel squares, 1.5 apart, of which the lower one goes up by 1: it is in the way of the upper one where that
/// moves by 1, or by 0.8, and neither where it stays nor where it moves by 0.4.
bool are_moved_faces_measured() {
  const auto square = [](double height) {
    return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, height), gp_Dir(0, 0, 1)), 0, 10, 0, 10).Face();
  };
  bool are_right = true;
  for (const auto& [distance, least] : {std::array{1.0, 0.5}, {0.8, 0.5}, {0.4, 0.0}, {0.0, 0.0}}) {
    const auto near = vdb_offset::cad::nearer_than_asked(
        {{square(0), {square(1)}, 1}, {square(1.5), {square(1.5 + distance)}, distance}}, 1);
    const double found = near ? near->distance : 0;
    std::printf("squares at 1.5 that move by 1 and %g: %g of %g\n", distance, found, near ? near->asked : 0);
    are_right = are_right && std::abs(found - least) < 1e-9 && (!near || near->asked == distance);
  }
  return are_right;
}

}  // namespace

int main() {
  constexpr double kDistance = 0.75;
  const TopoDS_Shape bored = BRepAlgoAPI_Cut(block(0), upright(-5, 40, 5)).Shape();
  const TopoDS_Shape source = BRepAlgoAPI_Cut(bored, upright(10, 11, 7)).Shape();
  const TopoDS_Shape right = BRepAlgoAPI_Cut(block(kDistance), upright(-5, 40, 5 - kDistance)).Shape();
  const bool is_right = is_as_expected("a groove that is closed", true, source, right, kDistance);
  const bool is_wrong =
      is_as_expected("two holes in each other", false, source, holes_in_each_other(kDistance), kDistance);
  const bool is_nesting_right = are_shells_right(), is_grid_right = are_grids_right();
  const bool is_rest_right = are_turns_right() && is_time_limited() && are_moved_faces_measured();
  return is_right && is_wrong && is_nesting_right && is_grid_right && is_rest_right ? 0 : 1;
}
