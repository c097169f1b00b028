// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "motion/paths/propagate.h"
#include "products/curves/curve_faults.h"

namespace vdb_offset {

/// Leads the paths of points at corners to the ends of their miters, but for those with which there would be more
/// faults: where fronts merge, curves have faults of their own, and miters add none. The result does not depend on the
/// number of threads.
void miter_sound_corners(const PlaneCurves& curves, Paths& paths);

}  // namespace vdb_offset
