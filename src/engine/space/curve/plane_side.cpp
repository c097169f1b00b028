// SPDX-License-Identifier: Apache-2.0
// Compiled with -frounding-math, which CGAL's interval arithmetic needs.
#include "space/curve/plane_side.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>

namespace vdb_offset {

int side_of(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  // If the determinant is larger than its rounding error, its sign is right (kRounding: Shewchuk, Adaptive Precision
  // Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997; kUnderflow: below, products may have lost
  // digits). Else CGAL decides exactly, which is slower.
  constexpr double kRounding = (3 + 16 * 0x1p-53) * 0x1p-53, kUnderflow = 1e-280;
  const double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), difference = left - right,
               sum = std::abs(left) + std::abs(right);
  if (sum > kUnderflow && std::abs(difference) > kRounding * sum) return difference > 0 ? 1 : -1;
  using Point2 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  return CGAL::orientation(Point2(a[0], a[1]), Point2(b[0], b[1]), Point2(c[0], c[1]));
}

}  // namespace vdb_offset
