#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Splits one polygon into `size - 2` triangles over its own corners, appended to `triangles` as vertex indices
/// in the polygon's own direction. A polygon whose fan around the first corner turns one way is split into that
/// fan; a concave one by clipping ears in the plane of its area vector, so that the triangles cover the polygon
/// and nothing else. A polygon that crosses itself gets triangles too; they then overlap. Cost: O(corners) for a
/// fan, O(corners^2) for ears.
void triangulate(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace vdb_offset
