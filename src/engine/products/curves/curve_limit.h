// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "motion/paths/propagate.h"
#include "products/curves/curve_faults.h"
#include "products/curves/restore_order.h"
#include "valid/limit/limit.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// Makes an offset of curves valid: no segment is inverted or collapsed, and none crosses another anew (see
/// CurveFaults).
///
/// Where a corner of the source has cut off a piece of its offset, the points of that piece have all arrived at the
/// corner of the offset, or stopped on the way: they are put back in order, along the front (see put_in_order). The
/// faults that are left then are those counted as before. Runs of faulty and short points are spread over the front
/// along with more and more of their neighbours, each point to a position of its own at its exact distance, no farther
/// than eight distances from its source. Where there is no room for that, faulty points are pulled back straight
/// towards their source, by a little in each round, until there is no fault; then each of them is let out again, in
/// turn, as far as it gets no fault. A curve that is pulled back altogether is the source, so that this ends. Pulled
/// points are `Limited`, with the distance that they keep.
///
/// Where corners are mitered, points go to the ends of their miters before that, unless there is a fault there.
///
/// `paths` are those of the polyline's vertices; displacements stay in the plane. The result does not depend on the
/// number of threads.
LimitStatistics limit_curves(const PlaneCurves& curves, Paths& paths, const ProgressCallback& progress = {},
                             Spacing spacing = Spacing::AsItIs);

}  // namespace vdb_offset
