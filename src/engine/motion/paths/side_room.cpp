// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/side_room.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ground/system/parallel.h"
#include "space/surface/start_direction.h"

namespace vdb_offset {
namespace {

// Vertices that are measured. Reasoned: shares are known to about 2 %.
constexpr std::size_t kSamples = 2000;
// There is room if the position straight above a vertex has this share of the distance that the faces around the vertex
// alone would give it; vertices are left out whose start direction has a smaller cosine with the normal of a face. Not
// measured.
constexpr double kHasRoom = 0.98, kLeastSlopeSeen = 0.2;

// How often the distance is halved, to look on the way as well: beyond a wall that is nearer there is room again. A
// wall at a height w is seen from w / 2 up to w / (1 - kHasRoom * slope), 1.2 w at least.
constexpr int kRoomHalvings = 10;

// The other side is suggested if less than this share of the vertices has room on the side asked for, and more on the
// other by at least that share. Not measured.
constexpr double kRoomEnough = 0.9, kMoreRoom = 0.2;

template <class Query>
SideRoom measure(const Query& query, const Distances& distances) {
  const auto& surface = query.surface();
  const std::size_t count = surface.vertices.size(), step = std::max<std::size_t>(1, count / kSamples);
  enum : std::uint8_t { kAsked = 1, kHere = 2, kThere = 4 };
  std::vector<std::uint8_t> found((count + step - 1) / step, 0);
  const auto look = [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i * step);
    const StartDirection start = start_of(surface, v);
    const double distance = distances[v];
    if (distance == 0 || surface.triangles_around(v).empty() || !(start.slope > kLeastSlopeSeen)) return;
    const auto has_room = [&](double distance_there) {
      double length = distance_there;
      for (int k = 0; k <= kRoomHalvings; ++k, length /= 2) {
        const Vec3d x = surface.vertices[v] + start.direction * length;
        if (!(query(x, surface.triangles_around(v).front()).distance >= kHasRoom * start.slope * std::abs(length)))
          return false;
      }
      return true;
    };
    found[i] =
        static_cast<std::uint8_t>(kAsked + (has_room(distance) ? kHere : 0) + (has_room(-distance) ? kThere : 0));
  };
  for_each_index(found.size(), look, 16);
  const auto count_of = [&](std::uint8_t what) {
    return std::count_if(found.begin(), found.end(), [&](std::uint8_t each) { return (each & what) != 0; });
  };
  const auto asked = count_of(kAsked);
  if (asked == 0) return {};
  const auto share = [&](std::uint8_t what) {
    return static_cast<double>(count_of(what)) / static_cast<double>(asked);
  };
  return {true, share(kHere), share(kThere)};
}

}  // namespace

SideRoom room_on_sides(const ClosestQuery& query, const Distances& distances) { return measure(query, distances); }
SideRoom room_on_sides(const CurveQuery& query, const Distances& distances) { return measure(query, distances); }

bool falls_short(std::span<const VertexState> states) {
  constexpr double kFew = 0.02;  // share of the vertices; not measured
  const auto used =
                 std::count_if(states.begin(), states.end(), [](auto state) { return state != VertexState::Unused; }),
             in_want = std::count_if(states.begin(), states.end(), [](auto state) { return falls_short(state); });
  return static_cast<double>(in_want) > kFew * static_cast<double>(used);
}

bool SideRoom::suggests_other() const { return known && here < kRoomEnough && there > here + kMoreRoom; }

}  // namespace vdb_offset
