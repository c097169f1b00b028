// SPDX-License-Identifier: Apache-2.0
#include "space/field/leaf_graph.h"

#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "ground/system/assert.h"

namespace vdb_offset {

LeafGraph::LeafGraph(FieldGrids& grids) : grids_(grids), phi_(grids.phi->tree()), closest_(grids.closest->tree()) {
  openvdb::tree::LeafManager<openvdb::FloatTree> phi(grids.phi->tree());
  const openvdb::tree::LeafManager<openvdb::Int32Tree> closest(grids.closest->tree());
  VDB_OFFSET_ASSERT(phi.leafCount() == closest.leafCount());
  leaves_.resize(phi.leafCount());
  phi.foreach ([&](PhiLeaf& leaf, std::size_t i) {
    VDB_OFFSET_ASSERT(leaf.origin() == closest.leaf(i).origin());
    leaf.setTransientData(static_cast<openvdb::Index32>(i));
    leaves_[i] = {leaf.origin(), &leaf, &closest.leaf(i)};
  });
  link_new_leaves();
}

std::int32_t LeafGraph::touch_neighbour(std::int32_t leaf, int face) {
  VDB_OFFSET_ASSERT(static_cast<std::size_t>(leaf) < leaves_.size() && face < open_faces());
  const GraphLeaf& from = leaves_[static_cast<std::size_t>(leaf)];
  const auto known = from.neighbour[static_cast<std::size_t>(face)];
  if (known >= 0) return known;
  const openvdb::Coord origin = origin_across(from.origin, face);
  if (const PhiLeaf* there = phi_.probeConstLeaf(origin)) return static_cast<std::int32_t>(there->transientData());
  auto* const phi = new PhiLeaf(openvdb::PartialCreate(), origin, grids_.phi->background());
  phi_.addLeaf(phi);  // which owns it from here on
  auto* const closest = new ClosestLeaf(openvdb::PartialCreate(), origin, grids_.closest->background());
  closest_.addLeaf(closest);
  const std::size_t number = leaves_.size();
  phi->setTransientData(static_cast<openvdb::Index32>(number));
  leaves_.push_back({origin, phi, closest});
  return static_cast<std::int32_t>(number);
}

/// Links leaf nodes to their neighbours, and these to them. Neighbours that are new themselves link themselves.
void LeafGraph::link_new_leaves() {
  const std::size_t first = std::exchange(linked_, leaves_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(first, leaves_.size(), 64), [&](const auto& range) {
    const Accessor<const openvdb::FloatTree> phi(grids_.phi->tree());
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      for (int face = 0; face < kFaces; ++face) {
        const PhiLeaf* const there = phi.probeConstLeaf(origin_across(leaves_[i].origin, face));
        if (!there) continue;
        const openvdb::Index32 number = there->transientData();
        leaves_[i].neighbour[static_cast<std::size_t>(face)] = static_cast<std::int32_t>(number);
        if (number < first)
          leaves_[number].neighbour[static_cast<std::size_t>(opposite(face))] = static_cast<std::int32_t>(i);
      }
  });
}

void LeafGraph::prune() {
  phi_.clear();
  closest_.clear();
  openvdb::tools::pruneInactive(grids_.phi->tree());
  openvdb::tools::pruneInactive(grids_.closest->tree());
}

}  // namespace vdb_offset
