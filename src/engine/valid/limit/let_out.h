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

/// The third step of limit(): lets pulled vertices out again, as far as no fault arises: a vertex that would cause one
/// keeps the share that it had. Follows on pull_back(), and on each step that pulls others back or makes room.
/// \pre there are no faults
class LetOut {
 public:
  /// Keeps a reference.
  explicit LetOut(LimitState& state) : state_(state) {}

  /// Lets a few of the pulled vertices at a time out to their whole displacement, then ever less of the rest of it. Of
  /// a faulty face's corners often one alone is in the wrong position; the others can go once they do not go along with
  /// it.
  void operator()(Progress& progress);

 private:
  /// Vertices and the shares that they had, sorted by vertex.
  using OldShares = std::vector<std::pair<std::uint32_t, double>>;
  static OldShares::const_iterator find(const OldShares& shares, std::uint32_t v);

  void let_out_some(double part);
  void keep_valid(const OldShares& before);
  Indices restore_faulty(const OldShares& before);

  LimitState& state_;
  std::optional<BlockedMoves> blocked_;  // set once vertices are let out
  std::uint64_t turn_ = 0;               // of letting out
};

}  // namespace vdb_offset
