// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "vdb_offset/field/leaf_graph.h"
#include "vdb_offset/grid.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The voxels of a field: phi (signed, < 0 inside, at voxel centres) and the index of the closest triangle. Index
/// (0, 0, 0) lies at the surface's origin.
struct FieldVoxels {
  std::shared_ptr<LeafGraph> leaves;  ///< Each has an active voxel.
  double voxel_size = 0;
  float background = 0;       ///< phi of voxels that are not active.
  Vec3d origin = Vec3d(0.0);  ///< Of the surface, world coordinates.
  bool slab = false;  ///< One leaf node thick in z: phi is taken to be the same above and below, as by a ribbon it is.
};

/// The narrow band that the surface was rasterised into: every voxel within `band` of it is active and exact.
struct Front : FieldVoxels {
  double band = 0;  ///< World units.
};

/// A field that is complete out to its reach.
struct DistanceField : FieldVoxels {
  Reach reach{};
};

}  // namespace vdb_offset
