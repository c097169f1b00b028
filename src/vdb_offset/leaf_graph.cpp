#include "vdb_offset/leaf_graph.h"

#include <bit>

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

void LeafIndex::insert(const openvdb::Coord& origin, std::int32_t leaf) {
  reserve(++taken_);
  slots_[slot_of(origin)] = {origin, leaf};
}

std::int32_t LeafIndex::find(const openvdb::Coord& origin) const { return slots_[slot_of(origin)].leaf; }

std::size_t LeafIndex::slot_of(const openvdb::Coord& origin) const {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k)
    hash = (hash ^ static_cast<std::uint32_t>(origin[k] / kLeafWidth)) * 0x9e3779b97f4a7c15ULL;
  std::size_t slot = (hash ^ hash >> 32) & (slots_.size() - 1);
  while (slots_[slot].leaf >= 0 && slots_[slot].origin != origin) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

LeafGraph::LeafGraph(FieldGrids& grids) : grids_(grids) {
  const auto count = grids.phi->tree().leafCount();
  leaves_.reserve(count);
  index_.reserve(2 * count);
  auto closest = grids.closest->tree().beginLeaf();
  for (auto phi = grids.phi->tree().beginLeaf(); phi; ++phi, ++closest) append(phi.getLeaf(), closest.getLeaf());
}

std::int32_t LeafGraph::touch_neighbour(std::int32_t leaf, int face) {
  const auto known = leaves_[static_cast<std::size_t>(leaf)].neighbour[static_cast<std::size_t>(face)];
  if (known >= 0) return known;
  const openvdb::Coord origin = step(leaves_[static_cast<std::size_t>(leaf)].origin(), face);
  new_phi_.push_back(std::make_unique<PhiLeaf>(openvdb::PartialCreate(), origin, grids_.phi->background()));
  new_closest_.push_back(std::make_unique<ClosestLeaf>(openvdb::PartialCreate(), origin, -1));
  append(new_phi_.back().get(), new_closest_.back().get());
  return static_cast<std::int32_t>(leaves_.size() - 1);
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

void LeafGraph::append(PhiLeaf* phi, ClosestLeaf* closest) {
  const auto index = static_cast<std::int32_t>(leaves_.size());
  GraphLeaf added{phi, closest, {-1, -1, -1, -1, -1, -1}};
  for (int face = 0; face < kFaces; ++face) {
    const std::int32_t found = index_.find(step(phi->origin(), face));
    if (found < 0) continue;
    added.neighbour[static_cast<std::size_t>(face)] = found;
    leaves_[static_cast<std::size_t>(found)].neighbour[static_cast<std::size_t>(opposite(face))] = index;
  }
  leaves_.push_back(added);
  index_.insert(phi->origin(), index);
}

}  // namespace vdb_offset
