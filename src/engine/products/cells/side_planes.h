// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A side of a column of cells on the boundary, and the opening of the surface that it belongs to.
struct BoundarySide {
  std::array<std::uint32_t, 2> stacks;  ///< At its two edges.
  std::array<Vec3d, 4> corners;         ///< On the wall, then in the outermost layer: ccw seen from outside.
  std::uint32_t opening;

  /// Out of the cells, twice as long as the area is large.
  Vec3d area() const { return (corners[2] - corners[0]).cross(corners[3] - corners[1]); }
};

/// Parts openings that run over several planes, as that of half a pipe does over its two ends and the plane through its
/// axis: sides in one plane are an opening of their own, also where they are not connected. Openings that are not made
/// of a few planes stay. Openings are numbered in the order of sides. Returns their number.
std::size_t part_by_planes(std::span<BoundarySide> sides);

}  // namespace vdb_offset
