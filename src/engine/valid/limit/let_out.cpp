// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/let_out.h"

#include <algorithm>
#include <cmath>

#include "ground/numbers/hash_mix.h"
#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

// In each of so many rounds, one in kLetOutEvery pulled vertices goes this part of the rest of its whole displacement:
// vertices that have got into each other's way would do so again if they all went together. 10 to 60 % fewer vertices
// fall short with this.
struct LetOutRound {
  double part;
  int rounds;
};
constexpr LetOutRound kLetOutRounds[] = {{.part = 1, .rounds = 20}, {.part = 0.5, .rounds = 20}};
constexpr std::uint64_t kLetOutEvery = 4;

}  // namespace

LetOut::OldShares::const_iterator LetOut::find(const OldShares& shares, std::uint32_t v) {
  const auto at = std::lower_bound(shares.begin(), shares.end(), std::pair(v, 0.0));
  return at != shares.end() && at->first == v ? at : shares.end();
}

void LetOut::operator()(Progress& progress) {
  if (state_.pulled.empty()) return;
  blocked_.emplace(state_.surface);
  for (const auto& [part, rounds] : kLetOutRounds)
    for (int i = 0; i < rounds; ++i) {
      let_out_some(part);
      progress.advance(1);
    }
}

/// Lets one in kLetOutEvery pulled vertices, others in each turn, go a part of the rest of its whole displacement; not
/// vertices that are known to be blocked.
void LetOut::let_out_some(double part) {
  ++turn_;
  OldShares before;
  for (const auto v : state_.pulled) {
    double& share = state_.share[v];
    if (share == 1 || mix(turn_ << 32 | v) % kLetOutEvery != 0) continue;
    const double farther = share + (1 - share) * part;
    if (!(farther > share) || blocked_->is_blocked(v, farther)) continue;
    before.emplace_back(v, share);
    share = farther;
  }
  keep_valid(before);
}

/// Moves vertices to their new shares, then gives faulty ones their old share again, for as long as there are any. A
/// vertex without a fault of its own at first may be blocked by others that have moved, and that go back as well, or by
/// what has not moved.
void LetOut::keep_valid(const OldShares& before) {
  if (before.empty()) return;
  VDB_OFFSET_ASSERT(blocked_.has_value());
  Indices moved;
  for (const auto& [v, share] : before) moved.push_back(v);
  FaultFinder::Trial trial = state_.faults.try_out(
      moved, [&](std::uint32_t v) { return state_.position_of(v); }, FaultFinder::Crossings::OneOfEach);
  blocked_->note(
      state_.faults, [&](std::uint32_t v) { return find(before, v) != before.end(); },
      [&](std::uint32_t v) { return state_.share[v]; });
  do {
    moved = restore_faulty(before);
    trial.take_back(moved);
    ++state_.statistics.rounds;
  } while (!moved.empty());
  for (const auto& [v, share] : before)
    if (state_.share[v] != share) blocked_->note_change(v);
}

/// Gives faulty vertices their old share, if they have another. Returns these.
Indices LetOut::restore_faulty(const OldShares& before) {
  Indices faulty = state_.faults.faulty_vertices();
  std::erase_if(faulty, [&](std::uint32_t v) {
    const auto at = find(before, v);
    if (at == before.end() || at->second == state_.share[v]) return true;
    state_.share[v] = at->second;
    return false;
  });
  return faulty;
}

}  // namespace vdb_offset
