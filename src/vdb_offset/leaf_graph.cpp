#include "vdb_offset/leaf_graph.h"

#include <memory>

namespace vdb_offset {
namespace {

openvdb::Coord step(openvdb::Coord origin, int face) {
  origin[face / 2] += face % 2 ? kLeafWidth : -kLeafWidth;
  return origin;
}

}  // namespace

LeafGraph::LeafGraph(FieldGrids& grids) : grids_(grids) {
  const auto count = grids.phi->tree().leafCount();
  leaves_.reserve(count);
  index_of_.reserve(2 * count);
  for (auto leaf = grids.phi->tree().beginLeaf(); leaf; ++leaf)
    append(leaf.getLeaf(), grids.closest->tree().probeLeaf(leaf->origin()));
}

std::int32_t LeafGraph::touch_neighbour(std::int32_t leaf, int face) {
  const auto known = leaves_[static_cast<std::size_t>(leaf)].neighbour[static_cast<std::size_t>(face)];
  if (known >= 0) return known;
  const openvdb::Coord origin = step(leaves_[static_cast<std::size_t>(leaf)].origin(), face);
  append(grids_.phi->tree().touchLeaf(origin), grids_.closest->tree().touchLeaf(origin));
  return static_cast<std::int32_t>(leaves_.size() - 1);
}

void LeafGraph::append(openvdb::FloatTree::LeafNodeType* phi, openvdb::Int32Tree::LeafNodeType* closest) {
  const auto index = static_cast<std::int32_t>(leaves_.size());
  GraphLeaf added{phi, closest, {-1, -1, -1, -1, -1, -1}};
  for (int face = 0; face < kFaces; ++face) {
    const auto found = index_of_.find(step(phi->origin(), face));
    if (found == index_of_.end()) continue;
    added.neighbour[static_cast<std::size_t>(face)] = found->second;
    leaves_[static_cast<std::size_t>(found->second)].neighbour[static_cast<std::size_t>(opposite(face))] = index;
  }
  leaves_.push_back(added);
  index_of_.emplace(phi->origin(), index);
}

}  // namespace vdb_offset
