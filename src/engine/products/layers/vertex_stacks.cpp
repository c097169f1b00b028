// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layers.h"

#include <algorithm>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {

std::vector<Vec3d> SharedStacks::surface(std::size_t layer) const {
  std::vector<Vec3d> positions(vertices());
  for_each_index(vertices(), [&](std::size_t v) { positions[v] = of(v)[layer]; });
  return positions;
}

void SharedStacks::put_on_wall(std::span<const Vec3d> positions) {
  VDB_OFFSET_ASSERT(positions.size() == vertices());
  // Of vertices with one stack the first one counts.
  for (std::size_t v = vertices(); v-- > 0;) {
    const std::span<Vec3d> stack = stacks_.of(stack_[v]);
    if (stacks_.is_flat(stack_[v])) std::fill(stack.begin(), stack.end(), positions[v]);
    else stack.front() = positions[v];
  }
}

}  // namespace vdb_offset
