// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "space/query/closest_query.h"

/// Positions on a straight segment at a distance from a Surface or a Polyline.
namespace vdb_offset {

/// A position, and the closest point of the surface.
struct Sample {
  Vec3d x;
  double phi;  ///< Unsigned distance, world units.
  Vec3d away;  ///< From the closest point to x.
  std::uint32_t triangle;
  Feature feature;
};

inline Sample sample_at(const Vec3d& x, const Closest& closest) {
  return {x, closest.distance, x - closest.point, closest.triangle, closest.feature};
}

inline Sample sample_at(const Vec3d& x, std::uint32_t triangle, const TrianglePoint& nearest) {
  return {x, std::sqrt(nearest.squared_distance), x - nearest.point, triangle, nearest.feature};
}

/// The share of a displacement at which a position is at a distance from the feature that is closest to it now. None if
/// the distance from that feature never grows so far.
template <class Shape>
std::optional<double> share_to_distance(const Shape& shape, const Sample& from, const Vec3d& displacement,
                                        double distance) {
  const Vec3d across = shape.across(from.triangle, from.feature, from.away, displacement);
  const double rise = from.away.dot(across), above = (from.phi - distance) * (from.phi + distance),
               root = rise * rise - above * across.lengthSqr();
  if (!(rise > 0 && root >= 0)) return std::nullopt;
  return -above / (rise + std::sqrt(root));
}

/// Finds the position at a distance between one that is short of it and one that is at it or past it: where the feature
/// that is closest to the better of the two is at the distance, then the same from there, as one feature, or few, are
/// the closest between both. Where that leads out of the remaining interval, false position and bisection. Returns the
/// last Sample that measure(x) gave, whether or not settled(sample) accepts it.
template <class Shape, class Measure, class Settled>
Sample cut_at_distance(const Shape& shape, const Sample& near, const Sample& far, double distance, Measure&& measure,
                       Settled&& settled) {
  // kMostSteps: bisection alone gains a bit in each step, and a double has fewer. kLetFall: steps of false position,
  // which is slow where it is one-sided, before bisection. Not measured.
  constexpr int kMostSteps = 100, kLetFall = 8;
  const Vec3d segment = far.x - near.x;
  double low = 0, below = near.phi - distance, high = 1, above = far.phi - distance;
  bool from_low = -below < above;
  Sample at = from_low ? near : far;
  for (int i = 0; i < kMostSteps && !settled(at); ++i) {
    const auto further = share_to_distance(shape, at, segment, distance);
    double t = (from_low ? low : high) + further.value_or(high - low);
    if (!(t > low && t < high)) t = i < kLetFall ? (low * above - high * below) / (above - below) : (low + high) / 2;
    at = measure(near.x + segment * t);
    from_low = at.phi < distance;
    (from_low ? low : high) = t;
    (from_low ? below : above) = at.phi - distance;
  }
  return at;
}

}  // namespace vdb_offset
