// SPDX-License-Identifier: Apache-2.0
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

/// Whether the height of a triangle is below 1e-12 of its longest edge. Rounding decides its normal then, and its edges
/// are taken instead, with an error of that height. Takes |ab x ac|^2 and the longest edge's squared length.
inline bool is_needle(double normal_squared, double longest_squared) {
  return !(normal_squared > 1e-24 * longest_squared * longest_squared);
}

namespace detail {

/// Plain components: openvdb's vector operators copy their operands, which costs more than the arithmetic here.
struct Components {
  double x, y, z;
  static Components of(const Vec3d& v) { return {v[0], v[1], v[2]}; }
  double dot(const Components& o) const { return x * o.x + y * o.y + z * o.z; }
  Components cross(const Components& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};
inline Components operator-(const Components& a, const Components& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

inline TrianglePoint at_corner(const Vec3d& corner, const Components& to_x, Feature vertex) {
  return {corner, to_x.dot(to_x), vertex};
}

/// The point `share` of the way along an edge that starts at `from`.
inline TrianglePoint on_edge(const Vec3d& from, const Components& edge, const Components& to_x, double share,
                             Feature feature) {
  const Components along{edge.x * share, edge.y * share, edge.z * share}, rest = to_x - along;
  return {Vec3d(from[0] + along.x, from[1] + along.y, from[2] + along.z), rest.dot(rest), feature};
}

/// `ab` and `ax` lead from a to b and x, `bx` from b to x.
inline TrianglePoint closest_on_segment(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Components& ab,
                                        const Components& ax, const Components& bx, Feature at_a, Feature at_b,
                                        Feature between) {
  const double length2 = ab.dot(ab), along = ax.dot(ab);
  if (along <= 0 || length2 <= 0) return at_corner(a, ax, at_a);
  if (along >= length2) return at_corner(b, bx, at_b);
  const double share = along / length2;
  const Vec3d p(a[0] + ab.x * share, a[1] + ab.y * share, a[2] + ab.z * share);
  const Components px = Components::of(x) - Components::of(p);
  return {p, px.dot(px), between};
}

inline TrianglePoint closest_on_segment(const Vec3d& x, const Vec3d& a, const Vec3d& b, Feature at_a, Feature at_b,
                                        Feature between) {
  const Components to_x = Components::of(x), from_a = Components::of(a), from_b = Components::of(b);
  return closest_on_segment(x, a, b, from_b - from_a, to_x - from_a, to_x - from_b, at_a, at_b, between);
}

/// The closest point of a sliver. Sub-areas are computed from cross products at the nearest corner, and the distance
/// from the plane, which loses fewer digits than the general form. A triangle without area is the union of its edges.
inline TrianglePoint closest_on_sliver(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using enum Feature;
  const Components to_x = Components::of(x), from_a = Components::of(a), from_b = Components::of(b),
                   from_c = Components::of(c), ab = from_b - from_a, bc = from_c - from_b, ca = from_a - from_c,
                   ax = to_x - from_a, bx = to_x - from_b, cx = to_x - from_c, normal = ab.cross(from_c - from_a);
  const double area2 = normal.dot(normal);
  const bool needle = is_needle(area2, std::max(std::max(ab.dot(ab), bc.dot(bc)), ca.dot(ca)));
  const bool beyond_ab = needle || normal.dot(ab.cross(ax)) <= 0, beyond_bc = needle || normal.dot(bc.cross(bx)) <= 0,
             beyond_ca = needle || normal.dot(ca.cross(cx)) <= 0;
  if (!beyond_ab && !beyond_bc && !beyond_ca) {
    const double height = ax.dot(normal), share = height / area2;
    return {Vec3d(x[0] - normal.x * share, x[1] - normal.y * share, x[2] - normal.z * share), height * height / area2,
            Face};
  }
  TrianglePoint best{a, std::numeric_limits<double>::infinity(), Vertex0};
  const auto look_at = [&](const TrianglePoint& other) {
    if (other.squared_distance < best.squared_distance) best = other;
  };
  if (beyond_ab) best = closest_on_segment(x, a, b, ab, ax, bx, Vertex0, Vertex1, Edge0);
  if (beyond_bc) look_at(closest_on_segment(x, b, c, bc, bx, cx, Vertex1, Vertex2, Edge1));
  if (beyond_ca) look_at(closest_on_segment(x, c, a, ca, cx, ax, Vertex2, Vertex0, Edge2));
  return best;
}

}  // namespace detail

/// Closest point of triangle abc to x, by the Voronoi regions of its features (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.5).
inline TrianglePoint closest_on_triangle(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using enum Feature;
  using detail::Components, detail::on_edge, detail::at_corner;
  const Components from_a = Components::of(a), ab = Components::of(b) - from_a, ac = Components::of(c) - from_a,
                   ax = Components::of(x) - from_a;
  const double ab_ab = ab.dot(ab), ac_ac = ac.dot(ac), ab_ac = ab.dot(ac);
  // Sine of the angle (height over length) below which a triangle is a sliver. Sub-areas from products of projections
  // lose digits as the square of length over height: 12 of 16 at this bound. Not measured beside other bounds.
  constexpr double kSliver = 1e-6;
  const double longest = std::max(std::max(ab_ab, ac_ac), ab_ab + ac_ac - 2 * ab_ac);
  if (!(ab_ab * ac_ac - ab_ac * ab_ac > kSliver * longest * longest)) return detail::closest_on_sliver(x, a, b, c);

  const double at_a_b = ab.dot(ax), at_a_c = ac.dot(ax);  // projections on ab and ac, from each corner
  if (at_a_b <= 0 && at_a_c <= 0) return at_corner(a, ax, Vertex0);
  const double at_b_b = at_a_b - ab_ab, at_b_c = at_a_c - ab_ac;
  if (at_b_b >= 0 && at_b_c <= at_b_b) return at_corner(b, ax - ab, Vertex1);
  const double at_c_b = at_a_b - ab_ac, at_c_c = at_a_c - ac_ac;
  if (at_c_c >= 0 && at_c_b <= at_c_c) return at_corner(c, ax - ac, Vertex2);

  const double over_ab = at_a_b * at_b_c - at_b_b * at_a_c;
  if (over_ab <= 0 && at_a_b >= 0 && at_b_b <= 0) return on_edge(a, ab, ax, at_a_b / ab_ab, Edge0);
  const double over_ca = at_c_b * at_a_c - at_a_b * at_c_c;
  if (over_ca <= 0 && at_a_c >= 0 && at_c_c <= 0) return on_edge(a, ac, ax, at_a_c / ac_ac, Edge2);
  const double over_bc = at_b_b * at_c_c - at_c_b * at_b_c;
  const double from_b = at_b_c - at_b_b, from_c = at_c_b - at_c_c;
  if (over_bc <= 0 && from_b >= 0 && from_c >= 0)
    return on_edge(b, ac - ab, ax - ab, from_b / (from_b + from_c), Edge1);
  const Components normal = ab.cross(ac);
  const double height = ax.dot(normal), share = height / normal.dot(normal);
  return {Vec3d(x[0] - normal.x * share, x[1] - normal.y * share, x[2] - normal.z * share), height * share, Face};
}

}  // namespace vdb_offset
