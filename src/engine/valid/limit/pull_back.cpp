// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/pull_back.h"

#include <algorithm>
#include <limits>

namespace vdb_offset {
namespace {

// Share of its displacement that a vertex of a faulty face keeps in a round. Reasoned: larger steps lose more, smaller
// ones take more rounds.
constexpr double kKept = 0.8;

// Of a fault's corners the one with the least live area goes back, and those with no more than kAlikeAreas times that
// area; the others only once these keep no more than a share kSpent of their displacement. With this a notch of
// micrometres holds back itself, and no longer the plate around it.
constexpr double kAlikeAreas = 4, kSpent = 0.1;

}  // namespace

Indices vertices_to_pull(LimitState& state, std::uint32_t pinned) {
  IndexGatherer& gathered = state.gathered;
  const FaultFinder& faults = state.faults;
  const auto gather = [&](std::uint32_t v) { gathered.add(v); };
  const auto may_go_back = [&](std::uint32_t v) {
    return v != pinned && state.share[v] != 0 && state.constrained.vertex_on_part(v) && state.whole[v] != Vec3d(0.0);
  };
  faults.for_each_faulty_corner(gather);
  state.live_area.measure(gathered.take());
  faults.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
    double least = std::numeric_limits<double>::infinity();
    const auto for_each_corner = [&](auto&& visit) {
      for (const auto triangle : {s, t})
        for (const auto v : state.surface.triangles[triangle])
          if (may_go_back(v)) visit(v);
    };
    for_each_corner([&](std::uint32_t v) {
      if (state.share[v] > kSpent) least = std::min(least, state.live_area[v]);
    });
    for_each_corner([&](std::uint32_t v) {
      if (state.share[v] <= kSpent || state.live_area[v] <= kAlikeAreas * least) gather(v);
    });
  });
  for (const auto v : faults.misplaced()) gather(v);
  faults.for_each_faulty_corner(gather, [](std::uint32_t) { return true; });  // of a rim alone
  for (const auto v : state.faults.unmovable_folds()) gather(v);
  Indices pulled = gathered.take();
  std::erase_if(pulled, [&](std::uint32_t v) { return !may_go_back(v); });
  return pulled;
}

bool pull_back(LimitState& state) {
  const Indices vertices = vertices_to_pull(state);
  if (vertices.empty()) return false;
  const Indices unmovable = state.faults.unmovable_folds();
  const Indices unmitered = state.take_miters_back(vertices);
  for (const auto v : vertices) {
    if (std::binary_search(unmitered.begin(), unmitered.end(), v)) continue;
    state.share[v] *= kKept;
    if (state.share[v] < kLastShare) state.share[v] = 0;
    state.pulled.push_back(v);
  }
  // A vertex that cannot leave the source at all goes back at once, so that its neighbours need not follow it there.
  for (const auto v : unmovable) state.share[v] = 0;
  sort_unique(state.pulled);
  state.move(vertices);
  ++state.statistics.rounds;
  return true;
}

}  // namespace vdb_offset
