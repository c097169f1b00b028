// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/grids/openvdb/voxel_grids.h"

#include <openvdb/io/Archive.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <memory>
#include <ostream>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/error.h"
#include "vdb_offset/grids/openvdb/library_trees.h"
#include "vdb_offset/grids/write_grids.h"

namespace vdb_offset {
namespace {

using PhiTreeLeaf = openvdb::FloatTree::LeafNodeType;
using ClosestTreeLeaf = openvdb::Int32Tree::LeafNodeType;

/// Writes to a stream of ours, so that a full disk is noticed: openvdb::io::File hides its stream.
struct Archive : openvdb::io::Archive {
  using openvdb::io::Archive::write;
};

FieldGrids make_empty_grids(const FieldVoxels& voxels) {
  FieldGrids grids;
  grids.voxel_size = voxels.voxel_size;
  grids.slab = voxels.slab;
  grids.phi = openvdb::FloatGrid::create(voxels.background);
  grids.closest = openvdb::Int32Grid::create(-1);
  const bool is_held = can_hold(voxels.voxel_size);
  auto transform = openvdb::math::Transform::createLinearTransform(is_held ? voxels.voxel_size : 1.0);
  if (is_held) transform->postTranslate(voxels.origin);
  grids.phi->setName("phi");
  grids.phi->setGridClass(openvdb::GRID_LEVEL_SET);
  grids.closest->setName("closest_primitive");
  grids.phi->setTransform(transform);
  grids.closest->setTransform(transform);
  return grids;
}

/// A leaf node of a tree with these values of all its voxels.
template <class Leaf, class Value>
std::unique_ptr<Leaf> make_leaf(const FieldLeaf& from, const Value* values) {
  auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), from.origin);
  leaf->allocate();
  std::copy_n(values, kLeafVoxels, leaf->buffer().data());
  leaf->setValueMask(from.active);
  return leaf;
}

}  // namespace

FieldGrids make_grids(const FieldVoxels& voxels) {
  FieldGrids grids = make_empty_grids(voxels);
  const LeafGraph& leaves = *voxels.leaves;
  std::vector<std::unique_ptr<PhiTreeLeaf>> phi(leaves.size());
  std::vector<std::unique_ptr<ClosestTreeLeaf>> closest(leaves.size());
  for_each_index(
      leaves.size(),
      [&](std::size_t i) {
        phi[i] = make_leaf<PhiTreeLeaf>(leaves[i], leaves[i].phi.get());
        closest[i] = make_leaf<ClosestTreeLeaf>(leaves[i], leaves[i].closest.get());
      },
      16);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    grids.phi->tree().addLeaf(phi[i].release());
    grids.closest->tree().addLeaf(closest[i].release());
  }
  return grids;
}

FieldGrids make_grids(const DistanceField& field) {
  FieldGrids grids = make_grids(static_cast<const FieldVoxels&>(field));
  grids.reach = field.reach;
  return grids;
}

void require_vdb_writer(const std::string&) {}

void write_grids(const std::string& path, std::ostream& file, const DistanceField& field, bool closed_surface,
                 const std::vector<std::pair<std::string, std::string>>& metadata) {
  try {
    openvdb::initialize();  // registers the grid types that a file may hold; further calls do nothing
    const FieldGrids grids = make_grids(field);
    // Tools for level sets expect inactive voxels and tiles inside a closed surface to be -background.
    if (closed_surface) openvdb::tools::signedFloodFill(grids.phi->tree());
    // Copies, which share the trees: OpenVDB rounds a transform as it copies it, and files have always held that one.
    const openvdb::GridPtrVec written{grids.phi->copyGrid(), grids.closest->copyGrid()};
    for (const openvdb::GridBase::Ptr& grid : written) {
      for (const auto& [key, value] : metadata) grid->insertMeta(key, openvdb::StringMetadata(value));
      grid->insertMeta("reach_inside", openvdb::DoubleMetadata(field.reach.inside));
      grid->insertMeta("reach_outside", openvdb::DoubleMetadata(field.reach.outside));
    }
    Archive().write(file, written, true);
  } catch (const openvdb::Exception& error) {
    throw WriteError(path + ": cannot be written: " + error.what());
  }
}

}  // namespace vdb_offset
