#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The part of a triangle that a closest point lies on. Edge k joins corners k and k + 1 (mod 3).
enum class Feature : std::uint8_t { Vertex0, Vertex1, Vertex2, Edge0, Edge1, Edge2, Face };

struct TrianglePoint {
  Vec3d point;
  double squared_distance;
  Feature feature;
};

/// True of a triangle whose height is below 1e-12 of its longest edge: rounding decides its normal then, and its
/// edges stand for it with an error of that height. Takes |ab x ac|^2 and the longest edge's squared length.
inline bool is_needle(double normal_squared, double longest_squared) {
  return !(normal_squared > 1e-24 * longest_squared * longest_squared);
}

namespace detail {

inline TrianglePoint closest_on_segment(const Vec3d& x, const Vec3d& a, const Vec3d& b, Feature at_a, Feature at_b,
                                        Feature between) {
  const Vec3d ab = b - a;
  const double length2 = ab.dot(ab), along = (x - a).dot(ab);
  if (along <= 0 || length2 <= 0) return {a, (x - a).lengthSqr(), at_a};
  if (along >= length2) return {b, (x - b).lengthSqr(), at_b};
  const Vec3d p = a + ab * (along / length2);
  return {p, (x - p).lengthSqr(), between};
}

inline TrianglePoint closest_on_edges(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using enum Feature;
  TrianglePoint best = closest_on_segment(x, a, b, Vertex0, Vertex1, Edge0);
  for (const TrianglePoint& other :
       {closest_on_segment(x, b, c, Vertex1, Vertex2, Edge1), closest_on_segment(x, c, a, Vertex2, Vertex0, Edge2)})
    if (other.squared_distance < best.squared_distance) best = other;
  return best;
}

}  // namespace detail

/// Closest point of triangle abc to x, by the Voronoi regions of its features (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.5). A triangle without area is the union of its edges.
inline TrianglePoint closest_on_triangle(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using enum Feature;
  const Vec3d ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return {a, ax.lengthSqr(), Vertex0};
  const Vec3d bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return {b, bx.lengthSqr(), Vertex1};
  const Vec3d cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return {c, cx.lengthSqr(), Vertex2};

  // The normal form of the face region loses no digits where the barycentric form divides two small numbers:
  // the sub-areas come from cross products at the nearest corner, the distance from the plane.
  const Vec3d normal = ab.cross(ac);
  const double area2 = normal.dot(normal);
  if (is_needle(area2, std::max({ab.dot(ab), ac.dot(ac), (c - b).dot(c - b)})))
    return detail::closest_on_edges(x, a, b, c);
  const double over_ab = normal.dot(ab.cross(ax)), over_bc = normal.dot((c - b).cross(bx)),
               over_ca = normal.dot((a - c).cross(cx));
  if (over_ab > 0 && over_bc > 0 && over_ca > 0) {
    const double height = ax.dot(normal);
    return {x - normal * (height / area2), height * height / area2, Face};
  }
  return detail::closest_on_edges(x, a, b, c);
}

}  // namespace vdb_offset
