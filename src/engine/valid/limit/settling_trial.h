// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "valid/limit/limit_state.h"
#include "valid/untangle/schedule.h"

namespace vdb_offset {

/// Puts a vertex elsewhere at the cost of what is in its way, if less is lost by that than is won.
///
/// A trial puts the vertex there alone, with the small feature that it is part of, or while the vertices in its way
/// slide aside; then it pulls back the vertices that are still in its way, and with Aim::Distance looks for room for
/// those elsewhere.
/// What is won and lost is live area: with Aim::Distance that of vertices at their distance, with Aim::Faces that of
/// faces, by how far these are off. Each call answers whether the trial is kept; if not, nothing has changed. \pre
/// there are no faults
class SettlingTrial {
 public:
  enum class Aim : std::uint8_t { Distance, Faces };
  /// A vertex and the displacement that it is given.
  struct Move {
    std::uint32_t vertex;
    Vec3d displacement;
  };
  using Moves = std::vector<Move>;

  /// Keeps a reference.
  SettlingTrial(LimitState& state, Aim aim) : state_(state), aim_(aim) {}

  /// Moves vertices; what is won is that of the first one.
  bool try_alone(const Moves& moves) { return try_out(moves, nullptr); }
  bool try_with_feature(const Move& move);
  bool try_with_others_aside(const Move& move);

  /// How many trials there have been.
  std::size_t count() const { return count_; }

  /// More vertices than this do not slide aside, or go along, for one. Not measured.
  static constexpr std::size_t kMostAside = 200;

 private:
  /// What a vertex had before the trial.
  struct Old {
    std::uint32_t vertex;
    Vec3d whole;
    double share;
    bool was_short, was_mitered;
    double was_off;  // with Aim::Faces
  };
  using OldOnes = std::vector<Old>;

  bool try_out(const Moves& moves, const SlideAside* aside);
  Moves with_near_vertices(const Move& move, double reach) const;
  Old old_of(std::uint32_t v) const;
  void put(const Moves& moves);
  void pull(const Indices& vertices, OldOnes& old);
  bool slide_aside(std::uint32_t vertex, const SlideAside& aside, OldOnes& old);
  void put_lost_elsewhere(std::uint32_t vertex, const OldOnes& old);
  bool find_room(std::uint32_t v);
  void put_back(const OldOnes& old);
  bool is_worth_it(std::uint32_t vertex, const OldOnes& old, double leeway = 1);

  LimitState& state_;
  Aim aim_;
  std::size_t count_ = 0;
};

}  // namespace vdb_offset
