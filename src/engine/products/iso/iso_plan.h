// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/surface/surface.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset {

/// Bytes for each leaf node: its voxel corners, OpenVDB's grids of signs and point numbers, and the new mesh with all
/// that is made to check it; measured: 16,000 to 33,000, the file included. While flat parts are merged, the mesh as it
/// was is kept (2,600), but the grids are gone by then and the file gets smaller: peaks are lower than without merging.
inline constexpr double kIsoLeafBytes = 36e3;

/// Chooses the voxel size and estimates the cost.
/// \param is_signed the source has an inside; else the iso-surface is on both of its sides
/// \throw InvalidInput for options out of range, OutOfBudget if the run would not fit.
IsoPlan plan_voxels(const Surface& surface, const IsoOptions& options, bool is_signed);

}  // namespace vdb_offset
