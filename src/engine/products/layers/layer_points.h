// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ground/system/assert.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The points of the cells over layers: 0 .. wall() - 1 on the wall, then risen() of them in each layer. Stacks are
/// numbered 0 .. stacks() - 1; over a sharp edge that is opened, several stand on one point of the wall, the first of
/// which has that point's number.
struct LayerPoints {
  std::vector<std::uint32_t> vertex;  ///< Of each stack: the mesh's vertex that it stands at.
  /// Of each stack: its number among those that rise; kNone for flat ones.
  std::vector<std::uint32_t> in_layer;
  std::vector<std::uint32_t> rising;  ///< The stacks that rise.
  /// Of each stack from wall() on: the point of the wall that it shares with an earlier one.
  std::vector<std::uint32_t> shared;

  std::uint32_t stacks() const { return static_cast<std::uint32_t>(vertex.size()); }
  std::uint32_t wall() const { return static_cast<std::uint32_t>(vertex.size() - shared.size()); }
  std::uint32_t risen() const { return static_cast<std::uint32_t>(rising.size()); }
  /// Whether a stack has no height in any layer.
  bool flat(std::uint32_t stack) const { return in_layer[stack] == kNone; }
  /// The point of the wall that a stack stands on.
  std::uint32_t foot(std::uint32_t stack) const {
    VDB_OFFSET_ASSERT(stack < stacks());
    return stack < wall() ? stack : shared[stack - wall()];
  }
  /// The point of a stack in a layer, 0 for the wall.
  std::uint32_t at(std::uint32_t stack, std::size_t layer) const {
    return layer == 0 || flat(stack) ? foot(stack)
                                     : wall() + static_cast<std::uint32_t>(layer - 1) * risen() + in_layer[stack];
  }
};

}  // namespace vdb_offset
