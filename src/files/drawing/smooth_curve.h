// SPDX-License-Identifier: Apache-2.0
#pragma once

// Curved segments of an SVG drawing, and how they are flattened: replaced by straight segments between points of them.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <variant>

#include "drawing/transform.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// A cubic Bézier curve: its two ends, and two points between that it is drawn to.
struct SvgBezier {
  std::array<Vec2d, 4> points;
};

/// An arc of an ellipse: its points are centre + middle cos a + across sin a, for a from -half to half.
struct SvgArc {
  Vec2d first, last;  ///< The ends, as they were given.
  Vec2d centre, middle, across;
  double half = 0;  ///< Radians; below 0 if the arc runs the other way.
};

using SvgCurve = std::variant<SvgBezier, SvgArc>;

/// The cubic curve that a quadratic one is.
SvgCurve quadratic_curve(const Vec2d& first, const Vec2d& between, const Vec2d& last);

/// An arc as paths have them: SVG 1.1, appendix F.6. `turn` is in degrees; radii that are too small grow. None for a
/// straight line: where a radius is 0. \pre the ends differ
std::optional<SvgCurve> arc_between(const Vec2d& first, const Vec2d& last, const Vec2d& radii, double turn, bool large,
                                    bool sweep);

/// A quarter of an ellipse with axes along x and y: 0 from the end of the x axis to that of the y axis, and so on.
SvgCurve quarter_of_ellipse(const Vec2d& centre, const Vec2d& radii, int quarter);

SvgCurve transformed(const SvgMatrix& m, const SvgCurve& curve);

/// The least number of equal steps of the parameter for which straight segments between are proven to be nowhere
/// farther than `tolerance` from the curve, nor the curve from them; as a double, as it may be beyond all integers.
double segments_within(double tolerance, const SvgCurve& curve);

/// The point of a curve behind k of n equal steps of its parameter. At both ends it is the end as it was given.
/// Steps from the other end give the same bits.
Vec2d point_at(const SvgCurve& curve, std::size_t k, std::size_t n);

/// The smallest box around points and curves.
class SvgBox {
 public:
  void add(const Vec2d& p);
  void add(const SvgCurve& curve);
  double diagonal() const;
  const Vec2d& lower() const { return lower_; }
  const Vec2d& upper() const { return upper_; }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec2d lower_{kFar, kFar}, upper_{-kFar, -kFar};
};

}  // namespace vdb_offset::io
