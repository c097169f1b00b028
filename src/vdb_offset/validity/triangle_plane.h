// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "vdb_offset/base/box_tree.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

// Share of the product of lengths by which rounding may change a dot product. Reasoned: differences of coordinates are
// exact to 2^-53 of themselves; a dot product of three with a cross product, or with a sum of such differences, is off
// by far less than this.
inline constexpr double kCrossingRounding = 1e-14;

/// A number that is no less than a vector's length, and found faster.
inline double no_shorter(const Vec3d& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); }

/// A triangle's plane, which tells most of the triangles that do not meet it.
class TrianglePlane {
 public:
  TrianglePlane() = default;
  explicit TrianglePlane(const std::array<Vec3d, 3>& triangle) : point_(triangle[0]) {
    const Vec3d ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0];
    normal_ = ab.cross(ac);
    size_ = kCrossingRounding * no_shorter(ab) * no_shorter(ac);
  }

  /// 1 for a point that is clearly above the plane, -1 for one that is clearly below, 0 for all others.
  int side(const Vec3d& x) const {
    const Vec3d to = x - point_;
    const double height = normal_.dot(to), margin = size_ * no_shorter(to);
    return static_cast<int>(height > margin) - static_cast<int>(height < -margin);
  }

  /// Whether a box, in coordinates relative to `origin`, lies clearly on one side of the plane.
  bool misses(const FloatBox& box, const Vec3d& origin) const {
    Vec3d half, to;  // of the box, and from the plane to its middle
    double reach = 0;
    for (int k = 0; k < 3; ++k) {
      const double lower = box.lower[static_cast<std::size_t>(k)], upper = box.upper[static_cast<std::size_t>(k)];
      half[k] = 0.5 * (upper - lower);
      to[k] = 0.5 * (lower + upper) + origin[k] - point_[k];
      reach += std::abs(normal_[k]) * half[k];
    }
    constexpr double kGenerous = 16;  // times what rounding may do: nothing is lost where this is too much
    return std::abs(normal_.dot(to)) >
           reach + kGenerous * size_ * (no_shorter(to) + no_shorter(half) + no_shorter(origin));
  }

  /// True if the triangle clearly has an area.
  bool is_clear() const { return std::max({std::abs(normal_[0]), std::abs(normal_[1]), std::abs(normal_[2])}) > size_; }

 private:
  Vec3d point_{0.0}, normal_{0.0};
  double size_ = 0;
};

}  // namespace vdb_offset
