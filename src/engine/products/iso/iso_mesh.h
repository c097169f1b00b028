// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "products/iso/iso_grid.h"
#include "products/iso/iso_level.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// Makes the iso-surface phi = level as triangles, in the local frame of the source; no face if there is no such
/// surface. It is closed and manifold, and few faces cross.
///
/// OpenVDB's volumeToMesh puts a vertex into each voxel that the surface passes through. The vertex goes along the
/// gradient of phi to the level, stays in its voxel, and is put on the crease that the voxel holds (see
/// snap_to_creases.h). The result does not depend on the number of threads.
/// \param adaptivity of volumeToMesh: how readily voxels are merged where the surface is flat, 0 to 1; vertices may
/// leave merged voxels
/// \param turned turns all faces round, so that they point to where phi falls
Polygons mesh_iso_surface(const IsoGrid& grid, const Lattice& lattice, const IsoLevel& level, double adaptivity,
                          bool turned, const ProgressCallback& progress = {});

}  // namespace vdb_offset
