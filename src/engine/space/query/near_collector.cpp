// SPDX-License-Identifier: Apache-2.0
// Collects the triangles near balls, and finds with these the closest points of points along paths.
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "ground/system/assert.h"
#include "space/query/closest_search.h"

namespace vdb_offset {

/// For each triangle of a lowest box, seen from a point: a plane that faces the point, with the triangle behind it.
struct ClosestQuery::Planes {
  float normal[3][kLeafSize], distance[kLeafSize];
};

/// Finds near rectangles as near_rectangles() does, and the planes in front of them. The plane is at right angles to
/// the shortest way to the rectangle. To the rim of a rectangle that is longer than it is far away, rounding would make
/// it too inexact: such a rectangle's own plane is taken.
unsigned ClosestQuery::planes_before(const Rectangles& some, const float* local, float limit, Planes& planes) {
  constexpr float kTiny = 1e-30f;  // least divisor: avoids a division by zero, and is far below any distance
  unsigned near = 0;
  for (int i = 0; i < kLeafSize; i += kLanes) {
    const RectangleView view = view_rectangles(some, i, local);
    const unsigned found = lane_bits(view.squared <= limit + Lanes{});
    if (found == 0) continue;
    near |= found << i;
    const Lanes distance = sqrt_lanes(view.squared), one = Lanes{} + 1.0f;
    const IntLanes before_rim = load_lanes(some.half_length + i) + load_lanes(some.half_width + i) <= distance;
    const Lanes each = one / max_lanes(distance, Lanes{} + kTiny),
                side = view.beyond_side / max_lanes(view.across, Lanes{} + kTiny),
                end = (view.along < Lanes{} ? -view.beyond_end : view.beyond_end) - side * view.along,
                up = view.height < Lanes{} ? -one : one;
    const Lanes along_normal = before_rim ? view.height * (one - side) * each : up,
                along_edge = before_rim ? end * each : Lanes{}, along_way = before_rim ? side * each : Lanes{};
    for (int k = 0; k < 3; ++k)
      store_lanes(planes.normal[k] + i,
                  view.normal[k] * along_normal + view.edge[k] * along_edge + view.away[k] * along_way);
    store_lanes(planes.distance + i, before_rim ? distance : view.height * up);
  }
  return near;
}

/// Collects the triangles near one ball after the other.
class ClosestQuery::Collector {
 public:
  Collector(const ClosestQuery& query, std::span<const Ball> balls,
            const std::function<void(std::size_t, NearTriangles&)>& take)
      : query_(query), balls_(balls), take_(take) {}

  /// Collects for balls first .. last - 1. Where these are not close together, each half is taken by itself.
  void collect(std::size_t first, std::size_t last) {
    Blocks blocks;
    const std::size_t count = query_.find_blocks(balls_.subspan(first, last - first), blocks);
    if (count > kMostBlocks && last - first > 1) {
      collect(first, (first + last) / 2);
      return collect((first + last) / 2, last);
    }
    for (std::size_t i = first; i < last; ++i) {
      begin(balls_[i]);
      if (count > kMostBlocks) descend();
      else
        for (std::size_t k = 0; k < count; ++k) open(0, blocks[k], [](std::size_t, std::uint32_t) {});
      take_(i, near_);
    }
  }

 private:
  void begin(const Ball& ball) {
    for (int k = 0; k < 3; ++k) local_[k] = static_cast<float>(ball.centre[k] * query_.scale_);
    rounding_ = query_.slack_ + 4e-7f * std::max({std::abs(local_[0]), std::abs(local_[1]), std::abs(local_[2])});
    const auto radius = static_cast<float>(ball.radius * query_.scale_), reach = (radius + rounding_) * 1.000001f;
    limit_ = reach * reach;
    // The radius is the unit of what is collected, and so must not be zero, or so small that rounding decides.
    unit_ = std::max({radius, rounding_, std::numeric_limits<float>::min()});
    near_.begin(ball.centre, static_cast<double>(unit_) / query_.scale_);
  }

  void descend() {
    std::array<std::pair<std::size_t, std::uint32_t>, kWidth * 12> stack;  // level and node
    std::size_t depth = 0;
    stack[depth++] = {query_.tree_.levels().size() - 1, 0};
    while (depth > 0) {
      const auto [level, node] = stack[--depth];
      open(level, node, [&](std::size_t below, std::uint32_t child) { stack[depth++] = {below, child}; });
    }
  }

  /// Looks at the children of a node near the ball: into lowest boxes itself, and hands on all others.
  template <class HandOn>
  void open(std::size_t level, std::uint32_t node, HandOn&& hand_on) {
    float squared[kWidth];
    for (unsigned near = near_siblings(query_.tree_.levels()[level][node], local_, limit_, squared); near != 0;
         near &= near - 1) {
      const std::uint32_t child = node * kWidth + static_cast<std::uint32_t>(std::countr_zero(near));
      if (level == 0) look_at_triangles(child);
      else hand_on(level - 1, child);
    }
  }

  void look_at_triangles(std::size_t leaf) {
    Planes planes;
    for (unsigned near = planes_before(query_.rectangles_[leaf], local_, limit_, planes); near != 0; near &= near - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(near));
      near_.add(static_cast<std::uint32_t>(leaf * kLeafSize + at),
                {planes.normal[0][at], planes.normal[1][at], planes.normal[2][at]},
                (planes.distance[at] * 0.999999f - rounding_) / unit_);
    }
  }

  const ClosestQuery& query_;
  std::span<const Ball> balls_;
  const std::function<void(std::size_t, NearTriangles&)>& take_;
  NearTriangles near_;
  float local_[3], rounding_ = 0, limit_ = 0, unit_ = 1;
};

void ClosestQuery::collect_together(std::span<const Ball> balls,
                                    const std::function<void(std::size_t, NearTriangles&)>& take) const {
  if (!balls.empty()) Collector(*this, balls, take).collect(0, balls.size());
}

/// Points on paths that lead away from the surface. The closest points of a path's points are looked for together.
class ClosestQuery::AlongPaths {
 public:
  AlongPaths(const ClosestQuery& query, std::span<const Vec3d> points, std::span<const std::size_t> begin,
             std::span<const std::uint32_t> hints, std::span<Closest> answers)
      : query_(query), points_(points), answers_(answers), walked_(points.size()) {
    for (std::size_t path = 0; path + 1 < begin.size(); ++path) add_path(begin[path], begin[path + 1], hints);
  }

  void answer() const {
    query_.collect_together(balls_, [&](std::size_t i, const NearTriangles& near) {
      for (std::size_t p = runs_[i].first; p < runs_[i].second; ++p) choose(p, near);
    });
  }

 private:
  /// Adds the balls for the points of a path. The ball around a point that reaches to the triangle found by walking
  /// holds whatever is nearer. If the ball around the farthest point that holds all the others is hardly larger than
  /// its own, it serves for all points.
  void add_path(std::size_t first, std::size_t last, std::span<const std::uint32_t> hints) {
    constexpr double kHardlyLarger = 1.05;  // share of radii; a larger ball holds more triangles; not measured
    std::size_t farthest = first;
    for (std::size_t p = first; p < last; ++p) {
      std::uint32_t triangle = hints[p];
      const TrianglePoint walked = query_.surface_.walk_to_closest(points_[p], triangle);
      walked_[p] = {std::sqrt(walked.squared_distance), triangle, walked.feature, false, walked.point};
      if (walked_[p].distance > walked_[farthest].distance) farthest = p;
    }
    const Vec3d& centre = points_[farthest];
    double radius = 0;
    for (std::size_t p = first; p < last; ++p)
      radius = std::max(radius, (points_[p] - centre).length() + walked_[p].distance);
    if (radius <= kHardlyLarger * walked_[farthest].distance) {
      add_ball(first, last, {centre, radius});
      return;
    }
    for (std::size_t p = first; p < last; ++p) add_ball(p, p + 1, {points_[p], walked_[p].distance});
  }

  void add_ball(std::size_t first, std::size_t last, const Ball& ball) {
    balls_.push_back(ball);
    runs_.emplace_back(first, last);
  }

  void choose(std::size_t p, const NearTriangles& near) const {
    Closest best = walked_[p];
    near.visit_nearer(points_[p], best.distance, [&](std::size_t i) {
      const std::uint32_t triangle = near.triangle(i);
      if (triangle == best.triangle) return best.distance;
      const TrianglePoint candidate = query_.surface_.closest_on(triangle, points_[p]);
      if (candidate.squared_distance < best.distance * best.distance)
        best = {std::sqrt(candidate.squared_distance), triangle, candidate.feature, false, candidate.point};
      return best.distance;
    });
    answers_[p] = best;
  }

  const ClosestQuery& query_;
  std::span<const Vec3d> points_;
  std::span<Closest> answers_;
  std::vector<Closest> walked_;  // of each point: the closest point found by walking from its hint
  std::vector<Ball> balls_;
  std::vector<std::pair<std::size_t, std::size_t>> runs_;  // the points, first .. last - 1, that each ball serves
};

void ClosestQuery::answer_along_paths(std::span<const Vec3d> points, std::span<const std::size_t> begin,
                                      std::span<const std::uint32_t> hints, std::span<Closest> answers) const {
  VDB_OFFSET_ASSERT(hints.size() == points.size() && answers.size() == points.size());
  VDB_OFFSET_ASSERT(begin.empty() || begin.back() == points.size());
  AlongPaths(*this, points, begin, hints, answers).answer();
}

}  // namespace vdb_offset
