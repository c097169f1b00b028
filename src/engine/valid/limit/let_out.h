// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ground/system/progress_count.h"
#include "valid/limit/blocked_moves.h"
#include "valid/limit/limit_state.h"

namespace vdb_offset {

/// The third and the last step of limit(): lets pulled vertices out again, and eases the thickness around them. Both
/// are called when there are no faults, and make none: a vertex that would cause one keeps the share that it had.
///
/// operator() follows on pull_back(), and again on each Settling, as what was settled has pulled others back. ease() is
/// the last, since what it takes back must not be let out again.
class LetOut {
 public:
  /// Keeps a reference.
  explicit LetOut(LimitState& state) : state_(state) {}

  /// Lets a few of the pulled vertices at a time out to their whole displacement, then ever less of the rest of it. Of
  /// a faulty face's corners often one alone is in the wrong position; the others can go once they do not go along with
  /// it.
  void operator()(Progress& progress);

  /// Takes the neighbours of a pulled vertex back as well, until thickness changes by no more than kSteepest along
  /// edges. A vertex at its distance stays there, and one that is pulled back altogether is not followed, nor is one
  /// by a vertex with far more area around it. \pre operator() has been called if any vertex was pulled.
  void ease();

 private:
  /// Vertices and the shares that they had, sorted by vertex.
  using OldShares = std::vector<std::pair<std::uint32_t, double>>;
  static OldShares::const_iterator find(const OldShares& shares, std::uint32_t v);

  void let_out_some(double part);
  double steepest_change(std::uint32_t v, std::uint32_t beside) const;
  void keep_valid(const OldShares& before);
  Indices restore_faulty(const OldShares& before);

  LimitState& state_;
  std::optional<BlockedMoves> blocked_;  // set once vertices are let out
  std::uint64_t turn_ = 0;               // of letting out
};

}  // namespace vdb_offset
