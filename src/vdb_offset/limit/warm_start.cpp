#include "vdb_offset/limit/warm_start.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/query/cut_at_distance.h"

namespace vdb_offset {
namespace {

// What goes farther than so many times a distance has other things in its way.
constexpr double kFarthestFollowed = 4;

bool may_follow(const Distances& near, const Distances& far) {
  if (!(far.scale() <= kFarthestFollowed * near.scale())) return false;
  const std::size_t count = std::max<std::size_t>({1, near.count(), far.count()});
  for (std::size_t v = 0; v < count; ++v)
    if (near[v] * far[v] < 0 || std::abs(near[v]) > std::abs(far[v])) return false;
  return true;
}

}  // namespace

std::vector<std::size_t> find_precedents(std::span<const Distances> distances) {
  std::vector<std::size_t> order(distances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> followed = order;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a].scale() > distances[b].scale(); });
  std::vector<std::size_t> leaders;
  for (const auto i : order) {
    const auto leader = std::find_if(leaders.begin(), leaders.end(),
                                     [&](std::size_t l) { return may_follow(distances[i], distances[l]); });
    if (leader != leaders.end()) followed[i] = *leader;
    else leaders.push_back(i);
  }
  return followed;
}

/// From where the way is as long as the distance, so that it is no farther, to its end. The triangles around the
/// vertex, then around the last answer, are asked first, as they are no nearer than the closest: mostly all that is
/// left to ask is whether they are the closest there. Where that does not settle, the straight line from the closest
/// point to the end of the way is as good: along it the distance is its length.
Vec3d way_to_distance(const ConstrainedSurface& constrained, std::uint32_t vertex, const Vec3d& way, double distance) {
  constexpr double kSettled = 1e-9;
  const Vec3d& start = constrained.surface.vertices[vertex];
  std::uint32_t hint = constrained.hint(vertex);
  const auto beside = [&](const Vec3d& x) {
    const TrianglePoint nearest = constrained.front.near(x, hint);
    return sample_at(x, hint, nearest);
  };
  const auto exactly = [&](const Vec3d& x) {
    const Closest closest = constrained.front(x, hint);
    hint = closest.triangle;
    return sample_at(x, closest);
  };
  const auto settled = [&](const Sample& at) { return std::abs(at.phi - distance) <= kSettled * distance; };
  const auto cut = [&](const Sample& near, const Sample& far, const auto& measure) {
    return cut_at_distance(constrained.front.surface(), near, far, distance, measure, settled);
  };
  const Sample first = beside(start + way * std::min(1.0, distance / way.length())), last = beside(start + way);
  if (!(last.phi > distance)) return way;
  Sample at = exactly(first.phi < distance ? cut(first, last, beside).x : first.x);
  if (!settled(at)) {
    const Sample end = exactly(start + way);
    if (!(end.phi > distance)) return way;
    at = cut(at, end, exactly);
    const Surface& front = constrained.front.surface();
    const std::uint32_t on_front = constrained.front_vertex.empty() ? vertex : constrained.front_vertex[vertex];
    if (!settled(at) && !front.is_held(on_front))
      return round_way(end.x - end.away * (1 - distance / end.phi) - start, distance);
  }
  return round_way(at.x - start, distance);
}

}  // namespace vdb_offset
