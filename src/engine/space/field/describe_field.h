// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/field/direction_field.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Tells how large the grids are.
void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics);

}  // namespace vdb_offset
