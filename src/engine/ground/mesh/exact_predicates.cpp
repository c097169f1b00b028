// SPDX-License-Identifier: Apache-2.0
// Compiled with -frounding-math, which CGAL's interval arithmetic needs.
#include "ground/mesh/exact_predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

#include <cmath>

namespace vdb_offset {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3d& x) { return {x[0], x[1], x[2]}; }

Kernel::Triangle_3 exact(const std::array<Vec3d, 3>& triangle) {
  return {point(triangle[0]), point(triangle[1]), point(triangle[2])};
}

}  // namespace

int side_of(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  // If the determinant is larger than its rounding error, its sign is right (kRounding: Shewchuk, Adaptive Precision
  // Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997; kUnderflow: below, products may have lost
  // digits). Else CGAL decides exactly, which is slower.
  constexpr double kRounding = (3 + 16 * 0x1p-53) * 0x1p-53, kUnderflow = 1e-280;
  const double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), difference = left - right,
               sum = std::abs(left) + std::abs(right);
  if (sum > kUnderflow && std::abs(difference) > kRounding * sum) return difference > 0 ? 1 : -1;
  using Point2 = Kernel::Point_2;
  return CGAL::orientation(Point2(a[0], a[1]), Point2(b[0], b[1]), Point2(c[0], c[1]));
}

int side_of_circle(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  using Point2 = Kernel::Point_2;
  const Point2 p(a[0], a[1]), q(b[0], b[1]), r(c[0], c[1]), s(d[0], d[1]);
  return CGAL::side_of_oriented_circle(p, q, r, s);
}

int side_of_plane(const std::array<Vec3d, 3>& triangle, const Vec3d& at) {
  return CGAL::orientation(point(triangle[0]), point(triangle[1]), point(triangle[2]), point(at));
}

bool has_no_area(const std::array<Vec3d, 3>& triangle) { return exact(triangle).is_degenerate(); }

bool triangles_meet(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
  return CGAL::do_intersect(exact(a), exact(b));
}

bool segment_meets_triangle(const Vec3d& from, const Vec3d& to, const std::array<Vec3d, 3>& triangle) {
  return CGAL::do_intersect(Kernel::Segment_3(point(from), point(to)), exact(triangle));
}

bool lie_on_each_other(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
  const auto p = point(a[0]), q = point(a[1]), r = point(a[2]), s = point(b[2]);
  return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

}  // namespace vdb_offset
