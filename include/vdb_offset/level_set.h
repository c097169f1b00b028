// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Makes a level set of a closed mesh: phi, in world units and below 0 inside, exact at the centres of voxels within
/// three of them of the mesh (OpenVDB's usual half width), and the half width beyond. Named "surface".
/// \throw InvalidInput for a mesh that is not closed, or voxels that are not above 1.5e-5; OutOfBudget
VDB_OFFSET_API openvdb::FloatGrid::Ptr make_level_set(PolygonView mesh, double voxel_size);

/// Writes a grid as a .vdb file, with `metadata` as strings. The file is written under a temporary name and renamed.
/// \throw WriteError
VDB_OFFSET_API void save_grid(const openvdb::FloatGrid::Ptr& grid, const std::string& path,
                              const std::vector<std::pair<std::string, std::string>>& metadata = {});

}  // namespace vdb_offset
