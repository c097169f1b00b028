// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/field/field_grids.h"
#include "space/surface/surface.h"
#include "vdb_offset/options.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

struct SweepOptions {
  Solver solver = Solver::Closest;
  Reach reach{};  ///< Voxels are set up to this far on each side; at least the front's band.
};

/// Extends phi, and with it the closest triangle, from the front to every voxel within reach.
///
/// Leaf nodes of 8^3 voxels are visited nearest to the surface first, red and black in turn like a chequerboard's, so
/// that no two which share a face are ever at work together; inside one, voxels are swept in alternating directions
/// (Zhao, A fast sweeping method for Eikonal equations, Math. Comp. 74, 2005). A leaf node comes up again only when a
/// voxel across one of its faces has something better to offer. Voxels of the front keep their bits.
///
/// The closest solver hands on the front's closest points, and looks at the mesh only afterwards: every voxel walks
/// once over it, from the triangle of its point to the closest one, then compares itself with its neighbours. Phi is
/// the exact distance to some triangle, and that is the closest but for a few voxels where parts of the surface
/// compete. The eikonal solver uses the full one-, two- and three-neighbour update and hands on the triangle of the
/// neighbour that phi came from, as a hint only.
///
/// The front's grids are taken over and extended. The result does not depend on the number of threads.
/// Memory: 20 bytes a voxel of leaf nodes, of which 8 stay. Cost: O(voxels), less than two visits each.
/// \throw InvalidInput if the front has no active voxel.
DistanceField sweep(Front front, const Surface& surface, const SweepOptions& options,
                    const ProgressCallback& progress = {});

}  // namespace vdb_offset
