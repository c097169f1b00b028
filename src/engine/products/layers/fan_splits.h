// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "products/layers/column_cells.h"

namespace vdb_offset {

/// Finds the sides of columns that are split in the first layer because a fan ends in a point beside them: its last
/// columns stand on triangles of which two corners share a point of the wall, and the third has one of its own.
/// \param corners of all columns, `begin` of each and behind the last
/// \param foot of a corner: what corners with one point of the wall have in common
/// \param flat whether a corner rises in no layer
/// \return of each corner, the side from it to the next; empty if none is split
template <class Foot, class Flat>
std::vector<SideSplit> find_splits(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> begin,
                                   Foot&& foot, Flat&& flat) {
  const auto key = [](std::uint32_t opened, std::uint32_t tip) { return (std::uint64_t{opened} << 32) | tip; };
  std::vector<std::uint64_t> edges;  // from opened corners to tips
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
    if (begin[c + 1] - begin[c] != 3) continue;
    const auto ring = corners.subspan(begin[c], 3);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = ring[k], b = ring[(k + 1) % 3], tip = ring[(k + 2) % 3];
      if (foot(a) != foot(b) || foot(a) == foot(tip) || flat(a) || flat(b) || flat(tip)) continue;
      edges.push_back(key(a, tip));
      edges.push_back(key(b, tip));
    }
  }
  if (edges.empty()) return {};
  std::sort(edges.begin(), edges.end());
  const auto has = [&](std::uint32_t opened, std::uint32_t tip) {
    return std::binary_search(edges.begin(), edges.end(), key(opened, tip));
  };
  std::vector<SideSplit> splits(corners.size(), SideSplit::None);
  for (std::size_t c = 0; c + 1 < begin.size(); ++c)
    for (std::uint32_t i = begin[c]; i < begin[c + 1]; ++i) {
      const std::uint32_t here = corners[i], next = corners[i + 1 < begin[c + 1] ? i + 1 : begin[c]];
      splits[i] = has(here, next) ? SideSplit::UpToNext : has(next, here) ? SideSplit::DownToNext : SideSplit::None;
    }
  return splits;
}

}  // namespace vdb_offset
