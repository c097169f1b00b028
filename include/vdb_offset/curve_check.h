// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "vdb_offset/api.h"
#include "vdb_offset/check.h"
#include "vdb_offset/curves.h"

namespace vdb_offset {

/// Measures `positions` as an offset of plane curves, as check_offset() does for meshes, with segments for faces, and
/// the faults that limit_curves() looks for (see CurveFaults). Welding and orientation have no effect. \throw
/// InvalidInput for curves that do not lie in one plane or have no segment, and for positions that are not one for each
/// of their points, not finite, or not in that plane.
VDB_OFFSET_API CheckResult check_curves(CurvesView source, std::span<const Vec3d> positions,
                                        const CheckOptions& options = {});

}  // namespace vdb_offset
