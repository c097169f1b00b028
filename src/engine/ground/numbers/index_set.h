// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "ground/system/assert.h"

namespace vdb_offset {

/// Indices of vertices or triangles: sorted, no two the same.
using Indices = std::vector<std::uint32_t>;

/// Whether indices are sorted, no two the same.
inline bool is_sorted_unique(std::span<const std::uint32_t> indices) {
  return std::adjacent_find(indices.begin(), indices.end(), std::greater_equal<>()) == indices.end();
}

/// Whether indices are sorted, no two the same, and below `count`.
inline bool is_index_set(std::span<const std::uint32_t> indices, std::size_t count) {
  return is_sorted_unique(indices) && (indices.empty() || indices.back() < count);
}

inline void sort_unique(Indices& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

/// Gathers indices that come many times over, as corners of neighbouring triangles do. Each index is marked when it
/// comes first, so that repeated ones are left out without sorting.
class IndexGatherer {
 public:
  /// A set for indices below `count`.
  explicit IndexGatherer(std::size_t count) : has_(count, 0) {}

  void add(std::uint32_t i) {
    VDB_OFFSET_ASSERT(i < has_.size());
    if (has_[i]) return;
    has_[i] = 1;
    gathered_.push_back(i);
  }
  /// The indices so far, in the order in which they came; add() makes it grow.
  const std::vector<std::uint32_t>& so_far() const { return gathered_; }
  /// Hands the indices over, sorted, and begins anew.
  Indices take() {
    for (const auto i : gathered_) has_[i] = 0;
    std::sort(gathered_.begin(), gathered_.end());
    return std::exchange(gathered_, {});
  }

 private:
  std::vector<std::uint8_t> has_;
  std::vector<std::uint32_t> gathered_;
};

}  // namespace vdb_offset
