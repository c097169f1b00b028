// SPDX-License-Identifier: Apache-2.0
#include "judge/parameters.h"

#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt2d.hxx>
#include <optional>

namespace vdb_offset::cad {
namespace {

// Steps that spread points evenly over a square: the reciprocals of the plastic number and of its square (M. Roberts,
// 2018).
constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;

constexpr double kMostShare = 0.05;

double fraction(double x) { return x - std::floor(x); }

}  // namespace

AtParameters measure_at_parameters(const TopoDS_Face& source, const TopoDS_Face& made, const FaceDistance& distance,
                                   std::size_t count, AskedDistance& asked) {
  AtParameters measured;
  Box2 box{};
  BRepTools::UVBounds(source, box.u0, box.u1, box.v0, box.v1);
  const Handle(Geom_Surface) from = surface_of(source);
  const double sign = source.Orientation() == TopAbs_REVERSED ? -1 : 1;
  BRepTopAdaptor_FClass2d in_source(source, 0);
  Handle(Geom_Surface) to;
  std::optional<BRepTopAdaptor_FClass2d> in_made;
  if (!made.IsNull()) to = surface_of(made), in_made.emplace(made, 0);
  if (!distance.at) asked.add(distance.constant);
  for (std::size_t i = 1; i <= count; ++i) {
    const auto k = static_cast<double>(i);
    const gp_Pnt2d uv(box.u0 + (box.u1 - box.u0) * fraction(k * kStepU),
                      box.v0 + (box.v1 - box.v0) * fraction(k * kStepV));
    if (in_source.Perform(uv) != TopAbs_IN) continue;
    const double here = distance(uv.X(), uv.Y());
    asked.add(here);
    if (!in_made || in_made->Perform(uv) != TopAbs_IN) continue;
    const gp_Vec normal = unit_normal(*from, uv.X(), uv.Y(), box) * sign;
    if (normal.Magnitude() < 0.5) continue;
    const gp_Vec moved(from->Value(uv.X(), uv.Y()), to->Value(uv.X(), uv.Y()));
    const double off = (moved - normal * here).Magnitude();
    measured.worst = std::max(measured.worst, off);
    ++measured.samples;
    // Of what hardly goes anywhere, the share is that of the rounding of fits.
    if (off >= kMostShare * std::abs(here)) continue;
    measured.least = std::min(measured.least, moved.Dot(normal) / here);
    measured.most = std::max(measured.most, moved.Dot(normal) / here);
  }
  return measured;
}

}  // namespace vdb_offset::cad
