// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <cmath>

#include "support/curve_oracles.h"
#include "vdb_offset/curve_offset.h"

namespace vdb_offset::test {

inline OffsetResult offset_of(const Curves& curves, double distance, Corners corners = Corners::Round) {
  const Distances distances(distance);
  OffsetOptions options;
  options.corners = corners;
  return offset_curves(curves.view(), {&distances, 1}, options).front();
}

/// States tell the truth, no point but a mitered one is too far out, and nothing crosses that did not before.
inline void require_honest(const Curves& curves, const OffsetResult& result) {
  CHECK(new_crossings(curves, result.positions) == result.statistics.limit.crossings_near_source);
  CHECK(result.statistics.limit.left.total() == 0);
  for (std::size_t p = 0; p < curves.positions.size(); ++p) {
    if (result.states[p] == VertexState::Unused) continue;
    const double target = std::abs(result.distances[p]), achieved = distance_to(curves, result.positions[p]);
    const double rounding = 1e-12 * result.statistics.facts.diagonal;
    CHECK(achieved == Approx(result.achieved[p]).margin(rounding));
    if (result.states[p] != VertexState::Mitered && result.states[p] != VertexState::Cut)
      CHECK(achieved <= target * (1 + 1e-6) + rounding);
    if (result.states[p] == VertexState::Reached) CHECK(achieved >= target * (1 - 1e-6) - rounding);
  }
}

}  // namespace vdb_offset::test
