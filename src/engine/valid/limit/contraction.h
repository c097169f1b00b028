// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "valid/limit/limit_state.h"
#include "valid/limit/place_trials.h"

namespace vdb_offset {

/// Puts short vertices beside neighbours that are at the distance: the edge between them is contracted but for a small
/// part, so that its faces keep an area, and what lies around the vertex comes to be at the distance as well.
///
/// That is what is left for a vertex of which nothing around has room straight above it. A place is taken only if the
/// faces around the vertex are nearer to the distance with it than without (see error_around()), so that no vertex is
/// counted as reached at the cost of the surface; settled vertices, which win live area, may take one that is a little
/// worse. A vertex at a border goes along the border alone; one that has to stay in planes does not go.
class Contraction {
 public:
  using Place = PlaceTrials::Place;

  /// Keeps a reference.
  explicit Contraction(LimitState& state) : state_(state) {}

  /// Contracts what has room, and what gets room by that; after the first call only around what has moved since the
  /// last. Returns whether any vertex has moved. None does if there are faults.
  bool operator()();

  /// The places of a short vertex beside its neighbours where the faces around it are not much farther off than they
  /// are now, the best first. Places are at the vertex's distance, and `off` is error_around() there.
  std::vector<Place> places(std::uint32_t vertex) const;

 private:
  bool is_contractible(std::uint32_t v) const;
  Indices neighbours(std::uint32_t v) const;
  std::optional<Vec3d> at_distance(std::uint32_t v, Vec3d position) const;
  double error_around(std::uint32_t v, const Vec3d& displacement) const;
  std::vector<PlaceTrials::Candidate> candidates(const Indices& vertices) const;

  LimitState& state_;
  Displacements before_;  // displacements at the end of the last call; empty before the first
};

}  // namespace vdb_offset
