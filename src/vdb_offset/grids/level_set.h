// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/Types.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace vdb_offset {

/// The faces that volumeToMesh makes, with a vertex in each voxel that a surface passes through.
struct VoxelFaces {
  std::vector<openvdb::Vec3s> points;  ///< In index space.
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
};

/// phi at voxel corners, an OpenVDB grid. An interface, as the command has what implements it in a module.
class LevelSet {
 public:
  virtual ~LevelSet() = default;
  /// phi where it is known, else `beyond` or -beyond: its sign is right.
  virtual float value(const openvdb::Coord& corner) const = 0;
  /// The surface phi = 0, by OpenVDB's volumeToMesh. \param adaptivity 0 .. 1: how readily voxels are merged
  virtual VoxelFaces surface(double adaptivity) const = 0;
};

/// Sets phi at the 512 voxel corners of leaf node `leaf`, (i, j, k) of it at i << 6 | j << 3 | k.
using FillLeaf = std::function<void(std::size_t leaf, float* phi)>;

/// Makes a grid of leaf nodes with these origins, filled in parallel. No grid edge from one of them to another corner
/// crosses the surface: other corners have the signs beside them, which is found out by a flood fill.
/// \throw what `fill` throws
std::unique_ptr<const LevelSet> make_level_set(std::span<const openvdb::Coord> origins, float beyond,
                                               const FillLeaf& fill);

/// \throw Error if make_level_set() cannot be called, as where it is in a module that is not there.
void require_level_sets();

}  // namespace vdb_offset
