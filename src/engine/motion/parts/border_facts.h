// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "space/surface/border_planes.h"
#include "space/surface/surface.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Counts the vertices of borders, and of planes, that leave them.
/// \param displacement of each vertex of the surface
/// \param excepted of each vertex: 1 if it leaves the plane across the border for other reasons; empty: none does
BorderFacts border_facts(const Surface& surface, std::span<const Vec3d> displacement,
                         std::span<const std::uint8_t> excepted);

}  // namespace vdb_offset
