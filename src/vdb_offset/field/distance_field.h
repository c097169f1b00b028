#pragma once

#include <openvdb/Types.h>
#include <openvdb/openvdb.h>

#include "vdb_offset/mesh/polygons.h"

namespace vdb_offset {

/// Leaf nodes are cubes of 8^3 voxels; voxel (i, j, k) of one stands at i << 6 | j << 3 | k in its buffer.
inline constexpr int kLeafWidth = 8;
inline constexpr int kLeafVoxels = 512;

using PhiLeaf = openvdb::FloatTree::LeafNodeType;
using ClosestLeaf = openvdb::Int32Tree::LeafNodeType;

/// How far a field reaches on each side of the surface, world units, both > 0.
struct Reach {
  double inside, outside;
};

/// What the stages that make a field share: phi (signed, < 0 inside, at voxel centres) and the index of the
/// closest triangle, with the same active voxels. Index (0, 0, 0) lies at the surface's origin.
struct FieldGrids {
  openvdb::FloatGrid::Ptr phi;
  openvdb::Int32Grid::Ptr closest;
  double voxel_size = 0;
  bool slab = false;  ///< One leaf node thick in z: phi is taken to be the same above and below, as by a ribbon it is.
};

/// The narrow band that the surface was rasterised into: every voxel within `band` of it is active and exact.
struct Front : FieldGrids {
  double band = 0;  ///< World units.
};

/// The field out to its reach.
struct DistanceField : FieldGrids {
  Reach reach{};
};

/// Empty grids of the right class, transform and names. OpenVDB holds no transform for voxels smaller than about
/// 1.5e-5; such grids keep the unit transform, as the stages never ask for it.
FieldGrids make_field_grids(double voxel_size, double background, const Vec3d& origin);

/// Writes phi and closest as a .vdb file; `metadata` is added to both grids as strings.
/// The file is written under a temporary name and renamed. \throw WriteError, also for voxels below 1.5e-5.
void save_vdb(const DistanceField& field, const std::string& path, bool closed_surface,
              const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace vdb_offset
