// SPDX-License-Identifier: Apache-2.0
#include "space/curve/curve_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "space/curve/segment_crossings.h"

namespace vdb_offset {
namespace {

// Squared distances to boxes are computed in floats, and made smaller by this factor: their rounding is far less, so
// that no box is taken to be farther than it is.
constexpr float kBoxRounding = 1 - 0x1p-20f;

// kCrowdSamples: segments that are sampled to see whether curves are crowded; not measured. kCrowd: lowest boxes that
// hold a point of a crowded curve, on average. With fewer, upright boxes are faster; usual curves have less than a
// fifth of that.
constexpr std::size_t kCrowdSamples = 256, kCrowd = 32;

/// Tells, as bits, which of eight boxes lie nearer to (x, y) than the squared distance `limit`. `squared` gets a lower
/// bound of each squared distance.
unsigned nearer_boxes(const BoxTree::Siblings& box, float x, float y, float limit, float* squared) {
  unsigned near = 0;
  for (int i = 0; i < BoxTree::kWidth; i += kLanes) {
    Lanes sum{};
    for (int k = 0; k < 2; ++k) {
      const Lanes below = load_lanes(box.lower[k] + i) - (k == 0 ? x : y),
                  above = (k == 0 ? x : y) - load_lanes(box.upper[k] + i);
      const Lanes out = below > above ? below : above, off = out > 0 ? out : Lanes{};
      sum += off * off;
    }
    sum *= kBoxRounding;
    store_lanes(squared + i, sum);
    near |= lane_bits(sum < limit + Lanes{}) << i;
  }
  return near;
}

}  // namespace

CurveQuery::CurveQuery(const Polyline& line) : line_(line), distinct_(distinct_segments(line.segments)) {
  tree_.build((distinct_.size() + kLeafSize - 1) / kLeafSize, [&](std::size_t leaf) { return box_of(leaf); });
  if (is_crowded()) crowd_.emplace(line, distinct_);
}

bool CurveQuery::is_crowded() const {
  if (distinct_.size() < kCrowd * kLeafSize) return false;
  const std::size_t step = (distinct_.size() + kCrowdSamples - 1) / kCrowdSamples;
  std::size_t samples = 0, around = 0;
  for (std::size_t i = step / 2; i < distinct_.size(); i += step, ++samples) {
    const auto [a, b] = line_.segments[distinct_[i]];
    const Vec3d middle = (line_.vertices[a] + line_.vertices[b]) * 0.5;
    FloatBox point;
    for (std::size_t k = 0; k < 2; ++k)
      point.lower[k] = point.upper[k] = static_cast<float>(middle[static_cast<int>(k)]);
    point.lower[2] = point.upper[2] = 0;
    tree_.for_each_overlap(point, [&](std::size_t) { ++around; });
  }
  return around > samples * kCrowd;
}

// Rounded outwards by more than rounding to floats takes, of the segments' ends and of the points that will be looked
// up.
FloatBox CurveQuery::box_of(std::size_t leaf) const {
  FloatBox box;
  box.lower[2] = box.upper[2] = 0;
  const std::size_t end = std::min(distinct_.size(), (leaf + 1) * kLeafSize);
  for (std::size_t s = leaf * kLeafSize; s < end; ++s)
    for (const auto v : line_.segments[distinct_[s]])
      for (std::size_t k = 0; k < 2; ++k) {
        const auto x = static_cast<float>(line_.vertices[v][static_cast<int>(k)]);
        const float rounding = std::abs(x) * 0x1p-21f + std::numeric_limits<float>::denorm_min();
        box.lower[k] = std::min(box.lower[k], x - rounding);
        box.upper[k] = std::max(box.upper[k], x + rounding);
      }
  return box;
}

Closest CurveQuery::operator()(const Vec3d& x, std::uint32_t hint) const {
  const TrianglePoint best = near(x, hint);
  return {std::sqrt(best.squared_distance), hint, best.feature, false, best.point};
}

TrianglePoint CurveQuery::near(const Vec3d& x, std::uint32_t& segment) const {
  if (crowd_) return crowd_->near(x, segment);
  struct Node {
    std::uint32_t level, node;
    float squared;
  };
  TrianglePoint best = line_.closest_on(segment, x);
  std::array<Node, BoxTree::kWidth * 12> stack;
  std::size_t depth = 0;
  const auto& levels = tree_.levels();
  stack[depth++] = {static_cast<std::uint32_t>(levels.size() - 1), 0, 0};
  const auto fx = static_cast<float>(x[0]), fy = static_cast<float>(x[1]);
  while (depth > 0) {
    const Node at = stack[--depth];
    if (!(at.squared < best.squared_distance)) continue;
    float squared[BoxTree::kWidth];
    const auto limit = static_cast<float>(best.squared_distance * (1 + 1e-6));
    unsigned near = nearer_boxes(levels[at.level][at.node], fx, fy, limit, squared);
    // Far ones first onto the stack, so that the nearest comes off it next.
    const std::size_t first = depth;
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
      const Node child{at.level, at.node * BoxTree::kWidth + i, squared[i]};
      std::size_t slot = depth++;
      for (; slot > first && stack[slot - 1].squared < child.squared; --slot) stack[slot] = stack[slot - 1];
      stack[slot] = child;
    }
    if (at.level > 0) {
      for (std::size_t i = first; i < depth; ++i) --stack[i].level;
      continue;
    }
    for (; depth > first; --depth)
      if (stack[depth - 1].squared < best.squared_distance) look_into(stack[depth - 1].node, x, best, segment);
  }
  return best;
}

/// Compares the segments of a lowest box with the closest one so far.
inline void CurveQuery::look_into(std::size_t box, const Vec3d& x, TrianglePoint& best, std::uint32_t& segment) const {
  const std::size_t begin = box * kLeafSize, end = std::min(distinct_.size(), begin + kLeafSize);
  for (std::size_t s = begin; s < end; ++s) {
    if (line_.is_farther(distinct_[s], x, best.squared_distance)) continue;
    const TrianglePoint other = line_.closest_on(distinct_[s], x);
    if (!(other.squared_distance < best.squared_distance)) continue;
    best = other;
    segment = distinct_[s];
  }
}

void CurveQuery::answer_together(std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
                                 std::span<Closest> answers) const {
  for (std::size_t i = 0; i < points.size(); ++i) answers[i] = (*this)(points[i], hints[i]);
}

void CurveQuery::answer_along_paths(std::span<const Vec3d> points, std::span<const std::size_t>,
                                    std::span<const std::uint32_t> hints, std::span<Closest> answers) const {
  answer_together(points, hints, answers);
}

}  // namespace vdb_offset
