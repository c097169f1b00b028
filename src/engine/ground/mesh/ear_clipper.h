// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdb_offset {

/// Corners above which a polygon is cut by clipping ears whatever its shape, and ears are taken round it in turn: the
/// triangles of a fan of so many corners all have to be held against each other later. Not measured more closely.
inline constexpr std::size_t kLargePolygon = 1000;

struct Point2 {
  double x, y;
};

/// Twice the signed area of a triangle: above 0 if c lies to the left of the line from a to b.
inline double cross(Point2 a, Point2 b, Point2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Cuts a polygon, counter-clockwise, into triangles of its corners' numbers: ears, one after the other on the way
/// round it. A whole round without an ear means that the polygon crosses itself: any corner will do then. Of more than
/// kLargePolygon corners it goes on behind the next one after each ear, so that no corner gets more than a few
/// triangles: those of a fan lie so close that each has to be held against all others to find what meets.
///
/// A corner that is no ear is not looked at again before the corner in its way is gone, or one beside it; corners in
/// the way are found in a tree. Cost: about n log n for n corners. \pre four corners or more
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::vector<Point2> corners);

}  // namespace vdb_offset
