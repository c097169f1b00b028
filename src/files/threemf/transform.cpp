// SPDX-License-Identifier: Apache-2.0
#include "threemf/transform.h"

#include <cmath>

namespace vdb_offset::io {

bool ThreeMfTransform::is_regular() const {
  for (const Vec3d& r : row)
    if (!r.isFinite()) return false;
  const double size = row[0].length() * row[1].length() * row[2].length();
  constexpr double kSingular = 1e-12;  // of the volume that the rows would span at right angles: far below any use
  return std::isnormal(size) && std::abs(determinant()) > kSingular * size;
}

ThreeMfTransform ThreeMfTransform::then(const ThreeMfTransform& next) const {
  if (next.is_identity()) return *this;
  return {{next.linear(row[0]), next.linear(row[1]), next.linear(row[2]), next(row[3])}};
}

Vec3d ThreeMfTransform::source_of(const Vec3d& p) const {
  if (is_identity()) return p;
  // Cramer's rule; what rounding leaves of it is taken off by two steps of Newton's.
  const double volume = determinant();
  const std::array<Vec3d, 3> inverse{row[1].cross(row[2]) / volume, row[2].cross(row[0]) / volume,
                                     row[0].cross(row[1]) / volume};
  const auto back = [&](const Vec3d& d) { return Vec3d(d.dot(inverse[0]), d.dot(inverse[1]), d.dot(inverse[2])); };
  Vec3d source = back(p - row[3]);
  for (int step = 0; step < 2; ++step) source += back(p - (*this)(source));
  return source;
}

}  // namespace vdb_offset::io
