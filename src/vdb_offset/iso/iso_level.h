#pragma once

#include <cmath>
#include <optional>

#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/surface/inside.h"

namespace vdb_offset {

/// The surface phi = level, as a place to put vertices on. phi is the distance to a surface, below 0 inside of it;
/// points are in that surface's local frame.
class LevelSet {
 public:
  /// Keeps references to the first two. `voxel_size` tells how far from each other points are that are asked for.
  LevelSet(const ClosestQuery& query, const Inside& inside, double level, double voxel_size)
      : query_(query), inside_(inside), level_(level), h_(voxel_size) {}

  const ClosestQuery& query() const { return query_; }
  double level() const { return level_; }
  double distance() const { return std::abs(level_); }
  double voxel_size() const { return h_; }

  /// Whether an unsigned distance is that of the surface. Vertices are put as near to it, if rounding lets them.
  bool is_reached(double distance) const {
    return std::abs(distance - this->distance()) <= kTolerance * this->distance();
  }
  /// Whether x, which has the surface's unsigned distance, has the sign, too. Only a voxel that may hold some of the
  /// source has both signs in it.
  bool is_on_side(const Vec3d& x) const {
    constexpr double kVoxelDiagonals = 2 * 1.7321;
    if (!inside_.has_inside() || kVoxelDiagonals * h_ < distance()) return true;
    return inside_(x) == (level_ < 0);
  }

  /// phi - level.
  double operator()(const Vec3d& x, std::uint32_t& hint) const {
    const Closest closest = query_(x, hint);
    hint = closest.triangle;
    return (inside_(x) ? -closest.distance : closest.distance) - level_;
  }

  /// From x along the gradient of phi, as long as that stays where `is_near` holds. Inward, phi is straight along the
  /// way and one step is exact; outward it may rise less than hoped for, and not at all at the medial axis.
  template <class IsNear>
  std::optional<Vec3d> follow(Vec3d x, std::uint32_t& hint, IsNear&& is_near) const {
    constexpr int kMostSteps = 20;
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

  /// Where phi = level between two points with phi on either side of it.
  Vec3d between(Vec3d below, Vec3d above, std::uint32_t& hint) const {
    constexpr int kMostSteps = 60;
    for (int step = 0; step < kMostSteps; ++step) {
      const Vec3d middle = (below + above) / 2.0;
      const double value = (*this)(middle, hint);
      if (std::abs(value) <= kTolerance * distance()) return middle;
      (value < 0 ? below : above) = middle;
    }
    return (below + above) / 2.0;
  }

 private:
  static constexpr double kTolerance = 1e-9;

  const ClosestQuery& query_;
  const Inside& inside_;
  double level_, h_;
};

}  // namespace vdb_offset
