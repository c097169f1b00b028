// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "products/fill/front.h"

namespace vdb_offset {

/// Pairs of triangles that meet elsewhere than in points and edges that they share, by their indices.
std::vector<std::pair<std::uint32_t, std::uint32_t>> crossings_of(std::span<const Vec3d> points,
                                                                  std::span<const FrontTriangle> front);

/// Edges of the front without a triangle that runs the other way, as such a one would have them: with what is to be
/// filled on the left, seen from outside of it. Sorted.
std::vector<std::array<std::uint32_t, 2>> open_edges(std::span<const FrontTriangle> front);

/// Six times the signed volume inside of the front: above 0 where its triangles are ccw seen from outside of it.
double six_volumes_inside(std::span<const Vec3d> points, std::span<const FrontTriangle> front);

/// Whether the front encloses what is to be filled: the one of its shells with the largest volume does. Else that is
/// around all of it.
bool is_enclosed(std::span<const Vec3d> points, std::span<const FrontTriangle> front);

/// \throw FillFailed for a triangle without an area, and for the first two that cross, with their place
void require_sound(std::span<const Vec3d> points, std::span<const FrontTriangle> front);

}  // namespace vdb_offset
