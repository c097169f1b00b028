#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/query/closest_query.h"

namespace vdb_offset {

/// How near a body's triangles stand to obstacles before anything moves. What is nearer than the clearance there may
/// move as long as it comes no nearer.
struct StartingGaps {
  std::vector<double> bound;          ///< Of each triangle of the body: its gap, or the clearance if that is less.
  std::vector<std::uint8_t> touches;  ///< Of each triangle of the body: 1 if it meets an obstacle.
  double least = 0;                   ///< World units; 0 if any meets one.
  std::size_t touching = 0;           ///< Pairs of the body's triangles and obstacles' that meet, and
  std::size_t crossing = 0;           ///< those that go through each other.
};

/// Other geometry, that nothing which moves may come nearer to than this, in world units. Its triangles are the last of
/// the body's surface.
struct Obstacles {
  const ClosestQuery& query;
  double clearance;
  const StartingGaps* start = nullptr;  ///< Without: everything stands clear of them.
};

}  // namespace vdb_offset
