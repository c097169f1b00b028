#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "vdb_offset/indices.h"
#include "vdb_offset/layer_rail.h"
#include "vdb_offset/near_triangles.h"
#include "vdb_offset/surface.h"
#include "vdb_offset/vertex_fan.h"

namespace vdb_offset {

// Distances that differ by less are the same.
inline constexpr double kSameDistance = 1e-9;

/// A ball that holds nothing of the front.
struct EmptyBall {
  Vec3d centre;
  double radius;

  /// Around `vertex`, the radius that all lies within which is nearer to x than `distance`: it is in the ball around x,
  /// and outside of this one. Nothing of that is farther than where both their surfaces meet from the pole of the ball
  /// around x, on the way from the centre through x.
  double radius_beside(const Vec3d& vertex, const Vec3d& x, double distance) const {
    const Vec3d away = x - centre;
    const double way = away.length(), beyond = way + distance - radius * (1 - kSameDistance);
    if (!(beyond > 0)) return 0;
    if (!(way > 0)) return std::numeric_limits<double>::infinity();
    const double rim = std::sqrt(distance / way * beyond * (way + distance + radius));
    return rim + (x + away * (distance / way) - vertex).length();
  }
};

/// As CareField, where the closest triangle is one of those around the vertex.
class FanField {
 public:
  explicit FanField(VertexFan& fan) : fan_(fan) {}

  Phi at(const Vec3d& x) const { return phi_of(fan_.away_from(x)); }
  Phi find(const Vec3d& x) const { return phi_of(fan_.find_away_from(x)); }

 private:
  VertexFan& fan_;
};

/// The same, where it is one of those, or of a few others.
class FewField {
 public:
  FewField(const Surface& front, VertexFan& fan, NearTriangles& others) : front_(front), fan_(fan), others_(others) {
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
