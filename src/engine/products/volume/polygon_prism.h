// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The triple product of unit vectors along a, b and c; 0 if one of them has no length.
inline double unit_triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double lengths = a.length() * b.length() * c.length();
  return lengths > 0 ? a.cross(b).dot(c) / lengths : 0;
}

/// A prism over a polygon that need be neither flat nor convex. Corner k of its base lies under corner k of its top, or
/// is the same point, where it is flat. Both run ccw seen from above.
struct PolygonPrism {
  std::vector<Vec3d> below, above;
  std::vector<std::uint8_t> flat;

  std::size_t size() const { return below.size(); }
};

/// The scaled Jacobian of a prism over a polygon: above 0 if some split of the polygon into triangles, along diagonals,
/// makes it the union of prisms in which all edges upwards lean towards the normals below and above. Then it is inside
/// out nowhere, and the value is the least triple product of unit edge vectors over the corners that turn outwards in
/// the base and in the top; or, where no corner does, or a product is not above 0, as over bent polygons, the least
/// lean in the best split (a sine). If no split is such, it is the least of the best split's lean and of the corners,
/// which is 0 or below. Cost: O(corners^3) for few corners, else O(corners^2).
double scaled_jacobian(const PolygonPrism& prism);

}  // namespace vdb_offset
