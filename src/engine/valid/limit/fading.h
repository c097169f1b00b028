// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ground/system/progress_count.h"
#include "valid/limit/limit_state.h"
#include "valid/limit/place_trials.h"

namespace vdb_offset {

/// Lets what falls short fade into its surroundings: along the edges of the source, thickness rises from a short vertex
/// by no more than `taper` times their length, and by what more is asked for there. So no vertex that is held back
/// stands alone, as a thorn or a pit, among others at the distance.
///
/// What is exact stays so: vertices on creases and those inside flat faces do not fade. A vertex that fades goes as far
/// as it may on its own path, on the line to where it stands, beside the vertex that bounds it, or between those around
/// it; one that would cause a fault at all of these stays where it is. \pre there are no faults, else nothing is done
class Fading {
 public:
  /// Keeps a reference. \param taper > 0
  Fading(LimitState& state, double taper) : state_(state), taper_(taper) {}

  void operator()(Progress& progress);

 private:
  /// A vertex, and how far it may be from the source, by a vertex beside it.
  struct Bound {
    std::uint32_t vertex, by;
    double thickness;
  };

  double thickness(std::uint32_t v) const;
  bool may_fade(std::uint32_t v) const;
  bool is_exact(std::uint32_t v) const;
  std::vector<Bound> too_thick() const;
  std::vector<PlaceTrials::Place> places(const Bound& bound) const;
  bool fade(const std::vector<Bound>& bounds, std::uint64_t pass);

  LimitState& state_;
  double taper_;
};

}  // namespace vdb_offset
