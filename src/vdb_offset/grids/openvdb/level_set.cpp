// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/grids/level_set.h"

#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/grids/openvdb/library_trees.h"

namespace vdb_offset {
namespace {

class GridLevelSet : public LevelSet {
 public:
  explicit GridLevelSet(openvdb::FloatGrid::Ptr phi) : phi_(std::move(phi)) {}

  float value(const openvdb::Coord& corner) const override { return phi_->tree().getValue(corner); }
  VoxelFaces surface(double adaptivity) const override {
    VoxelFaces faces;
    openvdb::tools::volumeToMesh(*phi_, faces.points, faces.triangles, faces.quads, 0.0, adaptivity);
    return faces;
  }

 private:
  openvdb::FloatGrid::Ptr phi_;
};

}  // namespace

std::unique_ptr<const LevelSet> make_level_set(std::span<const openvdb::Coord> origins, float beyond,
                                               const FillLeaf& fill) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  std::vector<std::unique_ptr<Leaf>> nodes(origins.size());
  for_each_index(
      nodes.size(),
      [&](std::size_t l) {
        nodes[l] = std::make_unique<Leaf>(origins[l], 0.0f, true);
        fill(l, nodes[l]->buffer().data());
      },
      8);
  auto phi = openvdb::FloatGrid::create(beyond);
  for (auto& node : nodes) phi->tree().addLeaf(node.release());
  openvdb::tools::signedFloodFillWithValues(phi->tree(), beyond, -beyond);
  return std::make_unique<GridLevelSet>(std::move(phi));
}

void require_level_sets() {}

}  // namespace vdb_offset
