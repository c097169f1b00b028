#pragma once

#include "vdb_offset/iso/iso_grid.h"
#include "vdb_offset/iso/iso_level.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/progress.h"

namespace vdb_offset {

/// The surface phi = level as triangles, in the local frame of what phi is the distance to; no face if there is none.
///
/// OpenVDB's volumeToMesh puts a vertex into each voxel that the surface passes through. It goes along the gradient of
/// phi to the level, stays in its voxel, and stands on the crease that this holds (see snap_to_creases.h). `adaptivity`
/// is volumeToMesh's: how readily voxels are merged where the surface is flat, 0 to 1; then vertices may leave theirs.
/// `turned` turns all faces round, so that they point to where phi falls. Closed and manifold; few faces cross. The
/// result does not depend on the number of threads.
Polygons mesh_iso_surface(const IsoGrid& grid, const Lattice& lattice, const LevelSet& level, double adaptivity,
                          bool turned, const ProgressCallback& progress = {});

}  // namespace vdb_offset
