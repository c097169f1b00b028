#include "vdb_offset/precedent.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_offset/false_position.h"
#include "vdb_offset/propagate.h"

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

/// Illinois' false position, from where the way is as long as the distance, so that it is no farther, to its end. The
/// triangles around the vertex, then around the last answer, are asked first, as they are no nearer than the closest:
/// mostly all that is left to ask is whether they are the closest there. Where that does not settle, the straight line
/// from the closest point to the end of the way is as good: along it the distance is its length.
Vec3d way_to_distance(const Body& body, std::uint32_t vertex, const Vec3d& way, double distance) {
  constexpr int kMostSteps = 60;
  constexpr double kSettled = 1e-9;
  const Vec3d& start = body.surface.vertices[vertex];
  std::uint32_t hint = body.hint(vertex);
  const auto off_beside = [&](double share) {
    return std::sqrt(body.front.near(start + way * share, hint).squared_distance) - distance;
  };
  const auto look = [&](double share) {
    const Closest closest = body.front(start + way * share, hint);
    hint = closest.triangle;
    return closest;
  };
  const auto settled = [&](double by) { return std::abs(by) <= kSettled * distance; };
  double share = std::min(1.0, distance / way.length());
  const double off_near = off_beside(share), off_end = off_beside(1);
  if (!(off_end > 0)) return way;
  if (off_near < 0 && !settled(off_near))
    share = false_position(share, off_near, 1, off_end, kMostSteps, off_beside, settled);
  double off = look(share).distance - distance;
  if (!settled(off)) {
    const Closest end = look(1);
    if (!(end.distance > distance)) return way;
    const auto off_at = [&](double at) { return off = look(at).distance - distance; };
    share = false_position(share, off, 1, end.distance - distance, kMostSteps, off_at, settled);
    if (!settled(off)) {
      const Vec3d to_end = start + way - end.point;
      return round_way(end.point + to_end * (distance / end.distance) - start, distance);
    }
  }
  return round_way(way * share, distance);
}

}  // namespace vdb_offset
