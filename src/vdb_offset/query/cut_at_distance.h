#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "vdb_offset/query/closest_query.h"

/// Where a straight way comes to be at a distance from a Surface or a Polyline.
namespace vdb_offset {

/// A place, and what is closest to it.
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

/// How far along `way`, in ways, what is closest to a place comes to be at a distance, if it ever does on the rise.
template <class Shape>
std::optional<double> share_to_distance(const Shape& shape, const Sample& from, const Vec3d& way, double distance) {
  const Vec3d across = shape.across(from.triangle, from.feature, from.away, way);
  const double rise = from.away.dot(across), above = (from.phi - distance) * (from.phi + distance),
               root = rise * rise - above * across.lengthSqr();
  if (!(rise > 0 && root >= 0)) return std::nullopt;
  return -above / (rise + std::sqrt(root));
}

/// Between a place short of a distance and one at or past it: where what is closest to the one that is the nearer to
/// the distance comes to be there, then the same from that place, as what is closest on the way is one thing, or few;
/// false position, and by halves, where that leads out of what is left. The last place that measure(x) was asked for a
/// Sample at, settled(sample) or not.
template <class Shape, class Measure, class Settled>
Sample cut_at_distance(const Shape& shape, const Sample& near, const Sample& far, double distance, Measure&& measure,
                       Settled&& settled) {
  constexpr int kMostSteps = 100, kLetFall = 8;
  const Vec3d way = far.x - near.x;
  double low = 0, below = near.phi - distance, high = 1, above = far.phi - distance;
  bool from_low = -below < above;
  Sample at = from_low ? near : far;
  for (int i = 0; i < kMostSteps && !settled(at); ++i) {
    const auto further = share_to_distance(shape, at, way, distance);
    double t = (from_low ? low : high) + further.value_or(high - low);
    if (!(t > low && t < high)) t = i < kLetFall ? (low * above - high * below) / (above - below) : (low + high) / 2;
    at = measure(near.x + way * t);
    from_low = at.phi < distance;
    (from_low ? low : high) = t;
    (from_low ? below : above) = at.phi - distance;
  }
  return at;
}

}  // namespace vdb_offset
