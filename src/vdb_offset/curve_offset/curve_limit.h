#pragma once

#include <span>

#include "vdb_offset/curve_offset/curve_faults.h"
#include "vdb_offset/curve_offset/restore_order.h"
#include "vdb_offset/limit/limit.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/progress.h"

namespace vdb_offset {

/// Makes an offset of curves valid: no inverted segment, no collapsed one, no two that meet anew (see CurveFaults).
///
/// Where a corner of the source has cut off a piece of its offset, the points of that piece have all arrived at the
/// corner of the offset, or stopped on the way: they are put back in order, along the front (see put_in_order). What is
/// wrong then, and counts as wrong before, is spread over the front along with more and more of its neighbours, each
/// point to a place of its own at its exact distance, no farther than eight distances from where it came from. Where
/// there is no room for that the points that are wrong are pulled back straight towards where they came from, by a
/// little in each round, until nothing is wrong; then each of those is let out again, in turn, as far as nothing goes
/// wrong. A curve pulled back altogether is the source, so that it ends. Pulled points are `Limited`, with the distance
/// that they keep.
///
/// `paths` are those of the ribbon's vertices; ways stay in the plane. The result does not depend on the number of
/// threads.
LimitStatistics limit_curves(const PlaneCurves& curves, Paths& paths, const ProgressCallback& progress = {},
                             Spacing spacing = Spacing::AsItIs);

}  // namespace vdb_offset
