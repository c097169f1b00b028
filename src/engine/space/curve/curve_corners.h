// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "space/curve/polyline.h"

namespace vdb_offset {

/// Marks the vertices at which curves have corners: 1 of each of those, 0 of the others. What creases are to a surface
/// (see space/surface/creases.h); no vertex is one where more than two segments meet.
std::vector<std::uint8_t> vertices_on_creases(const Polyline& line);

}  // namespace vdb_offset
