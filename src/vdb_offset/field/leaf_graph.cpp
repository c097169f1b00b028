// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/field/leaf_graph.h"

#include <bit>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

openvdb::Coord step(openvdb::Coord origin, int face) {
  origin[face / 2] += face % 2 ? kLeafWidth : -kLeafWidth;
  return origin;
}

}  // namespace

void LeafIndex::reserve(std::size_t count) {
  if (2 * count <= slots_.size()) return;
  std::vector<Slot> old(std::bit_ceil(2 * count));
  old.swap(slots_);
  for (const Slot& slot : old)
    if (slot.leaf >= 0) slots_[slot_of(slot.origin)] = slot;
}

std::int32_t LeafIndex::find_or_insert(const openvdb::Coord& origin, std::int32_t leaf) {
  VDB_OFFSET_ASSERT(leaf >= 0);
  reserve(taken_ + 1);
  Slot& slot = slots_[slot_of(origin)];
  if (slot.leaf >= 0) return slot.leaf;
  ++taken_;
  slot = {origin, leaf};
  return leaf;
}

std::int32_t LeafIndex::find(const openvdb::Coord& origin) const { return slots_[slot_of(origin)].leaf; }

std::size_t LeafIndex::slot_of(const openvdb::Coord& origin) const {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k)
    hash = (hash ^ static_cast<std::uint32_t>(origin[k] / kLeafWidth)) * 0x9e3779b97f4a7c15ULL;
  VDB_OFFSET_ASSERT(std::has_single_bit(slots_.size()) && 2 * taken_ <= slots_.size() + 1);
  std::size_t slot = (hash ^ hash >> 32) & (slots_.size() - 1);
  while (slots_[slot].leaf >= 0 && slots_[slot].origin != origin) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

LeafGraph::LeafGraph(FieldGrids& grids) : grids_(grids), grid_leaves_(grids.phi->tree().leafCount()) {
  VDB_OFFSET_ASSERT(grids.closest->tree().leafCount() == grid_leaves_);
  leaves_.reserve(grid_leaves_);
  index_.reserve(2 * grid_leaves_);
  auto closest = grids.closest->tree().beginLeaf();
  for (auto phi = grids.phi->tree().beginLeaf(); phi; ++phi, ++closest) {
    VDB_OFFSET_ASSERT(phi->origin() == closest->origin());
    index_.find_or_insert(phi->origin(), static_cast<std::int32_t>(leaves_.size()));
    leaves_.push_back({phi->origin(), phi.getLeaf(), closest.getLeaf()});
  }
  for_each_index(
      grid_leaves_, [&](std::size_t leaf) { link(leaf, 0); }, 64);
}

std::int32_t LeafGraph::touch_neighbour(std::int32_t leaf, int face) {
  VDB_OFFSET_ASSERT(static_cast<std::size_t>(leaf) < leaves_.size() && face < open_faces());
  const GraphLeaf& from = leaves_[static_cast<std::size_t>(leaf)];
  const auto known = from.neighbour[static_cast<std::size_t>(face)];
  if (known >= 0) return known;
  const openvdb::Coord origin = step(from.origin, face);
  const auto next = static_cast<std::int32_t>(leaves_.size()), neighbour = index_.find_or_insert(origin, next);
  if (neighbour == next) leaves_.push_back({origin});
  return neighbour;
}

void LeafGraph::make_new_leaves() {
  const std::size_t first_new = grid_leaves_ + new_phi_.size();
  new_phi_.resize(leaves_.size() - grid_leaves_);
  new_closest_.resize(new_phi_.size());
  for_each_index(
      leaves_.size() - first_new,
      [&](std::size_t i) {
        GraphLeaf& leaf = leaves_[first_new + i];
        auto& phi = new_phi_[first_new + i - grid_leaves_];
        auto& closest = new_closest_[first_new + i - grid_leaves_];
        phi = std::make_unique<PhiLeaf>(openvdb::PartialCreate(), leaf.origin, grids_.phi->background());
        closest = std::make_unique<ClosestLeaf>(openvdb::PartialCreate(), leaf.origin, -1);
        leaf.phi = phi.get();
        leaf.closest = closest.get();
        link(first_new + i, first_new);
      },
      64);
}

/// Links a leaf node to its neighbours, and these to it. Neighbours that are new themselves are linked by their own
/// call.
void LeafGraph::link(std::size_t leaf, std::size_t first_new) {
  for (int face = 0; face < kFaces; ++face) {
    const std::int32_t found = index_.find(step(leaves_[leaf].origin, face));
    leaves_[leaf].neighbour[static_cast<std::size_t>(face)] = found;
    if (found < 0 || static_cast<std::size_t>(found) >= first_new) continue;
    auto& theirs = leaves_[static_cast<std::size_t>(found)].neighbour;
    theirs[static_cast<std::size_t>(opposite(face))] = static_cast<std::int32_t>(leaf);
  }
}

void LeafGraph::attach_new_leaves() {
  for (std::size_t i = 0; i < new_phi_.size(); ++i) {
    if (new_phi_[i]->isEmpty()) continue;
    grids_.phi->tree().addLeaf(new_phi_[i].release());
    grids_.closest->tree().addLeaf(new_closest_[i].release());
  }
  new_phi_.clear();
  new_closest_.clear();
}

}  // namespace vdb_offset
