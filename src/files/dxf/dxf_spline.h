// SPDX-License-Identifier: Apache-2.0
#pragma once

// Rational B-splines: their Bézier pieces, and how these are flattened.

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// A control point times its weight, and the weight.
using DxfWeighted = std::array<double, 4>;
inline Vec3d point_of(const DxfWeighted& p) { return {p[0] / p[3], p[1] / p[3], p[2] / p[3]}; }

/// A rational Bézier curve of any degree. All weights are above 0.
using DxfBezier = std::vector<DxfWeighted>;

struct DxfSpline {
  std::size_t degree = 3;
  std::vector<double> knots;  ///< As many as points + degree + 1, none less than the one before.
  std::vector<DxfWeighted> points;
};

/// The Bézier curves that a spline consists of, in order: one for each of its knot spans that is not empty.
std::vector<DxfBezier> bezier_pieces(const DxfSpline& spline);

/// Both halves of a curve, cut in the middle of its parameter.
std::array<DxfBezier, 2> halves_of(const DxfBezier& curve);

/// Whether the segment between a curve's ends is proven to be nowhere farther than `tolerance` from the curve, nor the
/// curve from it. The curve is within the hull of its control points, as weights are above 0, and passes over all of
/// the segment. So it is as near to that as the points are.
bool is_flat(const DxfBezier& curve, double tolerance);

/// Calls add(point) for the ends of the straight segments that a curve is flattened to: for each but its first point,
/// its last one among them. False if they would need more halvings than doubles resolve.
template <class Add>
bool flatten_dxf(const DxfBezier& curve, double tolerance, const Add& add, int halvings = 0) {
  constexpr int kMostHalvings = 40;
  if (is_flat(curve, tolerance)) {
    add(point_of(curve.back()));
    return true;
  }
  if (halvings == kMostHalvings) return false;
  const std::array<DxfBezier, 2> halves = halves_of(curve);
  return flatten_dxf(halves[0], tolerance, add, halvings + 1) && flatten_dxf(halves[1], tolerance, add, halvings + 1);
}

}  // namespace vdb_offset::io
