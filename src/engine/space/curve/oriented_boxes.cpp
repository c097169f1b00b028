// SPDX-License-Identifier: Apache-2.0
#include "space/curve/oriented_boxes.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vdb_offset {
namespace {

// How much two computations of the same distance may differ, as a share of the coordinates: some roundings of 2^-53
// each. Not measured.
constexpr double kTieRounding = 16 * 0x1p-53;
// Nodes with fewer segments are built by one task, as another one would cost more than it saves. Not measured.
constexpr std::size_t kSmallSheaf = 4096;

Vec2d turned(const Vec2d& along, const Vec2d& x) {
  return {along[0] * x[0] + along[1] * x[1], along[0] * x[1] - along[1] * x[0]};
}

/// Where the middle of a segment is, along and across the direction of its group; and the sine of the angle between the
/// segment and that direction.
using Traits = std::array<double, 3>;

Traits traits_of(const Vec2d& along, const Vec2d& a, const Vec2d& b) {
  const Vec2d middle = turned(along, (a + b) * 0.5), direction = turned(along, b - a);
  return {middle[0], middle[1],
          direction[0] < 0 ? -direction[1] / direction.length() : direction[1] / direction.length()};
}

}  // namespace

OrientedBoxes::OrientedBoxes(const Polyline& line, std::vector<std::uint32_t> segments)
    : line_(line), segments_(std::move(segments)) {
  while (segments_.size() >> levels_ > 2 * kLeafSize - 1) ++levels_;
  boxes_.resize(std::size_t{2} << levels_);
  build(0, 1);
  for (int k = 0; k < 2; ++k) {
    double largest = 0;
    for (const Vec3d& x : line.vertices) largest = std::max(largest, std::abs(x[k]));
    extent_ += largest;
  }
}

void OrientedBoxes::build(std::size_t level, std::size_t node) {
  const auto [begin, end] = range(level, node);
  const std::span some = std::span(segments_).subspan(begin, end - begin);
  const Vec2d along = mean_direction(some);
  boxes_[node] = box_of(some, along);
  if (level == levels_) return;
  halve(some, range(level + 1, 2 * node).end - begin, along);
  const auto first = [&] { build(level + 1, 2 * node); };
  const auto second = [&] { build(level + 1, 2 * node + 1); };
  if (some.size() < kSmallSheaf) first(), second();
  else tbb::parallel_invoke(first, second);
}

// The mean of lines, not of directions: angles are doubled, so that segments that run opposite ways count as one.
Vec2d OrientedBoxes::mean_direction(std::span<const std::uint32_t> segments) const {
  Vec2d sum(0.0);
  for (const auto s : segments) {
    const Vec2d direction = end_of(s, 1) - end_of(s, 0);
    const double length = direction.length();
    if (length > 0)
      sum += Vec2d((direction[0] - direction[1]) * (direction[0] + direction[1]), 2 * direction[0] * direction[1]) /
             length;
  }
  const double angle = std::atan2(sum[1], sum[0]) / 2;
  return {std::cos(angle), std::sin(angle)};
}

OrientedBoxes::Box OrientedBoxes::box_of(std::span<const std::uint32_t> segments, const Vec2d& along) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box box{along, Vec2d(kInfinity), Vec2d(-kInfinity)};
  for (const auto s : segments)
    for (const int end : {0, 1}) {
      const Vec2d x = turned(along, end_of(s, end));
      for (int k = 0; k < 2; ++k) {
        box.lower[k] = std::min(box.lower[k], x[k]);
        box.upper[k] = std::max(box.upper[k], x[k]);
      }
    }
  return box;
}

// Sorted by what makes their box widest: their positions along it (by more than the segments' length), their positions
// across it, or their directions.
void OrientedBoxes::halve(std::span<std::uint32_t> segments, std::size_t middle, const Vec2d& along) const {
  Traits lower, upper;
  lower.fill(std::numeric_limits<double>::infinity());
  upper.fill(-lower[0]);
  double length = 0, longest = 0;
  for (const auto s : segments) {
    const Vec2d a = end_of(s, 0), b = end_of(s, 1);
    const Traits traits = traits_of(along, a, b);
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], traits[k]);
      upper[k] = std::max(upper[k], traits[k]);
    }
    const double mine = (b - a).length();
    length += mine / static_cast<double>(segments.size());
    longest = std::max(longest, mine);
  }
  const Traits widths{upper[0] - lower[0] - length, upper[1] - lower[1], (upper[2] - lower[2]) * longest / 2};
  const auto widest = static_cast<std::size_t>(std::max_element(widths.begin(), widths.end()) - widths.begin());
  std::vector<std::pair<double, std::uint32_t>> order;
  order.reserve(segments.size());
  for (const auto s : segments) order.emplace_back(traits_of(along, end_of(s, 0), end_of(s, 1))[widest], s);
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(middle), order.end());
  std::transform(order.begin(), order.end(), segments.begin(), [](const auto& each) { return each.second; });
}

double OrientedBoxes::squared_to(std::size_t node, const Vec2d& x) const {
  const Box& box = boxes_[node];
  const Vec2d local = turned(box.along, x);
  double sum = 0;
  for (int k = 0; k < 2; ++k) {
    const double off = std::max({box.lower[k] - local[k], local[k] - box.upper[k], 0.0});
    sum += off * off;
  }
  return sum;
}

TrianglePoint OrientedBoxes::near(const Vec3d& x, std::uint32_t& segment) const {
  struct Node {
    std::size_t level, node;
    double squared;
  };
  const Vec2d at(x[0], x[1]);
  const double rounding = kTieRounding * (extent_ + std::abs(x[0]) + std::abs(x[1]));
  const auto limit_of = [&](double squared) {
    const double least = std::max(0.0, std::sqrt(squared) - rounding);
    return least * least;
  };
  TrianglePoint best = line_.closest_on(segment, x);
  double limit = limit_of(best.squared_distance);
  std::array<Node, 2 * 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 1, squared_to(1, at)};
  while (depth > 0) {
    const Node here = stack[--depth];
    if (!(here.squared < limit)) continue;
    if (here.level < levels_) {
      Node first{here.level + 1, 2 * here.node, squared_to(2 * here.node, at)};
      Node second{here.level + 1, 2 * here.node + 1, squared_to(2 * here.node + 1, at)};
      if (second.squared < first.squared) std::swap(first, second);
      stack[depth++] = second;
      stack[depth++] = first;
      continue;
    }
    const auto [begin, end] = range(here.level, here.node);
    for (std::size_t i = begin; i < end; ++i) {
      if (line_.is_farther(segments_[i], x, best.squared_distance)) continue;
      const TrianglePoint other = line_.closest_on(segments_[i], x);
      if (!(other.squared_distance < best.squared_distance)) continue;
      best = other;
      segment = segments_[i];
      limit = limit_of(best.squared_distance);
    }
  }
  return best;
}

}  // namespace vdb_offset
