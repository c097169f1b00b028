// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "valid/limit/limit_state.h"
#include "valid/limit/place_trials.h"
#include "valid/limit/settling_trial.h"

namespace vdb_offset {

/// Puts vertices to where their faces are at the distance, once there is room: with round corners those that are short
/// or have slid, else all whose planes are off.
///
/// Such places of a vertex are the end of its miter, that of its path, the images of live points around it (see
/// LiveArea::positions_with_room()), and on a crease what lies at the distance on one, two or three of the largest
/// planes around it: straight above the largest, a vertex that has no room beside it still lets that be at the
/// distance. The places are tried by how far they leave the planes off. A vertex that would cause a fault stays.
class ReturnToFaces {
 public:
  /// Keeps a reference.
  explicit ReturnToFaces(LimitState& state) : state_(state) {}

  /// LargeCorners: those alone that have much live area around them, at their ends and on their planes.
  enum class Which { LargeCorners, All };
  /// Tries a part of the vertices at a time; once all were, only those around which others have moved since. Returns
  /// whether any has moved.
  bool operator()(Which which);
  /// Puts vertices at such places at the cost of what is in their way, one at a time, those first whose faces have most
  /// to win (see SettlingTrial). False if none was, or if there are faults. Follows on the other call, as what has room
  /// need cost nothing. \pre that call, and faces are kept
  bool settle();

 private:
  using Place = PlaceTrials::Place;  // off: the mean by area of the planes
  using Candidate = PlaceTrials::Candidate;

  bool may_move(std::uint32_t v) const;
  bool may_be_better(std::uint32_t v) const;
  std::vector<Candidate> candidates(const Indices& vertices, Which which);
  std::vector<Place> places(std::uint32_t v, Which which) const;
  void offer_planes(std::uint32_t v, double worst, std::vector<Place>& places) const;
  void offer_images(std::uint32_t v, double worst, std::vector<Place>& places) const;
  bool is_at_distance(std::uint32_t v, const Vec3d& end) const;
  bool settle(const Candidate& candidate, SettlingTrial& trial) const;

  LimitState& state_;
  Displacements before_;  // displacements when all vertices were tried last; empty before that
};

}  // namespace vdb_offset
