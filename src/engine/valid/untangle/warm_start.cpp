// SPDX-License-Identifier: Apache-2.0
#include "valid/untangle/warm_start.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ground/system/assert.h"
#include "motion/paths/propagate.h"
#include "space/query/cut_at_distance.h"

namespace vdb_offset {
namespace {

// A warm start is no more than so many times as far: a farther offset meets other parts. Reasoned.
constexpr double kFarthestStart = 4;

bool may_start_from(const Distances& near, const Distances& far) {
  if (!(far.scale() <= kFarthestStart * near.scale())) return false;
  const std::size_t count = std::max<std::size_t>({1, near.count(), far.count()});
  for (std::size_t v = 0; v < count; ++v)
    if (near[v] * far[v] < 0 || std::abs(near[v]) > std::abs(far[v])) return false;
  return true;
}

}  // namespace

std::vector<std::size_t> find_warm_starts(std::span<const Distances> distances) {
  std::vector<std::size_t> order(distances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> start_of = order;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a].scale() > distances[b].scale(); });
  std::vector<std::size_t> starts;
  for (const auto i : order) {
    const auto start = std::find_if(starts.begin(), starts.end(),
                                    [&](std::size_t s) { return may_start_from(distances[i], distances[s]); });
    if (start != starts.end()) start_of[i] = *start;
    else starts.push_back(i);
  }
  return start_of;
}

/// Cuts the displacement between the point where it is as long as the distance, so that it is no farther away, and its
/// end. The triangles around the vertex, then around the last answer, are asked first, as they are no nearer than the
/// closest: mostly all that is left to ask is whether they are the closest there. Where that finds no position, the
/// straight line from the closest point to the end serves: along it the distance is its length.
Vec3d displacement_to_distance(const ConstrainedSurface& constrained, std::uint32_t vertex, const Vec3d& displacement,
                               double distance) {
  // Share of the distance that the answer may be off by. Reasoned: far below the promised 1e-6.
  constexpr double kSettled = 1e-9;
  VDB_OFFSET_ASSERT(distance > 0);
  const Vec3d& start = constrained.surface.vertices[vertex];
  std::uint32_t hint = constrained.hint(vertex);
  const auto beside = [&](const Vec3d& x) {
    const TrianglePoint nearest = constrained.moving_part.near(x, hint);
    return sample_at(x, hint, nearest);
  };
  const auto exactly = [&](const Vec3d& x) {
    const Closest closest = constrained.moving_part(x, hint);
    hint = closest.triangle;
    return sample_at(x, closest);
  };
  const auto settled = [&](const Sample& at) { return std::abs(at.phi - distance) <= kSettled * distance; };
  const auto cut = [&](const Sample& near, const Sample& far, const auto& measure) {
    return cut_at_distance(constrained.moving_part.surface(), near, far, distance, measure, settled);
  };
  const Sample first = beside(start + displacement * std::min(1.0, distance / displacement.length())),
               last = beside(start + displacement);
  if (!(last.phi > distance)) return displacement;
  Sample at = exactly(first.phi < distance ? cut(first, last, beside).x : first.x);
  if (!settled(at)) {
    const Sample end = exactly(start + displacement);
    if (!(end.phi > distance)) return displacement;
    at = cut(at, end, exactly);
    if (!settled(at) && !constrained.moving_part.surface().is_held(constrained.part_vertex_of(vertex)))
      return round_displacement(end.x - end.away * (1 - distance / end.phi) - start, distance);
  }
  return round_displacement(at.x - start, distance);
}

}  // namespace vdb_offset
