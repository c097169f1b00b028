// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/field/field_grids.h"
#include "space/surface/surface.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

struct RasteriseOptions {
  double voxel_size;  ///< World units, > 0.
  double band;        ///< World units, > voxel_size, so that no grid edge crosses the surface unseen.
  bool slab = false;  ///< Only leaf nodes with 0 <= z < 8 voxels, for a ribbon that stands in them (see ribbon.h).
};

/// Makes every voxel within `band` of the surface active and gives it its exact distance (float) and closest
/// triangle, the one of lowest index among equals. The sign is that of the closest feature's pseudonormal
/// (see Surface::pseudonormal), on open surfaces too: the side of the triangle that is closest.
///
/// Triangles are sorted into leaf nodes, then each leaf node is filled on its own: no locks, and the same result
/// for any number of threads. Cost: O(voxels of the band times the triangles near each).
/// \pre the surface is in the local frame of this voxel size (to_local_frame()).
Front rasterise(const Surface& surface, const RasteriseOptions& options, const ProgressCallback& progress = {});

}  // namespace vdb_offset
