// SPDX-License-Identifier: Apache-2.0
#include "products/layers/invalid_columns.h"

#include <algorithm>

#include "ground/system/parallel.h"

namespace vdb_offset {

InvalidColumns::InvalidColumns(const LayerWall& wall) : wall_(wall), is_invalid_(wall.column_count(), 0) {
  judge(is_invalid_.size(), [](std::size_t c) { return c; });
  for (std::uint32_t c = 0; c < is_invalid_.size(); ++c)
    if (is_invalid_[c]) columns_.push_back(c);
}

/// Judges the columns column(0), column(1) ... column(count - 1), two at a time.
template <class Column>
void InvalidColumns::judge(std::size_t count, Column&& column) {
  for_each_index((count + 1) / 2,
                 [&](std::size_t i) {
                   const std::size_t c = column(2 * i), other = column(std::min(2 * i + 1, count - 1));
                   const auto [valid, other_valid] = wall_.are_valid(c, other);
                   is_invalid_[c] = !valid;
                   is_invalid_[other] = !other_valid;
                 },
                 32);
}

void InvalidColumns::judge_around(const Indices& moved) {
  Indices columns;
  for (const auto v : moved) {
    const auto around = wall_.columns_around(v);
    columns.insert(columns.end(), around.begin(), around.end());
  }
  sort_unique(columns);
  judge(columns.size(), [&](std::size_t i) { return columns[i]; });
  std::erase_if(columns_, [&](std::uint32_t c) { return !is_invalid_[c]; });
  for (const auto c : columns)
    if (is_invalid_[c]) columns_.push_back(c);
  sort_unique(columns_);
}

Indices InvalidColumns::corners() const {
  Indices corners;
  for (const auto c : columns_) corners.insert(corners.end(), wall_.base(c).begin(), wall_.base(c).end());
  sort_unique(corners);
  return corners;
}

}  // namespace vdb_offset
