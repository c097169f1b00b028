#pragma once

#include "vdb_offset/closest.h"
#include "vdb_offset/field.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/winding.h"

namespace vdb_offset {

/// The leaf nodes that a surface phi = level passes through.
struct IsoGrid {
  openvdb::FloatGrid::Ptr phi;  ///< phi - level at voxel corners, world units; index space, (0, 0, 0) at the origin.
  std::size_t leaf_nodes = 0;
};

/// Fills the leaf nodes around phi = level, and no others: cubes that the surface cannot reach, as phi at their centre
/// and its Lipschitz constant of 1 tell, are left out, from large ones to small ones. In the others phi is exact
/// wherever a grid edge may cross the surface, and elsewhere what the nearest such cube's centre and the direction away
/// from the source say; its sign is right everywhere, in what is left out, too.
///
/// Phi is below 0 where `inside` says so, and the distance to the source wherever it does not.
/// Cost: O(voxels of those leaf nodes), a closest point for every few of them. The result does not depend on the number
/// of threads. \throw OutOfBudget for more than `most_leaf_nodes`, before one is filled.
IsoGrid rasterise_iso(const ClosestQuery& query, const Inside& inside, double level, double voxel_size,
                      std::size_t most_leaf_nodes, const ProgressCallback& progress = {});

}  // namespace vdb_offset
