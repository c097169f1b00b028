#pragma once

#include <openvdb/Types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/iso/iso_grid.h"
#include "vdb_offset/iso/iso_level.h"

namespace vdb_offset {

/// Vertices and faces as volumeToMesh makes them, a vertex in each voxel that the surface passes through.
struct VoxelMesh {
  Lattice lattice;
  std::vector<openvdb::Vec3s> points;  ///< Index space.
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  bool merged = false;  ///< A vertex may stand for several voxels.
};

/// Puts vertices onto the creases of phi = level, where the medial axis meets it: wherever two or three sheets, told by
/// what neighbours are closest to, have the distance at one place in a vertex's own voxel. Elsewhere vertices stay.
/// Such a place is as exact as any other; without it the mesh is cut to and fro along the crease, from one sheet to the
/// other (compare Kobbelt et al., Feature sensitive surface extraction from volume data, 2001, where tangent planes
/// take the part of sheets).
///
/// `places` are those of the vertices, on the surface, in the local frame; `closest` the triangles that they are
/// closest to. Returns of each vertex whether it is on a crease. The result does not depend on the number of threads.
std::vector<std::uint8_t> put_on_creases(const LevelSet& level, const VoxelMesh& mesh, std::vector<Vec3d>& places,
                                         std::vector<std::uint32_t>& closest);

}  // namespace vdb_offset
