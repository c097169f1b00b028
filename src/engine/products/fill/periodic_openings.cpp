// SPDX-License-Identifier: Apache-2.0
// Covers the openings of two periodic patches alike: where the edges of both have been parted in the same way, the
// first one's cover is copied to the second.
#include <fmt/format.h>

#include <set>

#include "ground/mesh/match_points.h"
#include "products/fill/openings.h"
#include "products/volume/periodic_patches.h"

namespace vdb_offset {

std::map<std::uint32_t, std::uint32_t> periodic_images(const VolumeMesh& volume, const OpenPlane& first,
                                                       const OpenPlane& second) {
  const auto points_at = [](const OpenPlane& plane) {
    std::set<std::uint32_t> points;
    for (const auto& [a, b] : plane.edges) points.insert({a, b});
    return std::vector<std::uint32_t>(points.begin(), points.end());
  };
  const std::vector<std::uint32_t> from = points_at(first), to = points_at(second);
  std::vector<Vec3d> moved, there;
  for (const std::uint32_t p : from) moved.push_back((*volume.motion)(volume.points[p]));
  for (const std::uint32_t p : to) there.push_back(volume.points[p]);
  const std::vector<std::uint32_t> match = match_points(moved, there, periodic_tolerance(volume));
  std::map<std::uint32_t, std::uint32_t> image;
  for (std::size_t i = 0; i < from.size(); ++i)
    if (match[i] != kNone) image[from[i]] = to[match[i]];
  return image;
}

void cover_as(const OpenPlane& first, const OpenPlane& second, FillFront& front, VolumeMesh& volume) {
  std::map<std::uint32_t, std::uint32_t> image = periodic_images(volume, first, second);
  for (const auto& edge : first.edges)
    for (const std::uint32_t p : edge) {
      if (image.contains(p)) continue;
      const Vec3d& place = volume.points[p];
      throw FillFailed(
          fmt::format("fill: expected periodic openings with edges that are the same, got others at ({:.6g}, {:.6g}, "
                      "{:.6g})",
                      place[0], place[1], place[2]));
    }
  const auto image_of = [&](std::uint32_t p) {
    const auto [found, is_new] = image.try_emplace(p, static_cast<std::uint32_t>(volume.points.size()));
    if (is_new) volume.points.push_back((*volume.motion)(volume.points[p]));
    return found->second;
  };
  for (std::size_t t = 0, count = front.triangles.size(); t < count; ++t) {
    const FrontTriangle triangle = front.triangles[t];
    if (triangle.patch != first.patch) continue;
    const auto& [a, b, c] = triangle.corners;
    front.triangles.push_back({{image_of(a), image_of(c), image_of(b)}, kNone, second.patch});
  }
}

}  // namespace vdb_offset
