// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "products/layers/rails.h"
#include "space/query/near_triangles.h"
#include "space/query/vertex_fan.h"
#include "space/surface/surface.h"

namespace vdb_offset {

// Distances that differ by less than this share are taken as equal: far below the promised 1e-6, far above rounding.
inline constexpr double kSameDistance = 1e-9;

/// Bounds where the moving part can be nearer to some points than their known distances. Around the end of a vertex's
/// path lies a ball that holds nothing of the part. Whatever is nearer to a point x than its distance lies in the ball
/// around x, and outside of the empty one: no farther from the pole of the ball around x, in the direction from the
/// path's end through x, than the circle in which both balls' surfaces meet. All of that lies within radius() of the
/// vertex.
class SpaceBesideBall {
 public:
  SpaceBesideBall(const Vec3d& vertex, const Vec3d& end, double radius) : vertex_(vertex), end_(end), radius_(radius) {}

  /// Adds a point with its distance. Returns false if the radius is beyond `most` now, or cannot be found.
  bool add(const Vec3d& x, double distance, double most) {
    const Vec3d away = x - end_;
    const double way = away.length(), beyond = way + distance - radius_ * (1 - kSameDistance);
    if (!(beyond > 0)) return true;
    if (!(way > 0)) return false;
    const double scale = distance / way;
    rim_ = std::max(rim_, scale * beyond * (way + distance + radius_));
    pole_ = std::max(pole_, (x + away * scale - vertex_).lengthSqr());
    return std::max(rim_, pole_) <= most * most;
  }
  double radius() const { return std::sqrt(rim_) + std::sqrt(pole_); }

 private:
  Vec3d vertex_, end_;
  double radius_;
  double rim_ = 0, pole_ = 0;  // largest squared distances: of circles from their poles, and of poles from the vertex
};

/// Distances along a vertex's rail (see QueryDistance) where the closest triangle is one of the vertex's fan.
class FanDistance {
 public:
  explicit FanDistance(VertexFan& fan) : fan_(fan) {}

  Phi at(const Vec3d& x) const { return phi_of(fan_.away_from(x)); }
  Phi find(const Vec3d& x) const { return phi_of(fan_.find_away_from(x)); }

 private:
  VertexFan& fan_;
};

/// Distances along a vertex's rail (see QueryDistance) where the closest triangle is one of the vertex's fan, or of a
/// few near triangles that are not in it.
class NearDistance {
 public:
  NearDistance(const Surface& surface, VertexFan& fan, NearTriangles& others)
      : surface_(surface), fan_(fan), others_(others) {
    if (others.size() > 0) believed_ = static_cast<std::uint32_t>(others.foremost());
  }

  Phi at(const Vec3d& x) const { return believed_ == kNone ? phi_of(fan_.away_from(x)) : of_other(believed_, x); }
  Phi find(const Vec3d& x) {
    Phi nearest = phi_of(fan_.find_away_from(x));
    const std::uint32_t believed = believed_;
    believed_ = kNone;
    const auto look = [&](std::uint32_t i) {
      const Phi other = of_other(i, x);
      others_.hold_back(i, x, other.away, other.value);
      if (!(other.value < nearest.value)) return;
      nearest = other;
      believed_ = i;
    };
    if (believed != kNone) look(believed);
    others_.visit_nearer(x, nearest.value, [&](std::size_t i) {
      if (i != believed) look(static_cast<std::uint32_t>(i));
      return nearest.value;
    });
    return nearest;
  }

 private:
  Phi of_other(std::uint32_t i, const Vec3d& x) const { return phi_of(surface_.closest_on(others_.triangle(i), x), x); }

  const Surface& surface_;
  VertexFan& fan_;
  NearTriangles& others_;
  std::uint32_t believed_ = kNone;  // the one of the others that was closest last; kNone: one of the fan
};

}  // namespace vdb_offset
