// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/limit/limit_state.h"
#include "vdb_offset/limit/settling_trial.h"

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
  /// Tries a part of the vertices at a time. Returns whether any has moved.
  bool operator()(Which which);
  /// Puts vertices at such places at the cost of what is in their way, one at a time, those first whose faces have most
  /// to win (see SettlingTrial). False if none was, or if there are faults. Follows on the other call, as what has room
  /// need cost nothing. \pre that call, and faces are kept
  bool settle();

 private:
  /// Where a vertex might be, as a displacement, and how far the planes around it are off there, in distances.
  struct Place {
    Vec3d end;
    double off;
  };
  /// The places of a vertex that are better than where it is, the best first, of which so many have been tried.
  struct Candidate {
    std::uint32_t vertex;
    std::vector<Place> places;
    std::size_t tried = 0;
  };
  /// A vertex, and what it had before it was put elsewhere.
  struct Old {
    std::uint32_t vertex;
    Vec3d whole;
    double share;
  };
  using OldOnes = std::vector<Old>;

  bool may_move(std::uint32_t v) const;
  bool may_be_better(std::uint32_t v) const;
  std::vector<Candidate> candidates(Which which);
  std::vector<Place> places(std::uint32_t v, Which which) const;
  void offer_planes(std::uint32_t v, double worst, std::vector<Place>& places) const;
  void offer_images(std::uint32_t v, double worst, std::vector<Place>& places) const;
  bool is_at_distance(std::uint32_t v, const Vec3d& end) const;
  bool try_all(std::vector<Candidate> all, std::uint64_t pass);
  bool try_some(std::vector<Candidate*>& some);
  Indices restore_faulty(OldOnes& moved);
  bool settle(const Candidate& candidate, SettlingTrial& trial) const;

  LimitState& state_;
  std::vector<std::uint8_t> on_crease_;  // of each vertex; empty before the first call
};

}  // namespace vdb_offset
