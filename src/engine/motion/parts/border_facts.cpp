// SPDX-License-Identifier: Apache-2.0
#include "motion/parts/border_facts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ground/system/assert.h"

namespace vdb_offset {

BorderFacts border_facts(const Surface& surface, std::span<const Vec3d> displacement,
                         std::span<const std::uint8_t> excepted) {
  // Angle, in degrees, by which a vertex that stays near the plane across its border has not left it. Not measured.
  constexpr double kStrayed = 1;
  VDB_OFFSET_ASSERT(displacement.size() == surface.vertices.size());
  VDB_OFFSET_ASSERT(excepted.empty() || excepted.size() == surface.vertices.size());
  BorderFacts facts;
  for (const auto& [normal, offset] : surface.planes)
    facts.planes.push_back({normal, offset + normal.dot(surface.origin)});
  facts.named_planes = surface.named_planes;
  for (const auto& [plane, vertices] : surface.left_planes) {
    BorderFacts::LeftPlane left{{plane.normal, plane.offset + plane.normal.dot(surface.origin)}, 0};
    for (const auto v : vertices)
      if (excepted.empty() || !excepted[v])
        left.farthest = std::max(left.farthest, std::abs(plane.normal.dot(displacement[v])));
    const auto is_same = [&](const auto& other) {
      return other.normal == left.plane.normal && std::abs(other.offset - left.plane.offset) < left.farthest;
    };
    const auto known =
        std::find_if(facts.left.begin(), facts.left.end(), [&](const auto& l) { return is_same(l.plane); });
    if (left.farthest == 0 || std::any_of(facts.planes.begin(), facts.planes.end(), is_same)) continue;
    if (known == facts.left.end()) facts.left.push_back(left);
    else known->farthest = std::max(known->farthest, left.farthest);
  }
  for (std::uint32_t v = 0; v < surface.conormals.size(); ++v) {
    facts.beyond += is_beyond_wall(surface, v, surface.vertices[v] + displacement[v], 0);
    if (surface.is_held(v)) {
      ++facts.held_vertices;
      continue;
    }
    const double over = std::abs(surface.conormals[v].dot(displacement[v])), length = displacement[v].length();
    if (surface.conormals[v].lengthSqr() == 0 || length == 0 || (!excepted.empty() && excepted[v])) continue;
    const double angle = std::asin(std::min(1.0, over / length)) * 180 / std::numbers::pi;
    ++facts.across_vertices;
    facts.strayed_vertices += angle > kStrayed;
    facts.worst_angle = std::max(facts.worst_angle, angle);
  }
  return facts;
}

}  // namespace vdb_offset
