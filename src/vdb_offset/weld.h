#pragma once

#include <cstdint>

#include "vdb_offset/surface.h"

namespace vdb_offset {

/// \throw InvalidInput for polygons that are none: without a face, with fewer corners than that in one, with indices
/// out of range, coordinates that are not finite, or too many corners
void require_usable(PolygonView polygons, std::uint32_t least_corners = 3);

/// Gives the surface its vertices: one for each place that faces use, and for each vertex of the input the one that it
/// is part of. \throw InvalidInput for a tolerance that cannot be used
void weld(PolygonView polygons, const WeldOptions& options, Surface& surface);

}  // namespace vdb_offset
