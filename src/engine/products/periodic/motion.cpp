// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "vdb_offset/periodic.h"

namespace vdb_offset {

Vec3d PeriodicMotion::turned(const Vec3d& way) const {
  if (angle == 0) return way;
  Vec3d unit = axis;
  unit.normalize(0.0);
  const double radians = angle * std::numbers::pi / 180, c = std::cos(radians), s = std::sin(radians);
  // Rodrigues' formula.
  return way * c + unit.cross(way) * s + unit * (unit.dot(way) * (1 - c));
}

Vec3d PeriodicMotion::operator()(const Vec3d& x) const { return angle == 0 ? x + shift : point + turned(x - point); }

PeriodicMotion PeriodicMotion::times(double count) const { return {axis, point, angle * count, shift * count}; }

}  // namespace vdb_offset
