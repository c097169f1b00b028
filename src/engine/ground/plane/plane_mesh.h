// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A region of the plane.
struct PlaneRegion {
  std::vector<Vec2d> points;
  std::vector<std::array<std::uint32_t, 2>> segments;  ///< All around it: it lies on their left.
  double growth = 1.3;                                 ///< > 1: edges grow by so much from neighbour to neighbour.
  double longest = std::numeric_limits<double>::infinity();  ///< No edge inside is to be longer.
};

struct PlaneMesh {
  std::vector<Vec2d> added;                             ///< Numbered behind the region's points.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Ccw.
};

/// Fills a region with triangles, as round as may be, whose sides are as long as the segments nearby, and grow from
/// there. All segments are kept as they are. The same on any machine. Cost: O(triangles log(triangles)) or so.
/// \throw InvalidInput unless the segments close, and cross neither each other nor points
PlaneMesh mesh_plane(const PlaneRegion& region);

}  // namespace vdb_offset
