#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/vec.h"

namespace vdb_offset {

/// The points: 0 .. wall() - 1 on the wall, and risen() in each layer above it.
struct LayerPoints {
  std::vector<std::uint32_t> vertex;  ///< Of the mesh, of each point of the wall.
  /// Of each point of the wall: its number among those that rise; kNone for flat ones.
  std::vector<std::uint32_t> in_layer;
  std::vector<std::uint32_t> rising;  ///< The points of the wall that rise.

  std::uint32_t wall() const { return static_cast<std::uint32_t>(vertex.size()); }
  std::uint32_t risen() const { return static_cast<std::uint32_t>(rising.size()); }
  bool flat(std::uint32_t point) const { return in_layer[point] == kNone; }
  std::uint32_t at(std::uint32_t point, std::size_t layer) const {
    return layer == 0 || flat(point) ? point
                                     : wall() + static_cast<std::uint32_t>(layer - 1) * risen() + in_layer[point];
  }
};

}  // namespace vdb_offset
