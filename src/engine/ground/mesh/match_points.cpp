// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/match_points.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "ground/system/parallel.h"

namespace vdb_offset {

std::vector<std::uint32_t> match_points(std::span<const Vec3d> points, std::span<const Vec3d> others,
                                        double tolerance) {
  // A direction that borders of meshes hardly lie across, so that few of the others are at one place along it.
  const Vec3d along(0.5386, 0.6491, 0.5373);
  std::vector<std::pair<double, std::uint32_t>> places;
  places.reserve(others.size());
  for (std::uint32_t i = 0; i < others.size(); ++i) places.emplace_back(along.dot(others[i]), i);
  std::sort(places.begin(), places.end());
  std::vector<std::uint32_t> found(points.size(), kNone);
  for_each_index(points.size(), [&](std::size_t p) {
    const double place = along.dot(points[p]);
    double best = tolerance * tolerance;
    for (auto at = std::lower_bound(places.begin(), places.end(), std::pair(place - tolerance, std::uint32_t{0}));
         at != places.end() && at->first <= place + tolerance; ++at) {
      const double squared = (others[at->second] - points[p]).lengthSqr();
      if (squared > best || (squared == best && found[p] < at->second)) continue;
      best = squared;
      found[p] = at->second;
    }
  });
  return found;
}

}  // namespace vdb_offset
