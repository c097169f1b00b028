// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "space/curve/ribbon.h"

/// Curves to try, and what holds of them by brute force.
namespace vdb_offset::test {

inline constexpr double kTurn = 2 * std::numbers::pi;

/// Points that are joined in their order, back to the first if closed.
Curves curve_through(const std::vector<Vec3d>& points, bool closed);

/// radius(angle) all the way round, counterclockwise.
template <class Radius>
Curves star(int count, Radius&& radius) {
  std::vector<Vec3d> points;
  for (int i = 0; i < count; ++i) {
    const double a = kTurn * i / count, r = radius(a);
    points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
  }
  return curve_through(points, true);
}

/// `teeth` slits of width `gap`, whose walls have a point every `step`.
Curves comb(int teeth, double gap, double step);

/// All pairs of segments, not neighbours along a curve, that meet with the points at `positions`: without rounding.
std::set<std::pair<std::size_t, std::size_t>> meeting(const Curves& curves, const std::vector<Vec3d>& positions);

/// Pairs that do not meet in the curves themselves.
std::size_t new_crossings(const Curves& curves, const std::vector<Vec3d>& positions);

/// Distance to the nearest segment.
double distance_to(const Curves& curves, const Vec3d& x);

}  // namespace vdb_offset::test
