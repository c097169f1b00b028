// SPDX-License-Identifier: Apache-2.0
#include "offset/mend_pcurve.h"

#include <Geom2d_BSplineCurve.hxx>
#include <algorithm>
#include <vector>

#include "offset/contact.h"
#include "offset/surface_fit.h"

namespace vdb_offset::cad {
namespace {

// The curve as the file has it may be the better one: a new one has to be so many times nearer.
constexpr double kBetter = 10;

constexpr int kSpans = 32;

// At a pole all of u, or of v, is one point.
bool is_pole(const Geom_Surface& surface, const gp_Pnt2d& uv) {
  gp_Pnt p;
  gp_Vec du, dv;
  surface.D1(uv.X(), uv.Y(), p, du, dv);
  return std::min(du.Magnitude(), dv.Magnitude()) < 1e-6 * std::max(du.Magnitude(), dv.Magnitude());
}

double distance_between(const Geom2d_Curve& pcurve, const Geom_Curve& curve, const Geom_Surface& surface, double first,
                        double last) {
  double most = 0;
  for (int i = 0; i <= 2 * kSpans; i++) {
    const double t = first + (last - first) * i / (2 * kSpans);
    const gp_Pnt2d uv = pcurve.Value(t);
    most = std::max(most, surface.Value(uv.X(), uv.Y()).Distance(curve.Value(t)));
  }
  return most;
}

bool is_straight(const std::vector<gp_Pnt2d>& uv) {
  const gp_Vec2d along(uv.front(), uv.back());
  for (std::size_t i = 0; i < uv.size(); i++) {
    const double part = static_cast<double>(i) / static_cast<double>(uv.size() - 1);
    if (uv.front().Translated(along * part).Distance(uv[i]) > 1e-9 * (1 + along.Magnitude())) return false;
  }
  return true;
}

}  // namespace

Handle(Geom2d_Curve) mended_pcurve(const Handle(Geom2d_Curve) & pcurve, const Handle(Geom_Curve) & curve,
                                   const Handle(Geom_Surface) & surface, double first, double last, double off) {
  const double was = distance_between(*pcurve, *curve, *surface, first, last);
  if (was <= off) return pcurve;
  std::vector<double> t;
  std::vector<gp_Pnt2d> uv;
  for (int i = 0; i <= kSpans; i++) {
    t.push_back(first + (last - first) * i / kSpans);
    uv.push_back(project(*surface, curve->Value(t.back()), pcurve->Value(t.back())));
  }
  // Where the way begins or ends at a pole, it goes on as beside it.
  if (is_pole(*surface, uv[0])) uv[0] = uv[1].Translated(gp_Vec2d(uv[2], uv[1]));
  if (is_pole(*surface, uv[kSpans])) uv[kSpans] = uv[kSpans - 1].Translated(gp_Vec2d(uv[kSpans - 2], uv[kSpans - 1]));
  Handle(Geom2d_Curve) mended;
  if (is_straight(uv)) mended = interpolate({first, last}, {uv.front(), uv.back()});
  else mended = interpolate(t, uv);
  return kBetter * distance_between(*mended, *curve, *surface, first, last) < was ? mended : pcurve;
}

}  // namespace vdb_offset::cad
