// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Refuses distances that cannot be heights of layers. \throw InvalidInput unless these can be the heights of layers
/// over so many vertices, as grow_layers() has it. \pre each is uniform or has one for each vertex
void require_heights(std::span<const Distances> heights, std::size_t vertices);

/// \throw InvalidInput unless an angle can be that of fans, in degrees: 0, for none, or 5 .. 180
void require_fan_angle(double angle);

/// Distances of vertices as those of their copies. \param origin of each copy: its vertex
std::vector<Distances> copied_to(std::span<const Distances> distances, std::span<const std::uint32_t> origin);

}  // namespace vdb_offset
