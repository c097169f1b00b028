// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "space/query/closest_query.h"

namespace vdb_offset {

/// A ray from a point of the surface.
struct RidgeRay {
  Vec3d origin, direction;  ///< In the surface's frame; the direction is of unit length.
  double distance;          ///< Where it is to end: world units, above 0.
};

struct RidgeRayEnd {
  double length;
  bool is_there;  ///< It ends at the distance; else where the distance grows no more, or at the limit of its length.
};

/// The first point of each ray at its distance from the surface: in steps that are as long as the distance has to grow
/// by, and so never pass it, phi being 1-Lipschitz, nor cross the surface.
/// \param longest in distances
std::vector<RidgeRayEnd> ray_ends(const ClosestQuery& query, std::span<const RidgeRay> rays, double longest);

}  // namespace vdb_offset
