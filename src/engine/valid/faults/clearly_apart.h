// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ground/numbers/box_tree.h"
#include "space/surface/surface.h"

// What finds most pairs of triangles that are apart, in doubles and beyond all doubt: no more than rounding is left to
// exact predicates.

namespace vdb_offset {

// Share of the product of lengths by which rounding may change a dot product. Reasoned: differences of coordinates are
// exact to 2^-53 of themselves; a dot product of three with a cross product, or with a sum of such differences, is off
// by far less than this.
inline constexpr double kCrossingRounding = 1e-14;

/// A number that is no less than a vector's length, and found faster.
inline double no_shorter(const Vec3d& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); }

/// The planes through the edges of a triangle at right angles to its own: they separate it from what lies beside it.
class EdgePlanes {
 public:
  explicit EdgePlanes(const std::array<Vec3d, 3>& triangle) {
    const Vec3d ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0], normal = ab.cross(ac);
    const double size = kCrossingRounding * no_shorter(ab) * no_shorter(ac);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge = triangle[(k + 1) % 3] - triangle[k];
      edges_[k] = {triangle[k], edge.cross(normal), kGenerous * size * no_shorter(edge)};
    }
  }

  /// Whether points, clearly and all of them, lie beyond one of the edges.
  bool miss(const std::array<Vec3d, 3>& points) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
      return std::all_of(points.begin(), points.end(), [&](const Vec3d& x) {
        const Vec3d to = x - edge.point;
        return edge.outward.dot(to) > edge.size * no_shorter(to);
      });
    });
  }
  /// The same of a box, in coordinates relative to `origin`.
  bool miss(const FloatBox& box, const Vec3d& origin) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
      double least = 0, farthest = 0;  // how far out a corner of the box is, and how far from the edge's point one is
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double lower = origin[k] + static_cast<double>(box.lower[i]) - edge.point[k],
                     upper = origin[k] + static_cast<double>(box.upper[i]) - edge.point[k];
        least += edge.outward[k] * (edge.outward[k] > 0 ? lower : upper);
        farthest += std::max(std::abs(lower), std::abs(upper));
      }
      return least > edge.size * (farthest + no_shorter(origin));
    });
  }

 private:
  static constexpr double kGenerous = 16;  // times what rounding may do: nothing is lost where this is too much
  struct Edge {
    Vec3d point, outward;
    double size;
  };
  std::array<Edge, 3> edges_;
};

/// A triangle's plane, which separates most of the triangles that do not meet it.
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

/// Two triangles to be tested, the corners that they share first.
struct TestedPair {
  std::array<Vec3d, 3> a, b;
  int shared = 0;

  /// Two triangles of a surface, with their vertices at positions that may be others for each. They share a corner only
  /// if both have it at the same position.
  TestedPair(const Surface& surface, std::span<const Vec3d> positions_of_a, std::uint32_t s,
             std::span<const Vec3d> positions_of_b, std::uint32_t t) {
    std::array<std::uint32_t, 3> of_a = surface.triangles[s], of_b = surface.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto n = static_cast<std::size_t>(shared);
      const auto found = std::find(of_b.begin() + shared, of_b.end(), of_a[i]);
      if (found == of_b.end() || positions_of_a[of_a[i]] != positions_of_b[*found]) continue;
      std::swap(*found, of_b[n]);
      std::swap(of_a[i], of_a[n]);
      ++shared;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = positions_of_a[of_a[k]];
      b[k] = positions_of_b[of_b[k]];
    }
  }

  /// Two triangles that share the corners that both have at the same position.
  TestedPair(const std::array<Vec3d, 3>& first, const std::array<Vec3d, 3>& second) : a(first), b(second) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto n = static_cast<std::size_t>(shared);
      const auto found = std::find(b.begin() + shared, b.end(), a[i]);
      if (found == b.end()) continue;
      std::swap(*found, b[n]);
      std::swap(a[i], a[n]);
      ++shared;
    }
  }
};

/// True if a triangle, with no corner in the plane, lies clearly on one side of it.
inline bool misses(const TrianglePlane& plane, const std::array<Vec3d, 3>& triangle) {
  const int side = plane.side(triangle[0]);
  return side != 0 && plane.side(triangle[1]) == side && plane.side(triangle[2]) == side;
}

/// True if the corners of a triangle after those that are shared lie clearly on one side of the plane of the other.
inline bool on_one_side(const TrianglePlane& plane, const std::array<Vec3d, 3>& b, int shared) {
  int sum = 0;
  for (auto k = static_cast<std::size_t>(shared); k < 3; ++k) sum += plane.side(b[k]);
  return std::abs(sum) == 3 - shared;
}

/// True if the triangles, which share their first corner, clearly lie to either side of a plane through it: one at
/// right angles to the difference of the directions that they lie in.
inline bool on_either_side(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
  const std::array<Vec3d, 4> edge = {a[1] - a[0], a[2] - a[0], b[1] - b[0], b[2] - b[0]};
  Vec3d w(0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const double length = edge[i].length();
    if (!(length > 0)) return false;
    w += edge[i] * ((i < 2 ? 1 : -1) / length);
  }
  const double margin = kCrossingRounding * w.length();
  for (std::size_t i = 0; i < 4; ++i)
    if (!((i < 2 ? 1 : -1) * w.dot(edge[i]) > margin * edge[i].length())) return false;
  return true;
}

}  // namespace vdb_offset
