// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layers.h"

#include "ground/system/parallel.h"

namespace vdb_offset {

std::vector<Vec3d> SharedStacks::surface(std::size_t layer) const {
  std::vector<Vec3d> positions(vertices());
  for_each_index(vertices(), [&](std::size_t v) { positions[v] = of(v)[layer]; });
  return positions;
}

}  // namespace vdb_offset
