// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/place_trials.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "ground/numbers/hash_mix.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// The first round of the first pass tries every vertex; each later one another third of them, chosen by hash, as
// vertices that move together get into each other's way. See docs/dev/tuning.md.
constexpr std::uint64_t kTrialRounds = 40, kTrialEvery = 3;
// Of a fault's corners that have moved, the one with the least area around it goes back first, and those with up to
// this many times its area. Not measured.
constexpr double kAlikeAround = 4;

}  // namespace

Indices PlaceTrials::operator()(std::vector<Candidate> all, std::uint64_t pass) {
  for (std::uint64_t round = 0; round < kTrialRounds && !all.empty(); ++round) {
    const std::uint64_t salt = (pass * kTrialRounds + round) << 32;
    std::vector<Candidate*> some;
    for (Candidate& candidate : all)
      if (salt == 0 || mix(salt | candidate.vertex) % kTrialEvery == 0) some.push_back(&candidate);
    try_some(some);
    std::erase_if(all, [&](const Candidate& candidate) { return candidate.tried == candidate.places.size(); });
  }
  Indices moved = std::exchange(moved_, {});
  sort_unique(moved);
  return moved;
}

/// Puts vertices to the next of their places, and those back that come to be at faults.
void PlaceTrials::try_some(const std::vector<Candidate*>& some) {
  std::vector<std::uint8_t> is_better(some.size());
  for_each_index(
      some.size(),
      [&](std::size_t i) {
        Candidate& candidate = *some[i];
        is_better[i] = is_better_(candidate.vertex, candidate.places[candidate.tried++]);
      },
      16);
  OldOnes moved;
  Indices put, mitered;
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (!is_better[i]) continue;
    const std::uint32_t v = some[i]->vertex;
    moved.push_back({v, state_.whole[v], state_.share[v]});
    put.push_back(v);
    state_.whole[v] = some[i]->places[some[i]->tried - 1].end;
    state_.share[v] = 1;
    if (state_.mitered && state_.mitered->is_miter(v, state_.whole[v])) mitered.push_back(v);
  }
  if (put.empty()) return;
  // Before they are judged: any other vertex that is farther than its distance is misplaced.
  if (state_.mitered) state_.mitered->miter_again(mitered, state_.paths);
  // All crossings, as not all corners of a fault go back: one that is not known would be left.
  FaultFinder::Trial trial = state_.faults.try_out(put, [&](std::uint32_t v) { return state_.position_of(v); });
  for (Indices back = restore_faulty(moved); !back.empty(); back = restore_faulty(moved)) {
    trial.take_back(back);
    ++state_.statistics.rounds;
  }
  for (const Old& old : moved) moved_.push_back(old.vertex);
}

/// Gives moved vertices that are at faults back what they had, those with the least area around them first, and leaves
/// them out. Returns these.
Indices PlaceTrials::restore_faulty(OldOnes& moved) {
  const auto find = [&](std::uint32_t v) {
    return std::lower_bound(moved.begin(), moved.end(), v,
                            [](const Old& old, std::uint32_t w) { return old.vertex < w; });
  };
  const auto has_moved = [&](std::uint32_t v) {
    const auto at = find(v);
    return at != moved.end() && at->vertex == v;
  };
  const auto gather = [&](std::uint32_t v) {
    if (has_moved(v)) state_.gathered.add(v);
  };
  state_.faults.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto triangle : {s, t})
      for (const auto v : state_.surface.triangles[triangle])
        if (has_moved(v)) least = std::min(least, state_.live_area.area(v));
    for (const auto triangle : {s, t})
      for (const auto v : state_.surface.triangles[triangle])
        if (has_moved(v) && state_.live_area.area(v) <= kAlikeAround * least) state_.gathered.add(v);
  });
  for (const auto v : state_.faults.misplaced()) gather(v);
  state_.faults.for_each_faulty_corner(gather, [](std::uint32_t) { return true; });  // of a rim alone
  for (const auto v : state_.faults.unmovable_folds()) gather(v);
  Indices back = state_.gathered.take();
  for (const auto v : back) {
    const Old& old = *find(v);
    state_.whole[v] = old.whole;
    state_.share[v] = old.share;
  }
  if (state_.mitered) state_.mitered->take_back(back, state_.paths);
  std::erase_if(moved, [&](const Old& old) { return std::binary_search(back.begin(), back.end(), old.vertex); });
  return back;
}

}  // namespace vdb_offset
