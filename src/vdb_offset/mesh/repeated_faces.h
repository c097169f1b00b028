// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vdb_offset {

/// Marks every face that repeats an earlier one: the same corners in the same order or in reverse, from whichever it
/// starts. Face f has the corners `corners[begin[f]] .. corners[begin[f + 1] - 1]`. Cost: O(corners), and sorting those
/// that have one smallest corner.
std::vector<std::uint8_t> find_repeated_faces(std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> begin);

}  // namespace vdb_offset
