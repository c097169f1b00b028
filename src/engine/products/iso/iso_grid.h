// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/field/field_grids.h"
#include "space/query/closest_query.h"
#include "space/surface/inside.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// The positions of voxel corners.
struct Lattice {
  double voxel_size = 0;    ///< World units.
  Vec3d corner = Vec3d(0);  ///< The position of (0, 0, 0) of index space.

  Vec3d position(const Vec3d& index) const { return corner + index * voxel_size; }
};

/// The leaf nodes that an iso-surface phi = level passes through.
struct IsoGrid {
  openvdb::FloatGrid::Ptr phi;  ///< phi - level at voxel corners, world units; index space.
  std::size_t leaf_nodes = 0;
};

/// Fills the leaf nodes around phi = level, and no others. Cubes that the surface cannot reach, by phi at their centres
/// and its Lipschitz constant of 1, are left out, from large ones to small ones. In the other cubes phi is exact
/// wherever a grid edge may cross the surface; elsewhere it is extrapolated from the centre of the smallest known cube
/// along the gradient. Its sign is right everywhere, also in the cubes that are left out.
///
/// Where holes of the source are not filled (Inside::has_holes), phi jumps, by less than the level has from 0. Phi is
/// below 0 where `inside` says so, and the distance to the source elsewhere. Cost: O(voxels of those leaf nodes), a
/// closest point for every few of them. The result does not depend on the number of threads. \throw OutOfBudget for
/// more than `most_leaf_nodes`, before one is filled.
IsoGrid rasterise_iso(const ClosestQuery& query, const Inside& inside, double level, const Lattice& lattice,
                      std::size_t most_leaf_nodes, const ProgressCallback& progress = {});

}  // namespace vdb_offset
