// SPDX-License-Identifier: Apache-2.0
#pragma once

// The descent of one exact query through the tree of boxes, for the sources of ClosestQuery.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "ground/numbers/float_lanes.h"
#include "space/query/closest_query.h"

namespace vdb_offset {

/// Tells, as bits, which of eight boxes are no farther from a point than the root of `limit`. Also finds the squared
/// distances of all eight.
inline unsigned ClosestQuery::near_siblings(const BoxTree::Siblings& box, const float* local, float limit,
                                            float* squared) {
  unsigned near = 0;
  for (int i = 0; i < kWidth; i += kLanes) {
    Lanes sum{};
    for (int k = 0; k < 3; ++k) {
      const Lanes below = load_lanes(box.lower[k] + i) - local[k], above = local[k] - load_lanes(box.upper[k] + i);
      const Lanes outside = max_lanes(max_lanes(below, above), Lanes{});
      sum += outside * outside;
    }
    store_lanes(squared + i, sum);
    near |= lane_bits(sum <= limit + Lanes{}) << i;
  }
  return near;
}

/// Where a point is, seen from some rectangles: from their centres along the normal, along the edge and across it; and
/// how far it is beyond their ends and sides.
struct RectangleView {
  Lanes away[3], normal[3], edge[3], height, along, across, beyond_end, beyond_side;
  Lanes squared;  // squared distance, rounded downwards
};

/// The view from rectangles i .. i + kLanes - 1. One millionth is taken off, which is more than rounding adds. For a
/// triangle without a normal, all that is not along its edge counts as across.
template <class Rectangles>
RectangleView view_rectangles(const Rectangles& some, int i, const float* local) {
  RectangleView view{};
  Lanes squared{};
  for (int k = 0; k < 3; ++k) {
    view.away[k] = local[k] - load_lanes(some.centre[k] + i);
    view.normal[k] = load_lanes(some.normal[k] + i);
    view.edge[k] = load_lanes(some.edge[k] + i);
    squared += view.away[k] * view.away[k];
    view.height += view.away[k] * view.normal[k];
    view.along += view.away[k] * view.edge[k];
  }
  const Lanes height2 = view.height * view.height, along2 = view.along * view.along;
  view.across = sqrt_lanes(max_lanes(squared * 0.999999f - (height2 + along2), Lanes{}));
  view.beyond_end = max_lanes(max_lanes(view.along, -view.along) - load_lanes(some.half_length + i), Lanes{});
  view.beyond_side = max_lanes(view.across - load_lanes(some.half_width + i), Lanes{});
  view.squared = (height2 + (view.beyond_end * view.beyond_end + view.beyond_side * view.beyond_side)) * 0.999999f;
  return view;
}

/// Tells, as bits, which triangles of a lowest box may be nearer to a point, in the tree's units, than the root of
/// `limit`. Also finds lower bounds of their squared distances.
inline unsigned ClosestQuery::near_rectangles(const Rectangles& some, const float* local, float limit,
                                              float* least_squared) {
  unsigned near = 0;
  for (int i = 0; i < kLeafSize; i += kLanes) {
    const RectangleView view = view_rectangles(some, i, local);
    store_lanes(least_squared + i, view.squared);
    near |= lane_bits(view.squared <= limit + Lanes{}) << i;
  }
  return near;
}

/// The descent of one query through the tree. The nearest boxes are taken first.
class ClosestQuery::Search {
 public:
  Search(const ClosestQuery& query, const Vec3d& x, std::uint32_t hint) : Search(query, x, hint, {}) {
    best_ = surface_.walk_to_closest(x, triangle_);
    tighten();
  }
  /// Begins with a point of the surface that is known to be near, on a triangle.
  Search(const ClosestQuery& query, const Vec3d& x, std::uint32_t triangle, const TrianglePoint& known)
      : query_(query), surface_(query.surface_), x_(x), triangle_(triangle), best_(known) {
    for (int k = 0; k < 3; ++k) local_[k] = static_cast<float>(x[k] * query.scale_);
    rounding_ = query.slack_ + 4e-7f * std::max({std::abs(local_[0]), std::abs(local_[1]), std::abs(local_[2])});
    tighten();
  }

  /// Finds the closest point in these blocks of lowest boxes. \pre they hold all triangles that may be nearer
  Closest run_through(std::span<const std::uint32_t> blocks) {
    for (const auto block : blocks) open(0, block);
    return {std::sqrt(best_.squared_distance), triangle_, best_.feature, tied_, best_.point};
  }

  Closest run() {
    stack_[depth_++] = {0.0f, static_cast<std::uint32_t>(query_.tree_.levels().size() - 1), 0};
    while (depth_ > 0) {
      const Visit visit = stack_[--depth_];
      if (visit.squared_distance > limit_) continue;
      open(visit.level, visit.node);
    }
    return {std::sqrt(best_.squared_distance), triangle_, best_.feature, tied_, best_.point};
  }

 private:
  /// The siblings `node` of level `level`, and the distance of the box around them.
  struct Visit {
    float squared_distance;
    std::uint32_t level, node;
  };

  /// A box is left out only if it is farther than the best by more than float rounding can hide.
  void tighten() {
    const double distance = std::sqrt(best_.squared_distance), tie = query_.farthest_tie(distance);
    const float reach = (static_cast<float>(distance * query_.scale_) + rounding_) * 1.000001f;
    // Not infinite, as boxes that are unused are that far away.
    limit_ = std::min(reach * reach, std::numeric_limits<float>::max());
    tie_ = tie * tie;
  }

  /// Whether two equally near points differ; a point of an edge or a corner is the same on each triangle there.
  static bool are_apart(const TrianglePoint& a, const TrianglePoint& b) {
    constexpr double kApart = 1e-12;  // squared, by the squared distance: a millionth of it, above what is rounded
    return (a.point - b.point).lengthSqr() > kApart * a.squared_distance;
  }

  void compare(std::uint32_t other) {
    if (other >= surface_.triangles.size()) return;  // an unused lane, which is nearer than what is far beyond all else
    const TrianglePoint candidate = surface_.closest_on(other, x_);
    if (candidate.squared_distance >= best_.squared_distance) {
      tied_ = tied_ || (candidate.squared_distance <= tie_ && are_apart(candidate, best_));
      return;
    }
    const TrianglePoint before = std::exchange(best_, candidate);
    triangle_ = other;
    tighten();
    tied_ = before.squared_distance <= tie_ && (tied_ || are_apart(before, candidate));
  }

  /// Puts the siblings that are near enough on the stack, the nearest last, so that it is taken first; lowest boxes are
  /// looked into at once, as by then the bound is tight and their order matters little.
  void open(std::uint32_t level, std::uint32_t node) {
    float squared[kWidth];
    unsigned near = near_siblings(query_.tree_.levels()[level][node], local_, limit_, squared);
    if (level == 0) {
      for (; near != 0; near &= near - 1) {
        const int child = std::countr_zero(near);
        if (squared[child] <= limit_) look_at_triangles(node * kWidth + static_cast<std::uint32_t>(child));
      }
      return;
    }
    const std::size_t base = depth_;
    for (; near != 0; near &= near - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(near));
      std::size_t at = depth_++;
      for (; at > base && stack_[at - 1].squared_distance < squared[child]; --at) stack_[at] = stack_[at - 1];
      stack_[at] = {squared[child], level - 1, node * kWidth + child};
    }
  }

  void look_at_triangles(std::uint32_t leaf) {
    float squared[kLeafSize];
    for (unsigned near = near_rectangles(query_.rectangles_[leaf], local_, limit_, squared); near != 0;
         near &= near - 1) {
      const int at = std::countr_zero(near);
      if (squared[at] > limit_) continue;
      compare(leaf * kLeafSize + static_cast<std::uint32_t>(at));
    }
  }

  const ClosestQuery& query_;
  const Surface& surface_;
  const Vec3d& x_;
  std::uint32_t triangle_;
  TrianglePoint best_;
  float local_[3];  // x in the tree's units
  float rounding_, limit_ = 0;
  double tie_ = 0;  // squared: a point that is no farther ties with the closest one
  bool tied_ = false;
  std::array<Visit, kWidth * 12> stack_;  // 8^12 leaves are far more than 2^31 triangles
  std::size_t depth_ = 0;
};

}  // namespace vdb_offset
