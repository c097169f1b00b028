// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/clearance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace vdb_offset {
namespace {

// Share of the clearance by which a triangle may be nearer than it should. Reasoned: as exact as distances are
// promised.
constexpr double kKeptClearance = 1e-6;

/// The points where two segments are nearest, as shares of their lengths (Ericson, Real-Time Collision Detection,
/// 2005, 5.1.9).
std::pair<double, double> nearest_shares(const Vec3d& p1, const Vec3d& q1, const Vec3d& p2, const Vec3d& q2) {
  const Vec3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.lengthSqr(), e = d2.lengthSqr(), f = d2.dot(r);
  double s = 0, t = 0;
  if (a > 0 && e > 0) {
    const double c = d1.dot(r), b = d1.dot(d2), denominator = a * e - b * b;
    if (denominator > 0) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    t = (b * s + f) / e;
    if (t < 0) s = std::clamp(-c / a, 0.0, 1.0);
    else if (t > 1) s = std::clamp((b - c) / a, 0.0, 1.0);
    t = std::clamp(t, 0.0, 1.0);
  } else if (a > 0) {
    s = std::clamp(-d1.dot(r) / a, 0.0, 1.0);
  } else if (e > 0) {
    t = std::clamp(f / e, 0.0, 1.0);
  }
  return {s, t};
}

/// The point where a segment runs through a triangle's inside, if it does.
std::optional<Vec3d> piercing(const Vec3d& p, const Vec3d& q, const TriangleCorners& triangle) {
  const Vec3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], n = u.cross(v);
  const double at_p = n.dot(p - triangle[0]), at_q = n.dot(q - triangle[0]);
  if (at_p * at_q > 0 || at_p == at_q) return std::nullopt;
  const Vec3d x = p + (q - p) * (at_p / (at_p - at_q));
  for (std::size_t k = 0; k < 3; ++k)
    if (n.dot((triangle[(k + 1) % 3] - triangle[k]).cross(x - triangle[k])) < 0) return std::nullopt;
  return x;
}

FloatBox box_around(const TriangleCorners& corners) {
  FloatBox box;
  for (const Vec3d& p : corners)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = p[static_cast<int>(k)], rounding = std::abs(x) * 0x1p-22;
      box.lower[k] = std::min(box.lower[k], static_cast<float>(x - rounding));
      box.upper[k] = std::max(box.upper[k], static_cast<float>(x + rounding));
    }
  return box;
}

double squared_box_distance(const FloatBox& a, const FloatBox& b) {
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double apart =
        std::max({0.0, static_cast<double>(a.lower[k]) - b.upper[k], static_cast<double>(b.lower[k]) - a.upper[k]});
    squared += apart * apart;
  }
  return squared;
}

TriangleCorners corners_of(const Surface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return {surface.vertices[a], surface.vertices[b], surface.vertices[c]};
}

}  // namespace

double distance_between(const TriangleCorners& a, const TriangleCorners& b) {
  Vec3d on_a;
  return distance_between(a, b, on_a);
}

double distance_between(const TriangleCorners& a, const TriangleCorners& b, Vec3d& on_a) {
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](double squared, const Vec3d& where) {
    if (!(squared < least)) return;
    least = squared;
    on_a = where;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d &p = a[i], &q = a[(i + 1) % 3];
    for (const auto& x : {piercing(p, q, b), piercing(b[i], b[(i + 1) % 3], a)})
      if (x) take(0, *x);
    take(closest_on_triangle(p, b[0], b[1], b[2]).squared_distance, p);
    const TrianglePoint below = closest_on_triangle(b[i], a[0], a[1], a[2]);
    take(below.squared_distance, below.point);
    for (std::size_t j = 0; j < 3; ++j) {
      const auto [s, t] = nearest_shares(p, q, b[j], b[(j + 1) % 3]);
      const Vec3d x = p + (q - p) * s;
      take((x - b[j] - (b[(j + 1) % 3] - b[j]) * t).lengthSqr(), x);
    }
  }
  return std::sqrt(least);
}

ClearanceFinder::ClearanceFinder(const Obstacles& obstacles) : obstacles_(obstacles) {
  const Surface& surface = obstacles.query.surface();
  tree_.build(surface.triangles.size(), [&](std::size_t t) { return box_around(corners_of(surface, t)); });
}

double ClearanceFinder::gap(const TriangleCorners& triangle, double limit) const {
  Vec3d where;
  return gap(triangle, limit, where);
}

/// Goes down the tree, the nearest boxes first; boxes that are no nearer than the least distance so far are left out.
double ClearanceFinder::gap(const TriangleCorners& triangle, double limit, Vec3d& where) const {
  struct Node {
    std::uint32_t level, node;
    double squared;
  };
  const Surface& surface = obstacles_.query.surface();
  const FloatBox box = box_around(triangle);
  std::array<Node, BoxTree::kWidth * 12> stack;
  std::size_t depth = 0;
  stack[depth++] = {static_cast<std::uint32_t>(tree_.levels().size() - 1), 0, 0};
  double least = limit;
  while (depth > 0) {
    const auto [level, node, squared] = stack[--depth];
    if (!(squared < least * least)) continue;
    const std::size_t first = depth;
    for (int i = 0; i < BoxTree::kWidth; ++i) {
      const double to_child = squared_box_distance(BoxTree::box(tree_.levels()[level][node], i), box);
      const auto child = node * BoxTree::kWidth + static_cast<std::uint32_t>(i);
      if (!(to_child < least * least)) continue;
      if (level > 0) {
        stack[depth++] = {level - 1, child, to_child};
        continue;
      }
      Vec3d at;
      const double distance = distance_between(triangle, corners_of(surface, child), at);
      if (!(distance < least)) continue;
      least = distance;
      where = at;
    }
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.begin() + static_cast<std::ptrdiff_t>(depth),
              [](const Node& a, const Node& b) { return a.squared > b.squared; });
  }
  return least;
}

bool ClearanceFinder::is_crowded(const TriangleCorners& triangle, double bound, double slack) const {
  const double least = bound - obstacles_.clearance * kKeptClearance - slack;
  return least > 0 && gap(triangle, least) < least;
}

Gap measure_gap(const Surface& surface, std::span<const Vec3d> positions, const Obstacles& obstacles, OfEach of_each) {
  const std::size_t count = surface.triangles.size() - obstacles.query.surface().triangles.size();
  const ClearanceFinder finder(obstacles);
  // Without a clearance a triangle that touches has to be told from one that does not, though none is nearer than 0:
  // the limit has to be above 0. Reasoned: far below any gap.
  constexpr double kTouching = 1e-150;
  const double kept = obstacles.clearance * (1 - kKeptClearance), most = std::max(obstacles.clearance, kTouching);
  Gap gap;
  if (of_each == OfEach::Yes) gap.of_each.resize(count);
  std::atomic<double> least = std::numeric_limits<double>::infinity();
  gap.near = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 64), std::size_t{0},
      [&](const auto& range, std::size_t near) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const auto& [a, b, c] = surface.triangles[t];
          const Vec3d& origin = surface.origin;
          const double known = least.load(std::memory_order_relaxed);
          const double found =
              finder.gap({positions[a] - origin, positions[b] - origin, positions[c] - origin}, std::max(known, most));
          near += found < kept || found == 0;
          if (of_each == OfEach::Yes) gap.of_each[t] = std::min(found, obstacles.clearance);
          for (double so_far = known; found < so_far && !least.compare_exchange_weak(so_far, found);) {
          }
        }
        return near;
      },
      std::plus<>());
  gap.least = least;
  return gap;
}

StartingGaps find_starting_gaps(const Surface& surface, std::span<const Vec3d> positions, const Obstacles& obstacles,
                                std::vector<TrianglePair>& meeting) {
  const auto count = static_cast<std::uint32_t>(surface.triangles.size() - obstacles.query.surface().triangles.size());
  const CrossingFinder finder(surface, positions);
  StartingGaps start;
  Gap gap = measure_gap(surface, positions, obstacles, OfEach::Yes);
  start.bound = std::move(gap.of_each);
  start.least = gap.least;
  start.touches.assign(count, 0);
  std::erase_if(meeting, [&](const TrianglePair& pair) {
    if (pair.first >= count) return true;  // obstacles' own
    if (pair.second < count) return false;
    start.touches[pair.first] = 1;
    start.bound[pair.first] = 0;
    ++start.touching;
    const bool crosses = finder.go_through(pair);
    start.crossing += crosses;
    return !crosses;
  });
  if (start.touching > 0) start.least = 0;
  return start;
}

}  // namespace vdb_offset
