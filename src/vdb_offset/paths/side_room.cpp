#include "vdb_offset/paths/side_room.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/surface/start_direction.h"

namespace vdb_offset {
namespace {

// Vertices that are asked.
constexpr std::size_t kSamples = 2000;
// What is straight above a vertex has that much of the distance which the faces around it alone would give it.
constexpr double kHasRoom = 0.98, kLeastSlopeSeen = 0.2;

template <class Query>
SideRoom look(const Query& front, const Distances& distances) {
  const auto& surface = front.surface();
  const std::size_t count = surface.vertices.size(), step = std::max<std::size_t>(1, count / kSamples);
  std::size_t asked = 0, here = 0, there = 0;
  for (std::size_t i = 0; i < count; i += step) {
    const auto v = static_cast<std::uint32_t>(i);
    const StartDirection start = start_of(surface, v);
    const double distance = distances[v];
    if (distance == 0 || surface.triangles_around(v).empty() || !(start.slope > kLeastSlopeSeen)) continue;
    const auto has_room = [&](double way) {
      const Vec3d x = surface.vertices[v] + start.direction * way;
      return front(x, surface.triangles_around(v).front()).distance >= kHasRoom * start.slope * std::abs(way);
    };
    ++asked;
    here += has_room(distance);
    there += has_room(-distance);
  }
  if (asked == 0) return {};
  const auto share = [&](std::size_t some) { return static_cast<double>(some) / static_cast<double>(asked); };
  return {true, share(here), share(there)};
}

}  // namespace

SideRoom room_on_sides(const ClosestQuery& front, const Distances& distances) { return look(front, distances); }
SideRoom room_on_sides(const CurveQuery& front, const Distances& distances) { return look(front, distances); }

bool falls_short(std::span<const VertexState> states) {
  constexpr double kFew = 0.02;
  const auto used =
                 std::count_if(states.begin(), states.end(), [](auto state) { return state != VertexState::Unused; }),
             reached = std::count(states.begin(), states.end(), VertexState::Reached);
  return static_cast<double>(used - reached) > kFew * static_cast<double>(used);
}

bool SideRoom::suggests_other() const { return known && here < 0.9 && there > here + 0.2; }

}  // namespace vdb_offset
