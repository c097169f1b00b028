// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

#include "ground/system/assert.h"
#include "space/query/closest_query.h"
#include "space/surface/inside.h"

namespace vdb_offset {

/// The iso-surface phi = level, which vertices are put on. phi is the distance to a surface, below 0 inside of it;
/// points are in that surface's local frame.
class IsoLevel {
 public:
  /// Keeps references to `query` and `inside`. `voxel_size` is the spacing of the points that are asked for.
  IsoLevel(const ClosestQuery& query, const Inside& inside, double level, double voxel_size)
      : query_(query), inside_(inside), level_(level), h_(voxel_size) {
    VDB_OFFSET_ASSERT(level != 0 && voxel_size > 0);
  }

  const ClosestQuery& query() const { return query_; }
  double level() const { return level_; }
  double distance() const { return std::abs(level_); }
  double voxel_size() const { return h_; }

  /// Whether an unsigned distance is that of the iso-surface. Vertices are put so near to it, unless they are rounded.
  bool is_reached(double distance) const {
    return std::abs(distance - this->distance()) <= kTolerance * this->distance();
  }
  /// Whether x, which has the unsigned distance of the iso-surface, has its sign, too. It is looked for only near the
  /// source: elsewhere no voxel has both signs in it.
  bool is_on_side(const Vec3d& x) const {
    // Two diagonals, in voxels: the distance from a vertex's own voxel within which the source may be.
    constexpr double kVoxelDiagonals = 2 * 1.7321;
    if (!inside_.has_inside() || kVoxelDiagonals * h_ < distance()) return true;
    return inside_(x) == (level_ < 0);
  }

  /// phi - level at x.
  /// \param hint a triangle to start from; receives the closest one
  double operator()(const Vec3d& x, std::uint32_t& hint) const {
    const Closest closest = query_(x, hint);
    hint = closest.triangle;
    return (inside_(x) ? -closest.distance : closest.distance) - level_;
  }

  /// Goes from x along the gradient of phi to the level, as long as `is_near` holds. Inward, phi is linear along it and
  /// one step is exact; outward phi may rise more slowly, and not at all at the medial axis.
  template <class IsNear>
  std::optional<Vec3d> follow(Vec3d x, std::uint32_t& hint, IsNear&& is_near) const {
    constexpr int kMostSteps = 20;  // Not measured.
    for (int step = 0; step < kMostSteps; ++step) {
      const Closest closest = query_(x, hint);
      hint = closest.triangle;
      if (is_reached(closest.distance)) return is_on_side(x) ? std::optional(x) : std::nullopt;
      if (closest.distance == 0) return std::nullopt;
      x = closest.point + (x - closest.point) * (distance() / closest.distance);
      if (!is_near(x)) return std::nullopt;
    }
    return std::nullopt;
  }

  /// A point with phi = level between two points with phi below and above it, by bisection.
  Vec3d between(Vec3d below, Vec3d above, std::uint32_t& hint) const {
    constexpr int kMostSteps = 60;  // Then the points differ by rounding alone.
    for (int step = 0; step < kMostSteps; ++step) {
      const Vec3d middle = (below + above) / 2.0;
      const double value = (*this)(middle, hint);
      if (std::abs(value) <= kTolerance * distance()) return middle;
      (value < 0 ? below : above) = middle;
    }
    return (below + above) / 2.0;
  }

 private:
  // The largest error of a distance, relative to it, at which a point is on the iso-surface: far below the promised
  // 1e-6, far above rounding.
  static constexpr double kTolerance = 1e-9;

  const ClosestQuery& query_;
  const Inside& inside_;
  double level_, h_;
};

}  // namespace vdb_offset
