// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "products/layers/layer_wall.h"

namespace vdb_offset {

/// The columns that have an invalid cell.
class InvalidColumns {
 public:
  /// Judges all columns. Keeps a reference. \pre the layers of all vertices have been put
  explicit InvalidColumns(const LayerWall& wall);

  /// Judges the columns around vertices that have moved.
  void judge_around(const Indices& moved);

  std::size_t size() const { return columns_.size(); }
  /// The vertices of their bases. Sorted.
  Indices corners() const;

 private:
  template <class Column>
  void judge(std::size_t count, Column&& column);

  const LayerWall& wall_;
  std::vector<std::uint8_t> is_invalid_;  // of each column
  Indices columns_;                       // sorted
};

}  // namespace vdb_offset
