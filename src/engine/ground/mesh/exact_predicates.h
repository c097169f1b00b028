// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "vdb_offset/numbers.h"

// Questions that rounding must not answer: CGAL's kernel decides them exactly.
namespace vdb_offset {

/// Which side of the line from a to b point c lies on: 1 left, -1 right, 0 on it.
int side_of(const Vec2d& a, const Vec2d& b, const Vec2d& c);

/// Where d lies of the circle through a, b and c, which run counter-clockwise: 1 inside, -1 outside, 0 on it.
int side_of_circle(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d);

/// Which side of a triangle's plane a point lies on: 1 where its corners run counter-clockwise, -1 behind, 0 on it.
int side_of_plane(const std::array<Vec3d, 3>& triangle, const Vec3d& point);

bool has_no_area(const std::array<Vec3d, 3>& triangle);

// \pre triangles have an area
bool triangles_meet(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b);
bool segment_meets_triangle(const Vec3d& from, const Vec3d& to, const std::array<Vec3d, 3>& triangle);
/// Whether two triangles that share their first two corners lie on each other: in one plane, on one side of these.
bool lie_on_each_other(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b);

}  // namespace vdb_offset
