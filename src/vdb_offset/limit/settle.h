// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/limit/limit_schedule.h"
#include "vdb_offset/limit/limit_state.h"

namespace vdb_offset {

/// The fourth step of limit(): puts short vertices, one at a time, where there is room for them at their distance.
///
/// The positions are those of live points of the faces around a vertex (see LiveArea). Vertices with much area go
/// first. A trial puts the vertex there: alone, with its short neighbours, with the small feature that it is part of,
/// or while the vertices in its way slide aside; and pulls back the vertices in its way. It is kept if less live area
/// is lost by that than is won. Follows on LetOut, as what could be let out again need not be settled, and is called
/// twice: first with borders kept in the planes across them, then without.
class Settling {
 public:
  /// Keeps a reference.
  explicit Settling(LimitState& state) : state_(state) {}

  /// Settles vertices at positions on these lines. False if none was settled, or if there are faults, as settling needs
  /// a valid offset to begin with.
  bool operator()(LiveArea::Lines lines);

 private:
  /// A vertex and the position that it is put to, in the surface's frame.
  struct Move {
    std::uint32_t vertex;
    Vec3d position;
  };
  /// What a vertex had before a trial.
  struct Old {
    std::uint32_t vertex;
    Vec3d whole;
    double share;
    bool was_short, was_mitred;
  };
  using Moves = std::vector<Move>;
  using OldOnes = std::vector<Old>;

  bool may_leave_path(std::uint32_t v) const;
  bool may_settle(std::uint32_t v) const { return may_leave_path(v) && state_.is_short(v); }
  bool may_go_along(std::uint32_t v) const { return may_leave_path(v) && !state_.is_held(v); }
  std::vector<std::uint32_t> vertices_to_settle();
  bool settle(std::uint32_t v, LiveArea::Lines lines, std::size_t& trials);
  Moves with_short_neighbours(const Move& move, LiveArea::Lines lines);
  Moves with_near_vertices(const Move& move, double reach) const;

  bool settle_at(const Moves& moves, const SlideAside* aside);
  void put(const Moves& moves, OldOnes& old);
  void pull_in_trial(const Indices& vertices, OldOnes& old);
  bool slide_aside(std::uint32_t vertex, const SlideAside& aside, OldOnes& old);
  void put_back(const OldOnes& old);
  Old old_of(std::uint32_t v) const;
  double lost_since(const OldOnes& old) const;

  LimitState& state_;
};

}  // namespace vdb_offset
