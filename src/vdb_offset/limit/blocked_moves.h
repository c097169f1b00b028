#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "vdb_offset/surface/surface.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {

/// What vertices have met by themselves when they were let out: they would meet the same again for as long as none of
/// the corners of that has moved. Memory: 24 bytes a vertex.
class BlockedMoves {
 public:
  explicit BlockedMoves(const Surface& surface) : surface_(surface), of_(surface.vertices.size()) {}

  /// Whether a vertex that is let out to a share of its way would meet what it has met there before.
  bool expects(std::uint32_t v, double share) const {
    const Refusal& refusal = of_[v];
    if (refusal.share != share) return false;
    if (refusal.first == kNone) return true;
    const auto stands = [&](std::uint32_t w) { return w == v || of_[w].changed < refusal.looked; };
    const auto &first = surface_.triangles[refusal.first], &second = surface_.triangles[refusal.second];
    return std::all_of(first.begin(), first.end(), stands) && std::all_of(second.begin(), second.end(), stands);
  }

  /// Notes what is wrong now that some vertices alone have been let out, to share_of(vertex).
  template <class HasMoved, class ShareOf>
  void note(const FaultFinder& faults, HasMoved&& has_moved, ShareOf&& share_of) {
    ++looks_;
    const auto refuse = [&](std::uint32_t v, std::uint32_t s, std::uint32_t t) {
      of_[v] = {share_of(v), s, t, looks_, of_[v].changed};
    };
    faults.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
      std::uint32_t only = kNone;
      for (const auto triangle : {s, t})
        for (const auto v : surface_.triangles[triangle]) {
          if (v == only || !has_moved(v)) continue;
          if (only != kNone) return;
          only = v;
        }
      if (only != kNone) refuse(only, s, t);
    });
    for (const auto v : faults.misplaced())
      if (has_moved(v)) refuse(v, kNone, kNone);
  }

  /// A vertex of those that were let out last stays there.
  void note_change(std::uint32_t v) { of_[v].changed = looks_; }

 private:
  struct Refusal {
    double share = 0;
    // Triangles that were wrong together, or one twice; kNone if it was the place itself.
    std::uint32_t first = kNone, second = kNone;
    std::uint32_t looked = 0;   // when that was
    std::uint32_t changed = 0;  // when the vertex has moved last
  };

  const Surface& surface_;
  std::vector<Refusal> of_;  // of each vertex
  std::uint32_t looks_ = 0;
};

}  // namespace vdb_offset
