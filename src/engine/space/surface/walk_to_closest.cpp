// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "ground/system/assert.h"
#include "space/surface/surface.h"

// From a point p on an edge or a corner, a triangle leads nearer to x only if one of its corners w does:
// (w - p) . (x - p) > 0. Inside an edge x - p is at right angles to it, and the corner across decides.
namespace vdb_offset {
namespace {

/// Of the triangles around a vertex, the one whose corner leads nearest to x, by lead(corner); `from` if no other leads
/// nearer at all.
template <class Lead>
inline std::uint32_t leading_around(const Surface& surface, std::uint32_t centre, std::uint32_t from, Lead&& lead) {
  std::uint32_t first = from;
  double most = 0;
  for (const auto other : surface.triangles_around(centre)) {
    if (other == from) continue;
    const auto& t = surface.triangles[other];
    const std::size_t corner = t[0] == centre ? 0 : t[1] == centre ? 1 : 2;
    const double leads = std::max(lead(t[(corner + 1) % 3]), lead(t[(corner + 2) % 3]));
    if (leads > most) {
      most = leads;
      first = other;
    }
  }
  return first;
}

}  // namespace

TrianglePoint Surface::walk_to_closest(const Vec3d& x, std::uint32_t& triangle) const {
  VDB_OFFSET_ASSERT(triangle < triangles.size());
  TrianglePoint best = closest_on(triangle, x);
  const auto is_nearer = [&](std::uint32_t other) {
    const TrianglePoint candidate = closest_on(other, x);
    if (candidate.squared_distance >= best.squared_distance) return false;
    best = candidate;
    triangle = other;
    return true;
  };
  for (bool moved = true; moved && best.feature != Feature::Face;) {
    moved = false;
    const std::uint32_t from = triangle;
    const auto feature = static_cast<std::uint32_t>(best.feature);
    const Vec3d p = best.point, towards = x - p;
    const auto lead = [&](std::uint32_t v) { return towards.dot(vertices[v] - p); };
    if (feature < 3) {
      // The one that leads nearest first: it is likely to be the only one to look at.
      const std::uint32_t centre = triangles[from][feature];
      const std::uint32_t first = leading_around(*this, centre, from, lead);
      if (first == from) break;
      moved = is_nearer(first);
      const auto around = triangles_around(centre);
      for (std::size_t i = 0; !moved && i < around.size(); ++i)
        moved = around[i] != from && around[i] != first && is_nearer(around[i]);
    } else {
      const std::uint32_t edge = 3 * from + (feature - 3);
      for (std::uint32_t e = next_around_edge[edge]; e != edge && !moved; e = next_around_edge[e])
        moved = lead(triangles[e / 3][(e + 2) % 3]) > 0 && is_nearer(e / 3);
    }
  }
  return best;
}

}  // namespace vdb_offset
