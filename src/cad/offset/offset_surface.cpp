// SPDX-License-Identifier: Apache-2.0
#include "offset/offset_surface.h"

#include <BRep_Tool.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>

#include "offset/surface_fit.h"

namespace vdb_offset::cad {
namespace {

// Su x Sv of the elementary surfaces points away from the axis if their axes are right-handed.
double outward(const gp_Ax3& axes) { return axes.Direct() ? 1 : -1; }

template <class Surface>
OffsetSurface with_radius(const Handle(Surface) & s, double radius) {
  OffsetSurface result;
  if (radius <= 1e-7) {
    result.made = FaceMade::Swallowed;
    return result;
  }
  const Handle(Surface) copy = Handle(Surface)::DownCast(s->Copy());
  copy->SetRadius(radius);
  result.surface = copy;
  return result;
}

OffsetSurface offset_cone(const Handle(Geom_ConicalSurface) & s, const Box2& box, double d) {
  // P = location + (R + v sin a) radial + v cos a axis, with the normal cos a radial - sin a axis.
  const gp_Ax3 axes = s->Position();
  const double a = s->SemiAngle();
  // Behind its apex a cone's radius is below 0, and Su x Sv looks the other way.
  const double nappe = s->RefRadius() + (box.v0 + box.v1) / 2 * std::sin(a) < 0 ? -1 : 1;
  const double out = d * outward(axes) * nappe;
  const double radius = s->RefRadius() + out * std::cos(a);
  OffsetSurface result;
  const double r0 = nappe * (radius + box.v0 * std::sin(a)), r1 = nappe * (radius + box.v1 * std::sin(a));
  if (std::max(r0, r1) <= 1e-7) {
    result.made = FaceMade::Swallowed;
    return result;
  }
  result.has_apex = true;
  result.apex_v = -radius / std::sin(a);
  const gp_Vec shift = gp_Vec(axes.Direction()) * (-out * std::sin(a));
  if (radius < 0) {
    // A cone starts where its radius is none or more, which would shift v: the same points by turning a line.
    const gp_Vec along = gp_Vec(axes.XDirection()) * std::sin(a) + gp_Vec(axes.Direction()) * std::cos(a);
    const gp_Pnt start = axes.Location().Translated(shift + gp_Vec(axes.XDirection()) * radius);
    const gp_Dir axis = axes.Direct() ? axes.Direction() : axes.Direction().Reversed();
    result.surface = new Geom_SurfaceOfRevolution(new Geom_Line(start, gp_Dir(along)), gp_Ax1(axes.Location(), axis));
    return result;
  }
  const Handle(Geom_ConicalSurface) copy = Handle(Geom_ConicalSurface)::DownCast(s->Copy());
  copy->SetRadius(radius);
  copy->Translate(shift);
  result.surface = copy;
  return result;
}

// The offset of an elementary surface; nothing if it is none.
OffsetSurface offset_elementary(const Handle(Geom_Surface) & surface, const Box2& box, double d) {
  if (const auto s = Handle(Geom_Plane)::DownCast(surface)) {
    const Handle(Geom_Surface) copy = Handle(Geom_Surface)::DownCast(s->Copy());
    copy->Translate(gp_Vec(s->Position().Direction()) * (d * outward(s->Position())));
    return {copy};
  }
  if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(surface))
    return with_radius(s, s->Radius() + d * outward(s->Position()));
  if (const auto s = Handle(Geom_SphericalSurface)::DownCast(surface))
    return with_radius(s, s->Radius() + d * outward(s->Position()));
  if (const auto s = Handle(Geom_ConicalSurface)::DownCast(surface)) return offset_cone(s, box, d);
  if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(surface)) {
    OffsetSurface result;
    // Within a torus that crosses itself Su x Sv looks the other way.
    const double middle = s->MajorRadius() + s->MinorRadius() * std::cos((box.v0 + box.v1) / 2);
    const double radius = s->MinorRadius() + d * outward(s->Position()) * (middle < 0 ? -1 : 1);
    if (radius <= 1e-7) {
      result.made = FaceMade::Swallowed;
      return result;
    }
    // Made anew: a torus that crosses itself at its axis, out of use, cannot be had by a new radius.
    result.surface = new Geom_ToroidalSurface(s->Position(), s->MajorRadius(), radius);
    return result;
  }
  return {};
}

// Knots of a curve or of one direction of a surface over [first, last].
Knots knots_along(const Handle(Geom_Curve) & curve, double first, double last) {
  Handle(Geom_Curve) basis = curve;
  while (const auto t = Handle(Geom_TrimmedCurve)::DownCast(basis)) basis = t->BasisCurve();
  std::vector<double> knots;
  std::vector<int> multiplicities;
  int degree = 3;
  if (const auto b = Handle(Geom_BSplineCurve)::DownCast(basis)) {
    degree = b->Degree();
    for (int i = 1; i <= b->NbKnots(); i++) {
      knots.push_back(b->Knot(i));
      multiplicities.push_back(b->Multiplicity(i));
    }
  }
  return offset_knots(degree, knots, multiplicities, first, last);
}

Knots knots_along(const Handle(Geom_Surface) & surface, bool along_u, double first, double last) {
  std::vector<double> knots;
  std::vector<int> multiplicities;
  int degree = 3;
  if (const auto b = Handle(Geom_BSplineSurface)::DownCast(surface)) {
    degree = along_u ? b->UDegree() : b->VDegree();
    for (int i = 1; i <= (along_u ? b->NbUKnots() : b->NbVKnots()); i++) {
      knots.push_back(along_u ? b->UKnot(i) : b->VKnot(i));
      multiplicities.push_back(along_u ? b->UMultiplicity(i) : b->VMultiplicity(i));
    }
  } else {
    GeomAdaptor_Surface adaptor(surface);
    const int n = along_u ? adaptor.NbUIntervals(GeomAbs_C2) : adaptor.NbVIntervals(GeomAbs_C2);
    TColStd_Array1OfReal ends(1, n + 1);
    if (along_u) adaptor.UIntervals(ends, GeomAbs_C2);
    else adaptor.VIntervals(ends, GeomAbs_C2);
    for (double end : ends)
      if (std::abs(end) < 1e50) {
        knots.push_back(end);
        multiplicities.push_back(2);
      }
  }
  return offset_knots(degree, knots, multiplicities, first, last);
}

// Which sides of the box are poles: a single point of the surface.
Sides poles_of(const Geom_Surface& s, const Box2& box) {
  const auto is_pole = [&](bool along_v, double at) {
    const double um = (box.u0 + box.u1) / 2, vm = (box.v0 + box.v1) / 2;
    const gp_Pnt middle = s.Value(um, vm);
    const double size = middle.Distance(along_v ? s.Value(at, vm) : s.Value(um, at));
    gp_Pnt first;
    for (int i = 0; i <= 4; i++) {
      const double t = i / 4.0;
      const gp_Pnt p =
          along_v ? s.Value(at, box.v0 + (box.v1 - box.v0) * t) : s.Value(box.u0 + (box.u1 - box.u0) * t, at);
      if (i == 0) first = p;
      else if (p.Distance(first) > 1e-5 * size) return false;
    }
    return true;
  };
  return {is_pole(true, box.u0), is_pole(true, box.u1), is_pole(false, box.v0), is_pole(false, box.v1)};
}

// The box drawn out by the margin where the surface does not close, less where normals turn too far out there.
Box2 drawn_out(const Geom_Surface& s, const Box2& box, const Sides& poles, const Sides& drawn, double margin) {
  Box2 wide = box;
  const double um = (box.u0 + box.u1) / 2, vm = (box.v0 + box.v1) / 2;
  const auto reach = [&](double u, double v, bool along_u) {
    gp_Pnt p;
    gp_Vec du, dv;
    s.D1(u, v, p, du, dv);
    const double speed = (along_u ? du : dv).Magnitude();
    const double range = along_u ? box.u1 - box.u0 : box.v1 - box.v0;
    return speed > 1e-9 ? std::min(margin / speed, 0.5 * range) : 0;
  };
  const auto turned = [&](double u, double v, double from_u, double from_v) {
    return unit_normal(s, u, v, box).Angle(unit_normal(s, from_u, from_v, box)) > 1;
  };
  const auto limited = [&](double from_u, double from_v, double step_u, double step_v) {
    double part = 1;
    while (part > 0.01 && turned(from_u + part * step_u, from_v + part * step_v, from_u, from_v)) part /= 2;
    return part;
  };
  double u0, u1, v0, v1;
  s.Bounds(u0, u1, v0, v1);
  if (!s.IsUClosed() || box.u1 - box.u0 < 0.999 * (u1 - u0)) {
    const double a = reach(box.u0, vm, true), b = reach(box.u1, vm, true);
    if (drawn.u0) wide.u0 -= a * (poles.u0 ? 1 : limited(box.u0, vm, -a, 0));
    if (drawn.u1) wide.u1 += b * (poles.u1 ? 1 : limited(box.u1, vm, b, 0));
  }
  if (!s.IsVClosed() || box.v1 - box.v0 < 0.999 * (v1 - v0)) {
    const double a = reach(um, box.v0, false), b = reach(um, box.v1, false);
    if (drawn.v0) wide.v0 -= a * (poles.v0 ? 1 : limited(um, box.v0, 0, -a));
    if (drawn.v1) wide.v1 += b * (poles.v1 ? 1 : limited(um, box.v1, 0, b));
  }
  return wide;
}

}  // namespace

gp_Vec unit_normal(const Geom_Surface& surface, double u, double v, const Box2& box) {
  const double um = (box.u0 + box.u1) / 2, vm = (box.v0 + box.v1) / 2;
  double part = 0;
  for (int i = 0; i < 8; i++) {
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(u + (um - u) * part, v + (vm - v) * part, p, du, dv);
    const gp_Vec n = du.Crossed(dv);
    // Against the lengths over the whole box: at a pole one of the derivatives is nothing there.
    const double lengths = du.Magnitude() * dv.Magnitude();
    if (n.Magnitude() > 1e-9 * lengths && du.Magnitude() * (box.u1 - box.u0) > 1e-7 &&
        dv.Magnitude() * (box.v1 - box.v0) > 1e-7)
      return n.Normalized();
    part = part == 0 ? 1e-5 : part * 4;
  }
  return gp_Vec(0, 0, 0);
}

Handle(Geom_Surface) surface_of(const TopoDS_Face& face) {
  Handle(Geom_Surface) s = BRep_Tool::Surface(face);
  while (const auto t = Handle(Geom_RectangularTrimmedSurface)::DownCast(s)) s = t->BasisSurface();
  return s;
}

namespace {

// How long spans of a fit may be at first, in u or v, so that no change of a distance is passed over between the points
// that are looked at. Not measured.
double longest_span(const Geom_Surface& surface, const Box2& box, double detail, bool along_u) {
  constexpr double kFewSpans = 8, kManySpans = 64;
  const double range = along_u ? box.u1 - box.u0 : box.v1 - box.v0;
  double spans = kFewSpans;
  for (const double part : {0.1, 0.5, 0.9}) {
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(box.u0 + part * (box.u1 - box.u0), box.v0 + part * (box.v1 - box.v0), p, du, dv);
    if (detail > 0) spans = std::max(spans, (along_u ? du : dv).Magnitude() * range / detail);
  }
  return range / std::min(spans, kManySpans);
}

// Points and normals of a surface within a box and somewhat beyond. Beyond a pole normals turn over: there the surface
// goes on straight, as at the apex of a cone. At a pole the normal is what those beside it come to: of a round one,
// that along the axis, so that the offset closes there as well.
struct PoleNormals {
  const Geom_Surface& surface;
  const Box2& box;
  const Sides& poles;

  static constexpr double kBeside = 1e-4;  // of the box

  gp_Pnt2d beside(const gp_Pnt2d& at, double steps) const {
    const auto moved = [steps](double t, double t0, double t1, bool pole0, bool pole1) {
      const double step = steps * kBeside * (t1 - t0);
      return std::clamp(t, pole0 ? t0 + step : t - 1, pole1 ? t1 - step : t + 1);
    };
    return {moved(at.X(), box.u0, box.u1, poles.u0, poles.u1), moved(at.Y(), box.v0, box.v1, poles.v0, poles.v1)};
  }

  gp_Pnt point(double u, double v) const {
    const gp_Pnt2d at(u, v), in = beside(at, 0), from = beside(at, 1);
    if (in.Distance(at) == 0) return surface.Value(u, v);
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(from.X(), from.Y(), p, du, dv);
    return p.Translated(du * (u - from.X()) + dv * (v - from.Y()));
  }

  gp_Vec normal(double u, double v) const {
    const gp_Pnt2d in = beside({u, v}, 0), near = beside(in, 1), far = beside(in, 2);
    const gp_Vec n = unit_normal(surface, near.X(), near.Y(), box);
    if (near.Distance(in) == 0) return n;
    const double ratio = in.Distance(near) / near.Distance(far);
    return (n + (n - unit_normal(surface, far.X(), far.Y(), box)) * ratio).Normalized();
  }
};

OffsetSurface fitted(const Handle(Geom_Surface) & surface, const Box2& box, const FaceDistance& distance,
                     const Sides& drawn_sides, double margin, double tolerance) {
  const bool is_constant = !distance.at;
  const Sides poles = poles_of(*surface, box);
  const Box2 wide = drawn_out(*surface, box, poles, drawn_sides, margin);
  const PoleNormals normals{*surface, box, poles};
  const auto map = [&](double u, double v) {
    return normals.point(u, v).Translated(normals.normal(u, v) * distance(u, v));
  };
  OffsetSurface result;
  result.made = FaceMade::Fitted;
  if (is_constant) {
    if (const auto s = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface)) {
      const FittedCurve fit =
          fit_curve([&](double u) { return map(u, 0); }, knots_along(s->BasisCurve(), wide.u0, wide.u1), tolerance);
      result.surface = new Geom_SurfaceOfLinearExtrusion(fit.curve, s->Direction());
      result.error = fit.error;
      return result;
    }
    if (const auto s = Handle(Geom_SurfaceOfRevolution)::DownCast(surface)) {
      const FittedCurve fit =
          fit_curve([&](double v) { return map(0, v); }, knots_along(s->BasisCurve(), wide.v0, wide.v1), tolerance);
      result.surface = new Geom_SurfaceOfRevolution(fit.curve, s->Axis());
      result.error = fit.error;
      return result;
    }
  }
  Knots u = knots_along(surface, true, wide.u0, wide.u1), v = knots_along(surface, false, wide.v0, wide.v1);
  if (!is_constant) {
    u = divided(u, longest_span(*surface, box, distance.detail, true));
    v = divided(v, longest_span(*surface, box, distance.detail, false));
  }
  const FittedSurface fit = fit_surface(map, u, v, tolerance);
  result.surface = fit.surface;
  result.error = fit.error;
  return result;
}

}  // namespace

OffsetSurface offset_surface(const Handle(Geom_Surface) & surface, const Box2& box, const FaceDistance& distance,
                             const Sides& drawn_sides, double margin, double tolerance) {
  if (!distance.at) {
    const OffsetSurface elementary = offset_elementary(surface, box, distance.constant);
    if (!elementary.surface.IsNull() || elementary.made == FaceMade::Swallowed) return elementary;
  }
  OffsetSurface best;
  for (double part : {1.0, 0.3, 0.05, 0.0}) {
    const OffsetSurface fit = fitted(surface, box, distance, drawn_sides, margin * part, tolerance);
    if (best.surface.IsNull() || fit.error < best.error) best = fit;
    if (best.error <= tolerance) break;
  }
  return best;
}

}  // namespace vdb_offset::cad
