// SPDX-License-Identifier: Apache-2.0
#include "products/layers/rail_stacks.h"

#include "ground/system/assert.h"

namespace vdb_offset {

AskedLayers::AskedLayers(std::span<const Vec3d> positions, const Vec3d& origin, std::span<const Distances> of_layers)
    : source(positions), front_origin(origin), heights(of_layers), side(of_layers.back().farthest() < 0 ? -1 : 1) {
  VDB_OFFSET_ASSERT(std::all_of(heights.begin(), heights.end(), [&](const Distances& each) {
    return each.uniform() || each.count() >= source.size();
  }));
}

void AskedLayers::stretch_mitered(const Paths& paths) {
  for (std::uint32_t v = 0; v < paths.state.size(); ++v) {
    if (paths.state[v] != VertexState::Mitered && paths.state[v] != VertexState::Cut) continue;
    stretch.resize(source.size(), 1.0);
    stretch[v] = paths.achieved[v] / std::abs(heights.back()[v]);
  }
}

RailStacks::RailStacks(const AskedLayers& asked, const Paths& paths)
    : asked_(asked),
      paths_(paths),
      positions_(asked.source.size(), asked.heights.size()),
      most_(asked.source.size(), 0.0),
      share_(asked.source.size(), 0.0),
      first_achieved_(asked.source.size(), 0.0),
      bend_(asked.source.size(), Vec3d(0.0)),
      last_put_(asked.source.size()) {
  VDB_OFFSET_ASSERT(paths.displacement.size() == share_.size() && paths.achieved.size() == share_.size());
}

RailStacks::Snapshot::Snapshot(const RailStacks& stacks, const Indices& vertices) : vertices_(vertices) {
  VDB_OFFSET_ASSERT(std::is_sorted(vertices.begin(), vertices.end()));
  positions_.reserve(vertices.size() * (stacks.positions_.layers() + 1));
  first_achieved_.reserve(vertices.size());
  last_put_.reserve(vertices.size());
  for (const auto v : vertices) {
    const auto stack = stacks.of(v);
    positions_.insert(positions_.end(), stack.begin(), stack.end());
    first_achieved_.push_back(stacks.first_achieved_[v]);
    last_put_.push_back(stacks.last_put_[v]);
  }
}

bool RailStacks::Snapshot::restore(std::uint32_t v, RailStacks& stacks) const {
  const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), v);
  if (found == vertices_.end() || *found != v) return false;
  const auto i = static_cast<std::size_t>(found - vertices_.begin());
  const auto stack = stacks.of(v);
  std::copy_n(positions_.begin() + static_cast<std::ptrdiff_t>(i * stack.size()), stack.size(), stack.begin());
  stacks.first_achieved_[v] = first_achieved_[i];
  stacks.last_put_[v] = last_put_[i];
  return true;
}

}  // namespace vdb_offset
