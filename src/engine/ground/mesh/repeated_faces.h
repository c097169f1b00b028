// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vdb_offset {

/// A face with the corners of an earlier one in the same order or in reverse, from whichever it starts.
struct RepeatedFace {
  std::uint32_t face, of;  ///< `of` is the first such face.
  bool is_reversed;
};

/// Finds every face that repeats an earlier one, in ascending order. Face f has the corners
/// `corners[begin[f]] .. corners[begin[f + 1] - 1]`. Cost: O(corners), and sorting those that have one smallest corner.
std::vector<RepeatedFace> find_repeated_faces(std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> begin);

}  // namespace vdb_offset
