// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/field/distance_field.h"
#include "vdb_offset/field_grids.h"

namespace vdb_offset {

/// Copies the voxels of a front or a field into grids of the right class, transform and names.
FieldGrids make_grids(const FieldVoxels& voxels);

}  // namespace vdb_offset
