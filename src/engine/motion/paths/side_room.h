// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "motion/paths/propagate.h"
#include "space/curve/curve_query.h"
#include "space/query/closest_query.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Measures on which side there is room for the distances: at some of the vertices, evenly taken, whether the position
/// straight above is at the distance, and so are those halfway, a quarter of the way, and on. Up to eleven queries for
/// each vertex and side.
SideRoom room_on_sides(const ClosestQuery& query, const Distances& distances);
SideRoom room_on_sides(const CurveQuery& query, const Distances& distances);

/// Whether so many vertices are short that room_on_sides() is worth while.
bool falls_short(std::span<const VertexState> states);

}  // namespace vdb_offset
