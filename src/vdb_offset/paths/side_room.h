#pragma once

#include <span>

#include "vdb_offset/curve/curve_query.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

/// Asks at some of the vertices, evenly taken, whether the place straight above is at the distance, one query each.
SideRoom room_on_sides(const ClosestQuery& front, const Distances& distances);
SideRoom room_on_sides(const CurveQuery& front, const Distances& distances);

/// Whether so much falls short of its distance that it is worth while to ask.
bool falls_short(std::span<const VertexState> states);

}  // namespace vdb_offset
