#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "vdb_offset/layers/rails.h"
#include "vdb_offset/query/near_triangles.h"
#include "vdb_offset/query/vertex_fan.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

// Distances that differ by less are the same.
inline constexpr double kSameDistance = 1e-9;

/// Around the end of a vertex's path lies a ball that holds nothing of the front. What is nearer to a place x than some
/// distance is in the ball around x, and outside of that one: nothing of it is farther than where both their surfaces
/// meet from the pole of the ball around x, on the way from the end through x. Around the vertex, all of that lies
/// within a radius.
class SpaceBesideBall {
 public:
  SpaceBesideBall(const Vec3d& vertex, const Vec3d& end, double radius) : vertex_(vertex), end_(end), radius_(radius) {}

  /// False if the radius is now beyond `most`.
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
  double rim_ = 0, pole_ = 0;  // how far rims are from their poles, and these from the vertex, squared
};

/// As QueryDistance, where the closest triangle is one of those around the vertex.
class FanDistance {
 public:
  explicit FanDistance(VertexFan& fan) : fan_(fan) {}

  Phi at(const Vec3d& x) const { return phi_of(fan_.away_from(x)); }
  Phi find(const Vec3d& x) const { return phi_of(fan_.find_away_from(x)); }

 private:
  VertexFan& fan_;
};

/// The same, where it is one of those, or of a few others.
class NearDistance {
 public:
  NearDistance(const Surface& front, VertexFan& fan, NearTriangles& others)
      : front_(front), fan_(fan), others_(others) {
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
  Phi of_other(std::uint32_t i, const Vec3d& x) const { return phi_of(front_.closest_on(others_.triangle(i), x), x); }

  const Surface& front_;
  VertexFan& fan_;
  NearTriangles& others_;
  std::uint32_t believed_ = kNone;  // of the others
};

}  // namespace vdb_offset
