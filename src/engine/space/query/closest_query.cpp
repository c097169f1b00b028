// SPDX-License-Identifier: Apache-2.0
#include "space/query/closest_query.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ground/numbers/morton.h"
#include "ground/system/assert.h"
#include "space/query/closest_search.h"

namespace vdb_offset {

ClosestQuery::ClosestQuery(const Surface& surface, std::uint32_t faces) : surface_(surface), faces_(faces) {
  VDB_OFFSET_ASSERT(!surface.triangles.empty() && surface.triangle_normals.size() == surface.triangles.size());
  const Vec3d lower = surface.facts.lower - surface.origin, upper = surface.facts.upper - surface.origin;
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, std::abs(lower[k]), std::abs(upper[k])});
  // Boxes hold coordinates of a size near 1, so that their squares neither overflow nor vanish in a float. The slack
  // covers the rounding of coordinates to floats and of the arithmetic with them: a few units of 6e-8 each.
  scale_ = reach > 0 ? std::ldexp(1.0, -std::ilogb(reach)) : 1.0;
  slack_ = static_cast<float>(reach * scale_ * 4e-7);
  constexpr std::size_t kSize = kLeafSize;
  rectangles_.resize((surface_.triangles.size() + kSize - 1) / kSize);
  tree_.build(rectangles_.size(), [&](std::size_t leaf) {
    rectangles_[leaf] = rectangles_of(leaf);
    FloatBox box;
    for (std::size_t t = leaf * kSize; t < std::min((leaf + 1) * kSize, surface_.triangles.size()); ++t) {
      if (!is_looked_at(t)) continue;
      for (const auto v : surface_.triangles[t])
        for (int k = 0; k < 3; ++k) {
          const auto x = static_cast<float>(surface_.vertices[v][k] * scale_);
          const auto axis = static_cast<std::size_t>(k);
          box.lower[axis] = std::min(box.lower[axis], x);
          box.upper[axis] = std::max(box.upper[axis], x);
        }
    }
    return box;
  });
}

ClosestQuery::Rectangles ClosestQuery::rectangles_of(std::size_t leaf) const {
  constexpr float kNowhere =
      1e18f;  // coordinate of unused lanes: beyond any limit, and its square still fits into a float
  Rectangles some{};
  for (int i = 0; i < kLeafSize; ++i) {
    const std::size_t t = leaf * kLeafSize + static_cast<std::size_t>(i);
    if (t >= surface_.triangles.size() || !is_looked_at(t)) {
      some.centre[0][i] = kNowhere;
      continue;
    }
    Vec3d corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = surface_.vertices[surface_.triangles[t][k]] * scale_;
    std::size_t longest = 0;
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double other = (corner[(k + 1) % 3] - corner[k]).length(); other > length) {
        longest = k;
        length = other;
      }
    const Vec3d middle = (corner[longest] + corner[(longest + 1) % 3]) / 2.0,
                edge = length > 0 ? (corner[(longest + 1) % 3] - corner[longest]) / length : Vec3d(0.0),
                to_third = corner[(longest + 2) % 3] - middle, across = to_third - edge * edge.dot(to_third),
                centre = middle + across / 2.0;
    // The normal of a very thin triangle may lean along its edge: rectangles need it at right angles to that.
    Vec3d normal = surface_.triangle_normals[t];
    normal -= edge * edge.dot(normal);
    if (normal.lengthSqr() > 0) normal.normalize();
    for (int k = 0; k < 3; ++k) {
      some.centre[k][i] = static_cast<float>(centre[k]);
      some.normal[k][i] = static_cast<float>(normal[k]);
      some.edge[k][i] = static_cast<float>(edge[k]);
    }
    some.half_length[i] = static_cast<float>(length / 2 * (1 + 1e-6)) + slack_;
    some.half_width[i] = static_cast<float>(across.length() / 2 * (1 + 1e-6)) + slack_;
  }
  return some;
}

Closest ClosestQuery::operator()(const Vec3d& x, std::uint32_t hint) const { return Search(*this, x, hint).run(); }

/// Finds the blocks of lowest boxes that may meet any of the balls, and returns their number. `blocks` gets as many of
/// them as it has room for.
std::size_t ClosestQuery::find_blocks(std::span<const Ball> balls, Blocks& blocks) const {
  std::size_t count = 0;
  const auto take = [&](std::size_t block) {
    if (count < kMostBlocks) blocks[count] = static_cast<std::uint32_t>(block);
    ++count;
  };
  if (tree_.levels().size() == 1) {
    take(0);
    return count;
  }
  FloatBox box;
  for (const auto& [centre, radius] : balls)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = centre[static_cast<int>(k)] * scale_, r = radius * scale_;
      const auto slack = slack_ + static_cast<float>((std::abs(x) + r) * 4e-7);
      box.lower[k] = std::min(box.lower[k], static_cast<float>(x - r) - slack);
      box.upper[k] = std::max(box.upper[k], static_cast<float>(x + r) + slack);
    }
  tree_.for_each_overlap(box, take, 1);
  return count;
}

/// Points whose closest points are looked for together, as they share most of the boxes.
class ClosestQuery::Group {
 public:
  static constexpr std::size_t kMost = 32;  // points; not measured beside other numbers

  Group(const ClosestQuery& query, std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
        std::span<Closest> answers)
      : query_(query), points_(points), answers_(answers) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      triangle_[i] = hints[i];
      walked_[i] = query.surface_.walk_to_closest(points[i], triangle_[i]);
      balls_[i] = {points[i], std::sqrt(walked_[i].squared_distance)};
    }
  }

  /// Finds the closest points of points first .. last - 1. The ball around each point that reaches to the triangle
  /// found by walking holds whatever is nearer. Where these balls are not close together, each half is answered by
  /// itself.
  void answer(std::size_t first, std::size_t last) const {
    Blocks blocks;
    const std::size_t count = query_.find_blocks(std::span(balls_).subspan(first, last - first), blocks);
    if (count > kMostBlocks && last - first > 1) {
      answer(first, (first + last) / 2);
      return answer((first + last) / 2, last);
    }
    for (std::size_t i = first; i < last; ++i) {
      Search search(query_, points_[i], triangle_[i], walked_[i]);
      answers_[i] = count > kMostBlocks ? search.run() : search.run_through(std::span(blocks).first(count));
    }
  }

 private:
  const ClosestQuery& query_;
  std::span<const Vec3d> points_;
  std::span<Closest> answers_;
  std::array<std::uint32_t, kMost> triangle_;
  std::array<TrianglePoint, kMost> walked_;
  std::array<Ball, kMost> balls_;
};

void ClosestQuery::answer_together(std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
                                   std::span<Closest> answers) const {
  VDB_OFFSET_ASSERT(hints.size() == points.size() && answers.size() == points.size());
  for (std::size_t i = 0; i < points.size(); i += Group::kMost) {
    const std::size_t count = std::min(Group::kMost, points.size() - i);
    Group(*this, points.subspan(i, count), hints.subspan(i, count), answers.subspan(i, count)).answer(0, count);
  }
}

std::vector<Closest> closest_points(const ClosestQuery& query, std::span<const Vec3d> points) {
  const MeshFacts& facts = query.surface().facts;
  const MortonCurve curve(facts.lower - query.surface().origin, facts.upper - query.surface().origin);
  std::vector<std::pair<std::uint64_t, std::size_t>> order(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) { order[i] = {curve(points[i]), i}; });
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<Closest> answers(points.size());
  // Points in a run, not measured beside other lengths. The same for any number of threads: of triangles that are as
  // near, the hint may decide which one is found.
  constexpr std::size_t kRun = 256;
  tbb::parallel_for(std::size_t{0}, (points.size() + kRun - 1) / kRun, [&](std::size_t run) {
    std::uint32_t hint = 0;
    for (std::size_t i = run * kRun; i < std::min(points.size(), (run + 1) * kRun); ++i) {
      answers[order[i].second] = query(points[order[i].second], hint);
      hint = answers[order[i].second].triangle;
    }
  });
  return answers;
}

}  // namespace vdb_offset
