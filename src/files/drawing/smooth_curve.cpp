// SPDX-License-Identifier: Apache-2.0
// Curved segments: their points, and how many straight segments stand for one.
#include "drawing/smooth_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vdb_offset::io {
namespace {

constexpr double kPi = std::numbers::pi;

double distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const Vec2d along = b - a, to = p - a;
  const double length = std::hypot(along[0], along[1]);
  if (!(length > 0)) return std::hypot(to[0], to[1]);
  const double x = along[0] / length, y = along[1] / length;
  const double on = std::clamp(to[0] * x + to[1] * y, 0.0, length);
  return std::hypot(to[0] - on * x, to[1] - on * y);
}

/// The largest distance of centre + middle cos a + across sin a from the centre: the larger half axis of the ellipse.
double larger_half_axis(const SvgArc& arc) {
  // The largest singular value of a matrix with the columns (a, b) and (c, d), without squares that could overflow.
  const double a = arc.middle[0], b = arc.middle[1], c = arc.across[0], d = arc.across[1];
  return (std::hypot(a + d, b - c) + std::hypot(a - d, b + c)) / 2;
}

double segments_of(double tolerance, const SvgBezier& bezier) {
  const auto& [a, b, c, d] = bezier.points;
  // The curve is within the hull of its points, and it passes over all of the segment between its ends. So it is as
  // near to that as the points are. Curves that are straight stay one segment.
  if (distance_to_segment(b, a, d) <= tolerance && distance_to_segment(c, a, d) <= tolerance) return 1;
  // A chord over a step h of the parameter is within h^2 / 8 times the largest second derivative of the curve, which is
  // 6 times the larger one of the second differences of its points.
  const Vec2d first = a - 2.0 * b + c, second = b - 2.0 * c + d;
  const double most = std::max(std::hypot(first[0], first[1]), std::hypot(second[0], second[1]));
  return std::max(1.0, std::ceil(std::sqrt(0.75 * most / tolerance)));
}

double segments_of(double tolerance, const SvgArc& arc) {
  // A chord over an angle h of the unit circle is within the sagitta 1 - cos(h / 2) = 2 sin^2(h / 4) of it, and an
  // ellipse is that circle with no length more than its larger half axis times as long. A step is a quarter turn at
  // most, so that a circle is a square at least.
  const double share = tolerance / larger_half_axis(arc);
  const double step = std::min(kPi / 2, 4 * std::asin(std::sqrt(std::min(1.0, share / 2))));
  constexpr double kRounding = 1e-12;  // of a count: a quarter turn is one step, whichever way it is rounded
  return std::max(1.0, std::ceil(std::abs(2 * arc.half) / step - kRounding));
}

Vec2d point_at(const SvgBezier& bezier, std::size_t k, std::size_t n) {
  const auto& [a, b, c, d] = bezier.points;
  // Written so that the curve from its other end gives the same bits.
  const double s = static_cast<double>(n - k) / static_cast<double>(n),
               t = static_cast<double>(k) / static_cast<double>(n);
  return (s * s * s * a + t * t * t * d) + 3 * (s * t) * (s * b + t * c);
}

Vec2d point_at(const SvgArc& arc, std::size_t k, std::size_t n) {
  // Angles on both sides of the middle are the same but for their sign, and so points are symmetric to the last bit.
  const double steps = static_cast<double>(k) - static_cast<double>(n - k);
  const double angle = arc.half * steps / static_cast<double>(n);
  return arc.centre + (std::cos(angle) * arc.middle + std::sin(angle) * arc.across);
}

/// Adds the points between the ends of a curve where it is farthest along x or y.
void add_extremes(SvgBox& box, const SvgBezier& bezier) {
  const std::array<Vec2d, 4>& p = bezier.points;
  const auto add_at = [&](double t) {
    if (!(t > 0 && t < 1)) return;
    const double s = 1 - t;
    box.add(s * s * s * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t * t * t * p[3]);
  };
  for (int k = 0; k < 2; ++k) {
    // The derivative is 3 (u (1 - t)^2 + 2 v (1 - t) t + w t^2), here without a factor, so that no square overflows.
    double u = p[1][k] - p[0][k], v = p[2][k] - p[1][k], w = p[3][k] - p[2][k];
    const double largest = std::max({std::abs(u), std::abs(v), std::abs(w)});
    if (!(largest > 0)) continue;
    u /= largest, v /= largest, w /= largest;
    const double root = std::sqrt(std::max(0.0, v * v - u * w));
    for (const double sum : {u - v + root, u - v - root}) {
      add_at(sum / (u - 2 * v + w));
      add_at(u / sum);
    }
  }
}

void add_extremes(SvgBox& box, const SvgArc& arc) {
  for (int k = 0; k < 2; ++k) {
    const double farthest = std::atan2(arc.across[k], arc.middle[k]);
    for (const double angle : {farthest - kPi, farthest, farthest + kPi})
      if (std::abs(angle) < std::abs(arc.half))
        box.add(arc.centre + (std::cos(angle) * arc.middle + std::sin(angle) * arc.across));
  }
}

Vec2d first_of(const SvgCurve& curve) {
  const SvgArc* const arc = std::get_if<SvgArc>(&curve);
  return arc ? arc->first : std::get<SvgBezier>(curve).points.front();
}

Vec2d last_of(const SvgCurve& curve) {
  const SvgArc* const arc = std::get_if<SvgArc>(&curve);
  return arc ? arc->last : std::get<SvgBezier>(curve).points.back();
}

Vec2d in_plane(const Vec3d& p) { return {p[0], p[1]}; }

}  // namespace

SvgCurve quadratic_curve(const Vec2d& first, const Vec2d& between, const Vec2d& last) {
  return SvgBezier{{first, (first + 2.0 * between) / 3, (last + 2.0 * between) / 3, last}};
}

std::optional<SvgCurve> arc_between(const Vec2d& first, const Vec2d& last, const Vec2d& radii, double turn, bool large,
                                    bool sweep) {
  const double rx = std::abs(radii[0]), ry = std::abs(radii[1]);
  if (!(rx > 0 && ry > 0)) return std::nullopt;
  const double c = std::cos(turn * kPi / 180), s = std::sin(turn * kPi / 180);
  // Where the ellipse is the unit circle, the ends are half this chord to both sides of the middle between them
  // (F.6.5.1).
  const Vec2d chord = (first - last) / 2;
  Vec2d half((c * chord[0] + s * chord[1]) / rx, (c * chord[1] - s * chord[0]) / ry);
  const double length = std::hypot(half[0], half[1]);
  half /= length;
  const double growth = std::max(1.0, length), sine = std::min(1.0, length);  // radii that are too small grow (F.6.6.2)
  const Vec2d u(c * rx * growth, s * rx * growth), v(-s * ry * growth, c * ry * growth);
  // Seen from the centre, the arc's middle is square to the chord, and the centre is as far on the other side of the
  // chord as the cosine of half the arc's angle says.
  const double cosine = std::sqrt((1 - sine) * (1 + sine)) * (large ? -1 : 1), turned = sweep ? 1 : -1;
  const Vec2d towards(-turned * half[1], turned * half[0]);
  const Vec2d middle = towards[0] * u + towards[1] * v, across = towards[0] * v - towards[1] * u;
  return SvgArc{first, last, (first + last) / 2 - cosine * middle, middle, across, turned * std::atan2(sine, cosine)};
}

SvgCurve quarter_of_ellipse(const Vec2d& centre, const Vec2d& radii, int quarter) {
  constexpr double kAxes[] = {1, 0, -1, 0, 1};  // their x; y of each is x of the one before
  const auto scaled = [&](const Vec2d& axis) { return Vec2d(axis[0] * radii[0], axis[1] * radii[1]); };
  const Vec2d from(kAxes[quarter], kAxes[(quarter + 3) % 4]), to(kAxes[quarter + 1], kAxes[quarter]);
  const double diagonal = std::numbers::sqrt2 / 2;
  return SvgArc{centre + scaled(from),
                centre + scaled(to),
                centre,
                scaled((from + to) * diagonal),
                scaled((to - from) * diagonal),
                kPi / 4};
}

SvgCurve transformed(const SvgMatrix& m, const SvgCurve& curve) {
  const auto point = [&](const Vec2d& p) { return in_plane(transformed(m, p)); };
  const auto vector = [&](const Vec2d& p) { return Vec2d(m[0] * p[0] + m[2] * p[1], m[1] * p[0] + m[3] * p[1]); };
  if (const SvgArc* const arc = std::get_if<SvgArc>(&curve))
    return SvgArc{point(arc->first),   point(arc->last),    point(arc->centre),
                  vector(arc->middle), vector(arc->across), arc->half};
  const auto& [a, b, c, d] = std::get<SvgBezier>(curve).points;
  return SvgBezier{{point(a), point(b), point(c), point(d)}};
}

double segments_within(double tolerance, const SvgCurve& curve) {
  return std::visit([&](const auto& each) { return segments_of(tolerance, each); }, curve);
}

Vec2d point_at(const SvgCurve& curve, std::size_t k, std::size_t n) {
  if (k == 0) return first_of(curve);
  if (k == n) return last_of(curve);
  return std::visit([&](const auto& each) { return point_at(each, k, n); }, curve);
}

void SvgBox::add(const Vec2d& p) {
  for (int k = 0; k < 2; ++k) {
    lower_[k] = std::min(lower_[k], p[k]);
    upper_[k] = std::max(upper_[k], p[k]);
  }
}

void SvgBox::add(const SvgCurve& curve) {
  add(first_of(curve));
  add(last_of(curve));
  std::visit([&](const auto& each) { add_extremes(*this, each); }, curve);
}

double SvgBox::diagonal() const { return std::hypot(upper_[0] - lower_[0], upper_[1] - lower_[1]); }

}  // namespace vdb_offset::io
