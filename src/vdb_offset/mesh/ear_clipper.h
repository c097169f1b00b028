#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdb_offset {

inline constexpr std::size_t kLargePolygon = 1000;

struct Point2 {
  double x, y;
};

/// Above 0 if c lies to the left of the way from a to b: twice the triangle's area.
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
