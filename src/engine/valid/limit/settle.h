// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "valid/limit/limit_state.h"
#include "valid/limit/live_area.h"
#include "valid/limit/settling_trial.h"

namespace vdb_offset {

/// The fifth step of limit(): puts short vertices, one at a time, where there is room for them at their distance.
///
/// The positions are those of live points of the faces around a vertex (see LiveArea), then, unless faces are kept, the
/// places beside its neighbours (see Contraction). Vertices with much area go first. Each is tried alone, with its
/// short neighbours, with the small feature that it is part of, and while the vertices in its way slide aside (see
/// SettlingTrial). Follows on LetOut, as what could be let out again need not be settled, and is called first with
/// borders kept in the planes across them, then without. After the first call those vertices alone are tried that were
/// not, or around which others have moved since.
class Settling {
 public:
  /// Keeps a reference.
  explicit Settling(LimitState& state) : state_(state) {}

  /// Settles vertices at positions on these lines. False if none was settled, or if there are faults, as settling needs
  /// a valid offset to begin with.
  bool operator()(LiveArea::Lines lines);

 private:
  bool may_settle(std::uint32_t v) const { return state_.may_leave_path(v) && state_.is_short(v); }
  std::vector<std::uint32_t> vertices_to_settle(LiveArea::Lines lines);
  bool settle(std::uint32_t v, LiveArea::Lines lines, SettlingTrial& trial);
  bool settle_with_room(std::uint32_t v, LiveArea::Lines lines, SettlingTrial& trial);
  bool settle_beside(std::uint32_t v, SettlingTrial& trial);
  SettlingTrial::Move move_to(std::uint32_t v, const Vec3d& position) const;
  SettlingTrial::Moves with_short_neighbours(const SettlingTrial::Move& move, LiveArea::Lines lines);

  LimitState& state_;
  Displacements before_;  // displacements at the beginning of the last call; empty before the first
  Indices untried_;       // vertices that there were too many others for in the last call
};

}  // namespace vdb_offset
