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

/// Above 0 if the prism is the union of prisms over triangles, on the ways between its corners, in which all edges
/// upwards lean towards the normals below and above: then it is inside out nowhere. It is the least triple product of
/// unit edge vectors over the corners that turn outwards in the base and in the top; where there is none, or one is not
/// above 0, as over bent polygons, the least lean in the best split (a sine). If there is no such split, it is what the
/// best one has, or a corner, which is 0 or below. Cost: O(corners^3) for few, else O(corners^2).
double scaled_jacobian(const PolygonPrism& prism);

}  // namespace vdb_offset
