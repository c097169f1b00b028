// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "space/query/closest_query.h"

namespace vdb_offset {

/// How near the triangles of a constrained surface are to obstacles before anything moves. A triangle that is nearer
/// than the clearance then may move as long as it comes no nearer.
struct StartingGaps {
  std::vector<double> bound;          ///< Of each triangle of the surface: its gap, or the clearance if that is less.
  std::vector<std::uint8_t> touches;  ///< Of each triangle of the surface: 1 if it meets an obstacle.
  double least = 0;                   ///< World units; 0 if any meets one.
  std::size_t touching = 0;           ///< Pairs of the surface's triangles and obstacles' that meet, and
  std::size_t crossing = 0;           ///< those that go through each other.
};

/// Obstacles, and the clearance (world units) that moving faces must keep from them. The obstacles' triangles are the
/// last of the constrained surface.
struct Obstacles {
  const ClosestQuery& query;
  double clearance;
  const StartingGaps* start = nullptr;  ///< Null: all faces keep the clearance at the start.
};

}  // namespace vdb_offset
