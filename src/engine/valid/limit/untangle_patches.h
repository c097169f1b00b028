// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ground/system/progress_count.h"
#include "valid/limit/limit_state.h"
#include "valid/untangle/schedule.h"
#include "valid/untangle/vertex_patches.h"

namespace vdb_offset {

/// The first step of limit(): frees patches of faults by sliding vertices at their distance, which costs no distance.
///
/// In this order: with a warm start, patches that were moved at the farther distance and are faulty here start from
/// where they ended up there (start_from_farther()); then patches around faults are untangled by each setting of
/// kSchedule, small patches first, then larger ones (follow_schedule()); then collided vertices slide to where they
/// have their distance, if there is such a position near (free_collided()). A patch keeps a move only if no fault of it
/// gets worse. Faults may be left; pull_back() takes those.
class PatchUntangler {
 public:
  /// Keeps a reference.
  explicit PatchUntangler(LimitState& state) : state_(state), patches_(state.surface) {}

  /// All three, in order.
  void operator()(Progress& progress);

 private:
  /// Faults of a patch, in the order of their weight: misplaced vertices, corners of faulty faces and crossings,
  /// collided vertices.
  struct PatchFaults {
    std::size_t misplaced = 0, corners = 0, collided = 0;
    bool any_fault() const { return misplaced + corners > 0; }
    bool any() const { return any_fault() || collided > 0; }
    bool is_less_than(const PatchFaults& other) const;
  };

  void start_from_farther();
  void start_vertex_from_farther(std::uint32_t v);
  bool may_start_from_farther(std::uint32_t v) const;
  bool is_given_up(std::uint32_t triangle) const;

  void follow_schedule(Progress& progress);
  bool untangle_with(const UntangleSetting& setting, Progress& progress);
  void free_collided(Progress& progress);

  Indices around_faults(int rings);
  void untangle(const Indices& chosen, const Untangler::Options& energy, const PatchSizes& sizes);
  void leave_out(const PatchSizes& sizes);
  std::vector<PatchFaults> faults_by_patch() const;
  std::vector<std::uint8_t> patches_astray(const std::vector<std::pair<std::uint32_t, double>>& chosen);
  void mark_losses(const std::vector<std::pair<std::uint32_t, double>>& chosen, std::vector<std::uint8_t>& astray);
  template <class Move>
  std::size_t try_out(Move&& move);

  LimitState& state_;
  Patches patches_;  // that are being tried
  int pass_ = 0;     // how many times patches have been untangled so far
};

}  // namespace vdb_offset
