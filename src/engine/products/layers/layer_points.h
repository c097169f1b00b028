// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ground/system/assert.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The points of the cells over layers: 0 .. wall() - 1 on the wall, then risen() of them in each layer.
struct LayerPoints {
  std::vector<std::uint32_t> vertex;  ///< Of each point of the wall: the mesh's vertex that it stands at.
  /// Of each point of the wall: its number among the points that rise; kNone for flat ones.
  std::vector<std::uint32_t> in_layer;
  std::vector<std::uint32_t> rising;  ///< The points of the wall that rise.

  std::uint32_t wall() const { return static_cast<std::uint32_t>(vertex.size()); }
  std::uint32_t risen() const { return static_cast<std::uint32_t>(rising.size()); }
  /// Whether a point of the wall has no height in any layer.
  bool flat(std::uint32_t point) const { return in_layer[point] == kNone; }
  /// The point of a layer (0 for the wall) above a point of the wall.
  std::uint32_t at(std::uint32_t point, std::size_t layer) const {
    VDB_OFFSET_ASSERT(point < wall());
    return layer == 0 || flat(point) ? point
                                     : wall() + static_cast<std::uint32_t>(layer - 1) * risen() + in_layer[point];
  }
};

}  // namespace vdb_offset
