// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/grid.h"

namespace vdb_offset {

/// The grids of a field: phi (signed, < 0 inside, at voxel centres) and the index of the
/// closest triangle, with the same active voxels. Index (0, 0, 0) lies at the surface's origin.
struct FieldGrids {
  openvdb::FloatGrid::Ptr phi;
  openvdb::Int32Grid::Ptr closest;
  double voxel_size = 0;
  bool slab = false;  ///< One leaf node thick in z: phi is taken to be the same above and below, as by a ribbon it is.
};

/// A field that is complete out to its reach.
struct DistanceField : FieldGrids {
  Reach reach{};
};

/// Writes phi and closest as a .vdb file; `metadata` is added to both grids as strings.
/// The file is written under a temporary name and renamed. \throw WriteError, also for voxels below 1.5e-5.
VDB_OFFSET_API void save_vdb(const DistanceField& field, const std::string& path, bool closed_surface,
                             const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace vdb_offset
