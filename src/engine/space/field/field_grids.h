// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/Types.h>
#include <openvdb/openvdb.h>

#include <memory>

#include "vdb_offset/field.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Leaf nodes are cubes of 8^3 voxels; voxel (i, j, k) of one stands at i << 6 | j << 3 | k in its buffer.
inline constexpr int kLeafWidth = 8;
inline constexpr int kLeafVoxels = 512;

using PhiLeaf = openvdb::FloatTree::LeafNodeType;
using ClosestLeaf = openvdb::Int32Tree::LeafNodeType;

/// The narrow band that the surface was rasterised into: every voxel within `band` of it is active and exact.
struct Front : FieldGrids {
  double band = 0;  ///< World units.
};

/// Whether OpenVDB has a transform of this voxel size: it takes one whose determinant is below 3e-15 for singular.
inline bool can_hold(double voxel_size) { return voxel_size * voxel_size * voxel_size > 3.1e-15; }

/// Empty grids of the right class, transform and names. OpenVDB holds no transform for voxels smaller than about
/// 1.5e-5; such grids keep the unit transform, as the stages never ask for it.
FieldGrids make_field_grids(double voxel_size, double background, const Vec3d& origin);

/// A field for others to use: its own grids, with metadata, and filled beyond the band as tools for level sets expect.
std::shared_ptr<DistanceField> hand_out(DistanceField&& field, bool closed_surface);

}  // namespace vdb_offset
