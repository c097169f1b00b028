// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// Triangles over a part of the unit sphere.
struct RoundPatch {
  std::vector<Vec3d> inner;                             ///< Directions inside of the loop, of unit length.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Of the loop's directions, then the inner ones.
};

/// Covers what a loop of directions goes around: rings towards its middle, with fewer and fewer points.
/// \param loop unit vectors, counter-clockwise for `side` 1 as seen from outside, clockwise for -1
/// \param step the most angle between neighbours on a ring
/// \return nothing if not all of the loop can be seen from its middle
std::optional<RoundPatch> round_patch(std::span<const Vec3d> loop, double step, int side);

}  // namespace vdb_offset
