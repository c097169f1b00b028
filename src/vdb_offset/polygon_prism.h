#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Of unit vectors along a, b and c; 0 if one of them has no length.
inline double unit_triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double lengths = a.length() * b.length() * c.length();
  return lengths > 0 ? a.cross(b).dot(c) / lengths : 0;
}

/// A prism over a polygon that need be neither flat nor convex: corner k of its base lies under corner k of its top, or
/// is that one, where it is flat. Both run ccw seen from above.
struct PolygonPrism {
  std::vector<Vec3d> below, above;
  std::vector<std::uint8_t> flat;

  std::size_t size() const { return below.size(); }
};

/// The least triple product of unit edge vectors over the corners that turn outwards in the base and in the top, as
/// there are in right prisms over convex polygons; if it is above 0, the prism is the union of prisms over triangles
/// with such products at all of their corners, so that it is inside out nowhere. If there is no such split, what the
/// best one has, which is 0 or below it. Where no corner turns outwards in both, how much the edges upwards
/// lean at least towards the normals of the best split's triangles (their sine). Cost: O(corners^3) for few, else
/// O(corners^2).
double scaled_jacobian(const PolygonPrism& prism);

}  // namespace vdb_offset
