// SPDX-License-Identifier: Apache-2.0
#include "surface/face_surface.h"

#include <BRepTools.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <numbers>

namespace vdb_offset::cad {
namespace {

// A direction whose sine against another is below this has no side that doubles could resolve.
constexpr double kNoDirection = 1e-10;
// Where a face is so narrow, as a share of what it is along, its directions are those of rounded numbers.
constexpr double kNoWidth = 1e-9;
// Steps of a search that starts beside its end: they square the error.
constexpr int kMostSearchSteps = 20;
// How far a search may leave the range of a face's parameters, as a share of it: points of miters lie outside.
constexpr double kBeyond = 0.25;

/// The angle that is the nearest to `near` of those that differ by whole turns.
double turned_near(double angle, double near) {
  constexpr double kTurn = 2 * std::numbers::pi;
  return angle + kTurn * std::round((near - angle) / kTurn);
}

bool is_known(GeomAbs_SurfaceType type) {
  return type == GeomAbs_Plane || type == GeomAbs_Cylinder || type == GeomAbs_Cone || type == GeomAbs_Sphere ||
         type == GeomAbs_Torus;
}

}  // namespace

FaceSurface::FaceSurface(const TopoDS_Face& face)
    : surface_(face, Standard_False), type_(surface_.GetType()), is_analytic_(is_known(type_)) {
  BRepTools::UVBounds(face, u_[0], u_[1], v_[0], v_[1]);
  switch (type_) {
    case GeomAbs_Plane:
      frame_ = surface_.Plane().Position();
      break;
    case GeomAbs_Cylinder:
      frame_ = surface_.Cylinder().Position();
      radius_ = surface_.Cylinder().Radius();
      break;
    case GeomAbs_Cone:
      frame_ = surface_.Cone().Position();
      radius_ = surface_.Cone().RefRadius();
      sine_ = std::sin(surface_.Cone().SemiAngle());
      cosine_ = std::cos(surface_.Cone().SemiAngle());
      break;
    case GeomAbs_Sphere:
      frame_ = surface_.Sphere().Position();
      radius_ = surface_.Sphere().Radius();
      break;
    case GeomAbs_Torus:
      frame_ = surface_.Torus().Position();
      radius_ = surface_.Torus().MajorRadius();
      tube_ = surface_.Torus().MinorRadius();
      break;
    default:
      break;
  }
  side_ = frame_.Direct() ? 1 : -1;
  size_ = std::max({radius_ + tube_, std::abs(v_[1] - v_[0]) * std::abs(sine_), 1e-300});
}

std::string FaceSurface::kind() const {
  switch (type_) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
      return "bezier";
    case GeomAbs_BSplineSurface:
      return "b-spline";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_OffsetSurface:
      return "offset";
    default:
      return "other";
  }
}

FaceSurface::Local FaceSurface::local(const gp_Pnt& point) const {
  const gp_Vec from(frame_.Location(), point);
  return {from.Dot(frame_.XDirection()), from.Dot(frame_.YDirection()), from.Dot(frame_.Direction())};
}

gp_Vec FaceSurface::global(double x, double y, double z) const {
  return gp_Vec(frame_.XDirection()) * x + gp_Vec(frame_.YDirection()) * y + gp_Vec(frame_.Direction()) * z;
}

/// How far the circle of constant v is from the axis, less than 0 on the other side of it.
double FaceSurface::ring(double v) const {
  if (type_ == GeomAbs_Cone) return radius_ + v * sine_;
  if (type_ == GeomAbs_Sphere) return radius_ * std::cos(v);
  if (type_ == GeomAbs_Torus) return radius_ + tube_ * std::cos(v);
  return radius_;
}

/// Whether the part of a cone or torus that v is on has changed sides with the axis; where the two meet, the face's.
bool FaceSurface::is_beyond_apex(double v) const {
  const double at = ring(v);
  return (std::abs(at) > kNoDirection * size_ ? at : ring((v_[0] + v_[1]) / 2)) < 0;
}

bool FaceSurface::is_pole_of_u(double u, double v) const {
  if (is_analytic_) return true;
  gp_Pnt at;
  gp_Vec du, dv;
  surface_.D1(u, v, at, du, dv);
  return du.Magnitude() * (u_[1] - u_[0]) <= dv.Magnitude() * (v_[1] - v_[0]);
}

gp_Pnt FaceSurface::point(double u, double v) const { return surface_.Value(u, v); }

std::optional<gp_Vec> FaceSurface::normal(double u, double v) const {
  if (type_ == GeomAbs_Plane) return global(0, 0, side_);
  const double c = std::cos(u), s = std::sin(u);
  if (type_ == GeomAbs_Cylinder) return global(side_ * c, side_ * s, 0);
  if (type_ == GeomAbs_Cone) {
    const double side = is_beyond_apex(v) ? -side_ : side_;
    return global(side * cosine_ * c, side * cosine_ * s, -side * sine_);
  }
  if (type_ == GeomAbs_Sphere || type_ == GeomAbs_Torus) {
    const double side = type_ == GeomAbs_Torus && is_beyond_apex(v) ? -side_ : side_;
    return global(side * std::cos(v) * c, side * std::cos(v) * s, side * std::sin(v));
  }
  gp_Pnt at;
  gp_Vec du, dv;
  surface_.D1(u, v, at, du, dv);
  const gp_Vec across = du.Crossed(dv);
  const double width = du.Magnitude() * (u_[1] - u_[0]), height = dv.Magnitude() * (v_[1] - v_[0]);
  const double area = across.Magnitude();
  const bool is_pole = std::min(width, height) <= kNoWidth * std::max(width, height);
  if (!(area > kNoDirection * du.Magnitude() * dv.Magnitude()) || !(area > 0) || is_pole) return std::nullopt;
  return across / area;
}

Foot FaceSurface::analytic_foot(const gp_Pnt& point, double u, double v) const {
  const Local at = local(point);
  if (type_ == GeomAbs_Plane) return {at.x, at.y, side_ * at.z};
  const double across = std::hypot(at.x, at.y);
  const bool is_beyond = type_ != GeomAbs_Sphere && is_beyond_apex(v);
  const double out = is_beyond ? -across : across, side = is_beyond ? -side_ : side_;
  Foot foot{u, v, 0};
  if (across > kNoDirection * size_)
    foot.u = turned_near(is_beyond ? std::atan2(-at.y, -at.x) : std::atan2(at.y, at.x), u);
  switch (type_) {
    case GeomAbs_Cylinder:
      foot.v = at.z;
      foot.distance = side * (out - radius_);
      break;
    case GeomAbs_Cone:
      foot.v = (out - radius_) * sine_ + at.z * cosine_;
      foot.distance = side * ((out - radius_) * cosine_ - at.z * sine_);
      break;
    case GeomAbs_Sphere:
      foot.v = std::atan2(at.z, across);
      foot.distance = side * (std::hypot(across, at.z) - radius_);
      break;
    default:
      foot.v = turned_near(std::atan2(at.z, out - radius_), v);
      foot.distance = side * (std::hypot(out - radius_, at.z) - tube_);
      break;
  }
  return foot;
}

/// Newton's method on half the squared distance.
Foot FaceSurface::searched_foot(const gp_Pnt& point, double u, double v) const {
  const double most_u = kBeyond * (u_[1] - u_[0]), most_v = kBeyond * (v_[1] - v_[0]);
  const double start_u = u, start_v = v, start = point.Distance(surface_.Value(u, v));
  gp_Pnt at;
  gp_Vec du, dv, duu, dvv, duv;
  for (int step = 0; step < kMostSearchSteps; ++step) {
    surface_.D2(u, v, at, du, dv, duu, dvv, duv);
    const gp_Vec off(point, at);
    const double gu = off.Dot(du), gv = off.Dot(dv);
    double a = du.SquareMagnitude(), b = du.Dot(dv), c = dv.SquareMagnitude();
    const double fa = a + off.Dot(duu), fb = b + off.Dot(duv), fc = c + off.Dot(dvv);
    // Where the distance curves the other way, by the first derivatives alone, which lead downhill.
    if (fa > 0 && fa * fc - fb * fb > 1e-3 * (a * c - b * b)) a = fa, b = fb, c = fc;
    const double determinant = a * c - b * b;
    const double width = du.Magnitude() * (u_[1] - u_[0]), height = dv.Magnitude() * (v_[1] - v_[0]);
    double step_u = 0, step_v = 0;
    // At a pole, along the direction that there is; the other parameter is left as it is.
    if (width <= kNoWidth * height) {
      step_v = c > 0 ? -gv / c : 0;
    } else if (height <= kNoWidth * width) {
      step_u = -gu / a;
    } else if (determinant > 1e-14 * a * c) {
      step_u = (b * gv - c * gu) / determinant;
      step_v = (b * gu - a * gv) / determinant;
    }
    u = std::clamp(u + std::clamp(step_u, -most_u, most_u), u_[0] - most_u, u_[1] + most_u);
    v = std::clamp(v + std::clamp(step_v, -most_v, most_v), v_[0] - most_v, v_[1] + most_v);
    if (std::abs(step_u) <= 1e-13 * (u_[1] - u_[0]) && std::abs(step_v) <= 1e-13 * (v_[1] - v_[0])) break;
  }
  if (!(point.Distance(surface_.Value(u, v)) <= start)) u = start_u, v = start_v;  // it went astray
  surface_.D1(u, v, at, du, dv);
  const gp_Vec off(at, point);
  return {u, v, std::copysign(off.Magnitude(), off.Dot(du.Crossed(dv)))};
}

Foot FaceSurface::foot(const gp_Pnt& point, double u, double v) const {
  return is_analytic_ ? analytic_foot(point, u, v) : searched_foot(point, u, v);
}

double FaceSurface::height(const gp_Pnt& point, double u, double v) const {
  if (is_analytic_) return std::abs(analytic_foot(point, u, v).distance);
  gp_Pnt at;
  gp_Vec du, dv;
  surface_.D1(u, v, at, du, dv);
  const gp_Vec across = du.Crossed(dv), off(at, point);
  const double area = across.Magnitude();
  return area > 0 ? std::abs(off.Dot(across)) / area : off.Magnitude();
}

}  // namespace vdb_offset::cad
