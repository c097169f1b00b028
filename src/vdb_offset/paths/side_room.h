#pragma once

#include <span>

#include "vdb_offset/curve/curve_query.h"
#include "vdb_offset/mesh/distances.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/query/closest_query.h"

namespace vdb_offset {

/// How much of an open surface, or of open curves, has room for a distance on either side: which of them faces point to
/// is the file's say alone, and often wrong.
struct SideRoom {
  bool known = false;          ///< It is looked for where little has reached its distance.
  double here = 1, there = 1;  ///< Shares of the vertices: on the side that was asked for, and on the other one.

  /// Whether the other side may well be the one that was meant.
  bool suggests_other() const { return known && here < 0.9 && there > here + 0.2; }
};

/// Asks at some of the vertices, evenly taken, whether the place straight above is at the distance, one query each.
SideRoom room_on_sides(const ClosestQuery& front, const Distances& distances);
SideRoom room_on_sides(const CurveQuery& front, const Distances& distances);

/// Whether so much falls short of its distance that it is worth while to ask.
bool falls_short(std::span<const VertexState> states);

}  // namespace vdb_offset
