// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "space/surface/surface.h"
#include "valid/faults/fault_finder.h"

namespace vdb_offset {

/// The faults that vertices have caused by themselves when they were let out. A vertex would cause such a fault again
/// for as long as none of its corners has moved, and need not be tried. Memory: 24 bytes a vertex.
class BlockedMoves {
 public:
  /// Keeps a reference.
  explicit BlockedMoves(const Surface& surface) : surface_(surface), of_(surface.vertices.size()) {}

  /// Whether a vertex that goes this share of its displacement would cause the fault that it caused there before.
  bool is_blocked(std::uint32_t v, double share) const {
    const Blocked& blocked = of_[v];
    if (blocked.share != share) return false;
    if (blocked.first == kNone) return true;
    const auto stands = [&](std::uint32_t w) { return w == v || of_[w].changed < blocked.noted; };
    const auto &first = surface_.triangles[blocked.first], &second = surface_.triangles[blocked.second];
    return std::all_of(first.begin(), first.end(), stands) && std::all_of(second.begin(), second.end(), stands);
  }

  /// Notes the faults that there are after some vertices, those of which has_moved(vertex) is true, have gone to
  /// share_of(vertex): each fault of which a single one of them is a corner.
  template <class HasMoved, class ShareOf>
  void note(const FaultFinder& faults, HasMoved&& has_moved, ShareOf&& share_of) {
    ++trial_;
    const auto block = [&](std::uint32_t v, std::uint32_t s, std::uint32_t t) {
      of_[v] = {share_of(v), s, t, trial_, of_[v].changed};
    };
    faults.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
      std::uint32_t only = kNone;
      for (const auto triangle : {s, t})
        for (const auto v : surface_.triangles[triangle]) {
          if (v == only || !has_moved(v)) continue;
          if (only != kNone) return;
          only = v;
        }
      if (only != kNone) block(only, s, t);
    });
    for (const auto v : faults.misplaced())
      if (has_moved(v)) block(v, kNone, kNone);
  }

  /// Call for each vertex that keeps the share that it had in the last note().
  void note_change(std::uint32_t v) { of_[v].changed = trial_; }

 private:
  struct Blocked {
    double share = 0;
    // Triangles that were faulty together, or one twice; kNone if the vertex was misplaced by itself.
    std::uint32_t first = kNone, second = kNone;
    std::uint32_t noted = 0;    // number of the trial in which that was
    std::uint32_t changed = 0;  // number of the trial in which the vertex has moved last
  };

  const Surface& surface_;
  std::vector<Blocked> of_;  // of each vertex
  std::uint32_t trial_ = 0;
};

}  // namespace vdb_offset
