// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "vdb_offset/polygons.h"

namespace vdb_offset::test {

/// The letter C, extruded: an arc of three quarters between the radii 2 and 3, of so many segments, from z = 0 to z
/// = 1. Its ends are one concave polygon each.
Polygons letter_c(std::uint32_t segments);

/// A solid ring of quads: a closed polygon of points (r, z), counter-clockwise as r goes to the right and z up, turned
/// about the z axis in so many steps.
Polygons lathe(std::span<const std::array<double, 2>> profile, std::uint32_t segments);

/// An open strip along z, of triangles from end to end: across it, x = depth |y / half width|^power.
Polygons nose_strip(double depth, double half_width, double power, double length, std::uint32_t segments);

/// A tube with an L for its section, open at both ends: both arms are 2 long and 1 wide, in so many quads a unit; four
/// quads deep.
Polygons l_tube(int segments);

}  // namespace vdb_offset::test
