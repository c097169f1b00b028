#pragma once

#include "vdb_offset/field/field_grids.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/surface/inside.h"

namespace vdb_offset {

/// Where voxel corners stand.
struct Lattice {
  double voxel_size = 0;    ///< World units.
  Vec3d corner = Vec3d(0);  ///< Where (0, 0, 0) of index space stands.

  Vec3d place(const Vec3d& index) const { return corner + index * voxel_size; }
};

/// The leaf nodes that a surface phi = level passes through.
struct IsoGrid {
  openvdb::FloatGrid::Ptr phi;  ///< phi - level at voxel corners, world units; index space.
  std::size_t leaf_nodes = 0;
};

/// Fills the leaf nodes around phi = level, and no others: cubes that the surface cannot reach, as phi at their centre
/// and its Lipschitz constant of 1 tell, are left out, from large ones to small ones. In the others phi is exact
/// wherever a grid edge may cross the surface, and elsewhere what the nearest such cube's centre and the direction away
/// from the source say; its sign is right everywhere, in what is left out, too.
///
/// Where holes of the source are not filled (Inside::has_holes), phi jumps there, by less than the level has from 0.
/// Phi is below 0 where `inside` says so, and the distance to the source wherever it does not.
/// Cost: O(voxels of those leaf nodes), a closest point for every few of them. The result does not depend on the number
/// of threads. \throw OutOfBudget for more than `most_leaf_nodes`, before one is filled.
IsoGrid rasterise_iso(const ClosestQuery& query, const Inside& inside, double level, const Lattice& lattice,
                      std::size_t most_leaf_nodes, const ProgressCallback& progress = {});

}  // namespace vdb_offset
