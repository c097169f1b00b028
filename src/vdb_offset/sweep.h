#pragma once

#include "vdb_offset/field.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/surface.h"

namespace vdb_offset {

enum class Solver {
  Closest,  ///< Hands the closest triangle on from voxel to voxel, each walking on from there over the mesh.
  Eikonal,  ///< Godunov's update of |grad phi| = 1 on phi alone: first order, the paper's method.
};

struct SweepOptions {
  Solver solver = Solver::Closest;
  Reach reach{};  ///< Voxels are set up to this far on each side; at least the front's band.
};

/// Extends phi, and with it the closest triangle, from the front to every voxel within reach.
///
/// Fast sweeping (Zhao, A fast sweeping method for Eikonal equations, Math. Comp. 74, 2005) over leaf nodes of 8^3
/// voxels: inside a leaf node Gauss-Seidel in alternating directions, between leaf nodes red and black in turn, so
/// that no two leaf nodes which touch are ever at work together. A leaf node comes up again only when a voxel on a
/// face towards it has improved. Phi only ever moves towards the surface; voxels of the front keep their bits.
/// The Eikonal solver uses the full one-, two- and three-neighbour update and hands on the triangle of the
/// neighbour that phi came from, as a hint only.
///
/// The front's grids are taken over and extended. The result does not depend on the number of threads.
/// Cost: O(voxels), a few visits each. \throw InvalidInput if the front has no active voxel.
DistanceField sweep(Front front, const Surface& surface, const SweepOptions& options,
                    const ProgressCallback& progress = {});

}  // namespace vdb_offset
