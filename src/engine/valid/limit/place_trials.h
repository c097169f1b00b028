// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "valid/limit/limit_state.h"

namespace vdb_offset {

/// Tries places of many vertices at once, none at the cost of another: they go there together, and those that come to
/// be at faults go back, those with the least area around them first. Faults that there are before count as theirs.
class PlaceTrials {
 public:
  /// Where a vertex might be, as a displacement, and how far the faces around it are off there, in distances.
  struct Place {
    Vec3d end;
    double off;
  };
  /// Places of a vertex, in the order in which they are tried, of which so many have been.
  struct Candidate {
    std::uint32_t vertex;
    std::vector<Place> places;
    std::size_t tried = 0;
  };
  /// Whether a place is better than where its vertex stands at the time; others are not tried. Called in parallel.
  using IsBetter = std::function<bool(std::uint32_t vertex, const Place& place)>;

  /// Keeps a reference.
  PlaceTrials(LimitState& state, IsBetter is_better) : state_(state), is_better_(std::move(is_better)) {}

  /// Tries the places of some vertices, each at most once. Returns the vertices that stay at one, sorted. The number of
  /// the pass decides which vertices go together.
  Indices operator()(std::vector<Candidate> all, std::uint64_t pass);

 private:
  /// A vertex, and what it had before it was put elsewhere.
  struct Old {
    std::uint32_t vertex;
    Vec3d whole;
    double share;
  };
  using OldOnes = std::vector<Old>;

  void try_some(const std::vector<Candidate*>& some);
  Indices restore_faulty(OldOnes& moved);

  LimitState& state_;
  IsBetter is_better_;
  Indices moved_;  // that have stayed elsewhere in this pass; some of them more than once
};

}  // namespace vdb_offset
