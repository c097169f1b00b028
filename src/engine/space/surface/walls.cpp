// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "space/surface/border_planes.h"
#include "space/surface/surface.h"

namespace vdb_offset {
namespace {

/// The vertices that a plane holds, and those that lie in it farther along the border.
Indices along_border_in(const Surface& surface, const SymmetryPlane& plane, const Indices& held, double tolerance,
                        IndexGatherer& gathered) {
  const auto is_on = [&](std::uint32_t v) { return std::abs(plane.height(surface.vertices[v])) <= tolerance; };
  for (const auto v : held) gathered.add(v);
  for (std::size_t i = 0; i < gathered.so_far().size(); ++i)
    for (const auto t : surface.triangles_around(gathered.so_far()[i]))
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        const std::array ends = {surface.from(edge), surface.to(edge)};
        if (surface.next_around_edge[edge] != edge || !is_on(ends[0]) || !is_on(ends[1])) continue;
        for (const auto v : ends) gathered.add(v);
      }
  return gathered.take();
}

/// Vertices, and those that are connected with them over others for which admits(v).
template <class Admits>
Indices connected(const Surface& surface, const Indices& with, Admits&& admits, IndexGatherer& gathered) {
  for (const auto v : with) gathered.add(v);
  for (std::size_t i = 0; i < gathered.so_far().size(); ++i)
    for (const auto t : surface.triangles_around(gathered.so_far()[i]))
      for (const auto v : surface.triangles[t])
        if (admits(v)) gathered.add(v);
  return gathered.take();
}

}  // namespace

void raise_walls(Surface& surface, std::span<const Indices> held, double reach, double tolerance) {
  const double slack = 2 * tolerance;
  IndexGatherer gathered(surface.vertices.size());
  for (std::size_t number = 0; number < held.size(); ++number) {
    const SymmetryPlane& plane = surface.planes[number];
    const double far = number < surface.named_planes ? std::numeric_limits<double>::infinity() : reach;
    if (held[number].empty() || !(far > 0)) continue;
    const Indices in_plane = along_border_in(surface, plane, held[number], tolerance, gathered);
    const auto height = [&](std::uint32_t v) { return plane.height(surface.vertices[v]); };
    const auto is_near = [&](std::uint32_t v) { return std::abs(height(v)) <= far; };
    const Indices near = connected(surface, in_plane, is_near, gathered);
    const bool below = std::all_of(near.begin(), near.end(), [&](std::uint32_t v) { return height(v) <= slack; });
    if (!below && std::any_of(near.begin(), near.end(), [&](std::uint32_t v) { return height(v) < -slack; })) continue;
    const SymmetryPlane wall = below ? plane : SymmetryPlane{-plane.normal, -plane.offset};
    const auto is_beside = [&](std::uint32_t v) {
      return is_near(v) && (std::abs(height(v)) > tolerance || std::binary_search(in_plane.begin(), in_plane.end(), v));
    };
    for (const auto v : connected(surface, in_plane, is_beside, gathered)) surface.walls.push_back({v, wall, slack});
  }
  std::stable_sort(surface.walls.begin(), surface.walls.end(),
                   [](const Wall& a, const Wall& b) { return a.vertex < b.vertex; });
}

bool is_beyond_wall(const Surface& surface, std::uint32_t vertex, const Vec3d& x, double slack) {
  if (surface.walls.empty()) return false;
  const auto [first, last] = std::equal_range(surface.walls.begin(), surface.walls.end(), Wall{vertex, {}, 0},
                                              [](const Wall& a, const Wall& b) { return a.vertex < b.vertex; });
  return std::any_of(first, last, [&](const Wall& wall) { return wall.plane.height(x) > wall.slack + slack; });
}

}  // namespace vdb_offset
