// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The angle between two directions, 0 .. pi; exact for small ones as well.
inline double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).length(), a.dot(b)); }

/// A direction on the great circle from one direction to another, by its share of the angle (Shoemake, Animating
/// rotation with quaternion curves, 1985). \pre both of unit length, not opposite
inline Vec3d slerp(const Vec3d& from, const Vec3d& to, double share) {
  const double angle = angle_between(from, to);
  if (angle < 1e-9) return share < 0.5 ? from : to;
  Vec3d between = (from * std::sin((1 - share) * angle) + to * std::sin(share * angle)) / std::sin(angle);
  between.normalize();
  return between;
}

}  // namespace vdb_offset
