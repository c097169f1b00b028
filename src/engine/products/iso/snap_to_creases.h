// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/Types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "products/iso/iso_grid.h"
#include "products/iso/iso_level.h"

namespace vdb_offset {

/// The mesh that volumeToMesh makes, with a vertex in each voxel that the surface passes through.
struct VoxelMesh {
  Lattice lattice;
  std::vector<openvdb::Vec3s> points;  ///< In index space.
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  bool merged = false;  ///< A vertex may stand for several voxels.
};

/// Puts vertices onto the creases of phi = level, where the medial axis meets it: wherever two or three sheets, told by
/// the triangles that neighbours are closest to, have the distance at one point in a vertex's own voxel. Other vertices
/// stay. Positions on a crease are as exact as others; without them the mesh cuts corners to and fro along the crease
/// (compare Kobbelt et al., Feature sensitive surface extraction from volume data, 2001, who use tangent planes instead
/// of sheets). The result does not depend on the number of threads.
/// \param positions of the vertices, on the surface, in the local frame; changed
/// \param closest the triangles that the vertices are closest to; changed
/// \return of each vertex: 1 if it is on a crease
std::vector<std::uint8_t> put_on_creases(const IsoLevel& level, const VoxelMesh& mesh, std::vector<Vec3d>& positions,
                                         std::vector<std::uint32_t>& closest);

}  // namespace vdb_offset
