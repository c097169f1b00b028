// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The grids of a field: phi (signed, < 0 inside, world units, at voxel centres) and the number of the closest triangle
/// of the triangulated mesh, with the same active voxels. Index (0, 0, 0) is a corner of a leaf node at or below the
/// mesh's bounding box. OpenVDB holds no transform for voxels smaller than about 1.5e-5; such grids have the unit
/// transform.
struct FieldGrids {
  openvdb::FloatGrid::Ptr phi;
  openvdb::Int32Grid::Ptr closest;
  double voxel_size = 0;  ///< World units.
  bool slab = false;  ///< One leaf node thick in z: phi is taken to be the same above and below, as by a ribbon it is.
};

/// A field that is complete out to its reach. What OffsetResult::field holds are the very grids that the vertices were
/// led through. Inactive voxels inside a closed surface are -background, as tools for level sets expect.
struct DistanceField : FieldGrids {
  Reach reach{};
};

/// Writes both grids as a .vdb file, as they are; `metadata` is added to what the file says of them, as strings.
/// The file is written under a temporary name and renamed. \throw WriteError, also for voxels below 1.5e-5.
VDB_OFFSET_API void save_vdb(const DistanceField& field, const std::string& path,
                             const std::vector<std::pair<std::string, std::string>>& metadata = {});

/// Makes a level set of a closed mesh: phi, in world units and below 0 inside, exact at the centres of voxels within
/// three of them of the mesh (OpenVDB's usual half width), and the half width beyond. Named "surface".
/// \throw InvalidInput for a mesh that is not closed, or voxels that are not above 1.5e-5; OutOfBudget
VDB_OFFSET_API openvdb::FloatGrid::Ptr make_level_set(PolygonView mesh, double voxel_size);

/// Writes a grid as a .vdb file, with `metadata` as strings. The file is written under a temporary name and renamed.
/// \throw WriteError
VDB_OFFSET_API void save_grid(const openvdb::FloatGrid::Ptr& grid, const std::string& path,
                              const std::vector<std::pair<std::string, std::string>>& metadata = {});

}  // namespace vdb_offset
