// SPDX-License-Identifier: Apache-2.0
// Covers a loop of directions by Delaunay refinement on the sphere (Ruppert, A Delaunay refinement algorithm for
// quality 2-dimensional mesh generation, 1995, without splits of the loop). Triangles around the loop's middle are
// flipped until they are part of the hull of their points; then the one that is deepest inside of the sphere gets a
// point over its centre, or on its longest edge where that is outside of the loop, until none is too deep.
#include "products/arcs/round_patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <queue>
#include <utility>

#include "products/arcs/slerp.h"

namespace vdb_offset {
namespace {

constexpr double kFlatVolume = 1e-12;  // of a volume; reasoned: rounding

class PatchMaker {
 public:
  /// \pre the loop is counter-clockwise, and all of it is seen from the middle
  PatchMaker(std::vector<Vec3d> loop, const Vec3d& middle, double step)
      : points_(std::move(loop)),
        loop_(points_.size()),
        least_height_(std::cos(kRadius * step)),
        most_points_(loop_ + static_cast<std::size_t>(kPointsForEach / (step * step))) {
    if (loop_ == 3) {
      add_triangle({0, 1, 2}, {kNone, kNone, kNone});
      if (height(0) >= least_height_) return;
      triangles_.clear();
      across_.clear();
    }
    points_.push_back(middle);
    const auto count = static_cast<std::uint32_t>(loop_);
    for (std::uint32_t i = 0; i < count; ++i)
      add_triangle({i, (i + 1) % count, count}, {kNone, (i + 1) % count, (i + count - 1) % count});
    for (std::uint32_t i = 0; i < count; ++i) edges_.emplace_back(i, 1);
    flip();
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) look_at(t);
    while (!deep_.empty() && points_.size() < most_points_) {
      const auto [below, t] = deep_.top();
      deep_.pop();
      if (height(t) == -below) add_point_over(t);
    }
  }

  RoundPatch take() && {
    return {{points_.begin() + static_cast<std::ptrdiff_t>(loop_), points_.end()}, std::move(triangles_)};
  }

 private:
  using Corners = std::array<std::uint32_t, 3>;
  // The radius of a triangle whose middle is as deep as that of the widest chord, in steps. Reasoned: half of a chord,
  // which is 1 / 0.92 of a step (see opened_source.cpp).
  static constexpr double kRadius = 0.5 / 0.92;
  // How many points may be added, for a step of 1. Reasoned: a half of the sphere, with points half a radius apart,
  // takes 100; beyond, rounding has led astray.
  static constexpr double kPointsForEach = 200;

  double volume(std::uint32_t a, std::uint32_t b, const Vec3d& c) const { return points_[a].cross(points_[b]).dot(c); }
  Vec3d normal(std::uint32_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return (points_[b] - points_[a]).cross(points_[c] - points_[a]);
  }
  std::size_t longest_edge(std::uint32_t t) const {
    std::size_t longest = 0;
    double least = 2;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double along = points_[triangles_[t][k]].dot(points_[triangles_[t][(k + 1) % 3]]); along < least) {
        least = along;
        longest = k;
      }
    return longest;
  }
  Vec3d middle_of(std::uint32_t t, std::size_t k) const {
    return points_[triangles_[t][k]] + points_[triangles_[t][(k + 1) % 3]];
  }
  /// The distance of a triangle from the sphere's centre.
  double height(std::uint32_t t) const {
    Vec3d over = normal(t);
    if (over.normalize())
      if (const Corners& v = triangles_[t];
          volume(v[0], v[1], over) >= 0 && volume(v[1], v[2], over) >= 0 && volume(v[2], v[0], over) >= 0)
        return over.dot(points_[v[0]]);
    return middle_of(t, longest_edge(t)).length() / 2;
  }
  void look_at(std::uint32_t t) {
    if (const double at = height(t); at < least_height_) deep_.emplace(-at, t);
  }

  void add_triangle(const Corners& corners, const Corners& across) {
    triangles_.push_back(corners);
    across_.push_back(across);
  }
  /// Has the triangle beyond an edge, if there is one, know that another one is there now.
  void meet(std::uint32_t beyond, std::uint32_t before, std::uint32_t now) {
    if (beyond != kNone) *std::find(across_[beyond].begin(), across_[beyond].end(), before) = now;
  }

  void add_point_over(std::uint32_t t) {
    Vec3d point = normal(t);
    std::uint32_t in = point.normalize() ? triangle_at(point, t) : kNone;
    if (in == kNone) {
      point = middle_of(t, longest_edge(t)).unit();
      in = triangle_at(point, t);
    }
    if (in == kNone) return;
    for (std::size_t k = 0; k < 3; ++k)  // between two points of the loop there is nothing to be gained
      if (across_[in][k] == kNone && is_on(in, k, point)) return;
    add(point, in);
  }
  bool is_on(std::uint32_t t, std::size_t k, const Vec3d& point) const {
    return std::abs(volume(triangles_[t][k], triangles_[t][(k + 1) % 3], point)) <= kFlatVolume;
  }

  /// The triangle under a point; kNone if it is outside of the loop.
  std::uint32_t triangle_at(const Vec3d& point, std::uint32_t t) const {
    for (std::size_t steps = 0; steps <= triangles_.size(); ++steps) {
      std::size_t k = 0;
      while (k < 3 && volume(triangles_[t][k], triangles_[t][(k + 1) % 3], point) >= -kFlatVolume) ++k;
      if (k == 3) return t;
      t = across_[t][k];
      if (t == kNone) break;
    }
    return kNone;
  }

  /// Parts a triangle in three.
  void add(const Vec3d& point, std::uint32_t t) {
    const auto p = static_cast<std::uint32_t>(points_.size()), u = static_cast<std::uint32_t>(triangles_.size()),
               w = u + 1;
    const auto [a, b, c] = triangles_[t];
    const auto [over_ab, over_bc, over_ca] = across_[t];
    points_.push_back(point);
    triangles_[t] = {a, b, p};
    across_[t] = {over_ab, u, w};
    add_triangle({b, c, p}, {over_bc, w, t});
    add_triangle({c, a, p}, {over_ca, t, u});
    meet(over_bc, t, u);
    meet(over_ca, t, w);
    for (const std::uint32_t piece : {t, u, w}) {
      edges_.emplace_back(piece, 0);
      look_at(piece);
    }
    flip();
  }

  /// Flips edges for as long as that brings the patch nearer to the sphere: until it is part of the hull of its points,
  /// which is their Delaunay triangulation on the sphere.
  void flip() {
    for (std::size_t flips = 0; !edges_.empty(); ++flips) {
      const auto [t, k] = edges_.back();
      edges_.pop_back();
      const std::uint32_t u = across_[t][k];
      if (u == kNone || flips > kMostFlips * triangles_.size()) continue;
      const auto j = static_cast<std::size_t>(std::find(across_[u].begin(), across_[u].end(), t) - across_[u].begin());
      if (!is_nearer(t, k, triangles_[u][(j + 2) % 3])) continue;
      flip(t, k, u, j);
      for (const std::uint32_t changed : {t, u}) {
        for (std::size_t edge = 0; edge < 3; ++edge) edges_.emplace_back(changed, edge);
        look_at(changed);
      }
    }
  }
  /// Whether the two triangles at edge k are nearer to the sphere with the other diagonal, to d.
  bool is_nearer(std::uint32_t t, std::size_t k, std::uint32_t d) const {
    const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3];
    const Vec3d& over = points_[d];
    if (!(volume(d, c, points_[a]) > kFlatVolume) || !(volume(c, d, points_[b]) > kFlatVolume)) return false;
    return volume(a, b, points_[c]) <= kFlatVolume || normal(t).dot(over - points_[a]) > kFlatVolume;
  }
  void flip(std::uint32_t t, std::size_t k, std::uint32_t u, std::size_t j) {
    const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3],
                        d = triangles_[u][(j + 2) % 3];
    const std::uint32_t over_bc = across_[t][(k + 1) % 3], over_ca = across_[t][(k + 2) % 3],
                        over_ad = across_[u][(j + 1) % 3], over_db = across_[u][(j + 2) % 3];
    triangles_[t] = {a, d, c};
    across_[t] = {over_ad, u, over_ca};
    triangles_[u] = {d, b, c};
    across_[u] = {over_db, over_bc, t};
    meet(over_ad, u, t);
    meet(over_bc, t, u);
  }
  // For each triangle, in a row; reasoned: each flip brings the patch nearer to the sphere, and few are needed. For
  // rounding.
  static constexpr std::size_t kMostFlips = 20;

  std::vector<Vec3d> points_;
  std::size_t loop_;
  double least_height_;
  std::size_t most_points_;
  std::vector<Corners> triangles_;
  std::vector<Corners> across_;  // the triangles beyond the edges from each corner to the next; kNone on the loop
  std::vector<std::pair<std::uint32_t, std::size_t>> edges_;    // that may have to be flipped
  std::priority_queue<std::pair<double, std::uint32_t>> deep_;  // triangles that were too deep, deepest first
};

}  // namespace

std::optional<RoundPatch> round_patch(std::span<const Vec3d> loop, double step, int side) {
  // Reasoned: rounding; a loop that is seen at so small an angle covers nothing.
  constexpr double kSeen = 1e-9;
  Vec3d middle(0.0);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d& next = loop[(i + 1) % loop.size()];
    middle += (loop[i] + next) * angle_between(loop[i], next);
  }
  if (!(middle.normalize())) return std::nullopt;
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (!(side * middle.dot(loop[i].cross(loop[(i + 1) % loop.size()])) > kSeen) || middle.dot(loop[i]) <= 0)
      return std::nullopt;
  std::vector<Vec3d> around(loop.begin(), loop.end());
  if (side < 0) std::reverse(around.begin(), around.end());
  RoundPatch patch = PatchMaker(std::move(around), middle, step).take();
  if (side < 0)
    for (auto& triangle : patch.triangles) {
      std::swap(triangle[1], triangle[2]);
      for (std::uint32_t& v : triangle)
        if (v < loop.size()) v = static_cast<std::uint32_t>(loop.size()) - 1 - v;
    }
  return patch;
}

}  // namespace vdb_offset
