// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include "vdb_offset/api.h"
#include "vdb_offset/distance_field.h"
#include "vdb_offset/grid.h"

namespace vdb_offset {

/// A field as OpenVDB's grids: phi (signed, < 0 inside, at voxel centres) and the index of the closest triangle, with
/// the same active voxels. Index (0, 0, 0) lies at the surface's origin. OpenVDB holds no transform for voxels smaller
/// than about 1.5e-5; such grids have the unit transform.
struct FieldGrids {
  openvdb::FloatGrid::Ptr phi;
  openvdb::Int32Grid::Ptr closest;
  double voxel_size = 0;
  bool slab = false;  ///< One leaf node thick in z: phi is taken to be the same above and below, as by a ribbon it is.
  Reach reach{};      ///< The field is complete out to it.
};

/// Copies a field into grids.
VDB_OFFSET_API FieldGrids make_grids(const DistanceField& field);

}  // namespace vdb_offset
