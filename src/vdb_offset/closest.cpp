#include "vdb_offset/closest.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vdb_offset {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Spreads the low 21 bits of x so that two zeros follow each.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2) & 0x1249249249249249ULL;
  return x;
}

// More than the rounding of a squared height over a unit normal.
constexpr double kPlaneSlack = 1 - 1e-12;

}  // namespace

ClosestQuery::ClosestQuery(const Surface& surface) : surface_(surface) {
  const Vec3d lower = surface.facts.lower - surface.origin, upper = surface.facts.upper - surface.origin;
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, std::abs(lower[k]), std::abs(upper[k])});
  // Boxes hold coordinates of size 1 or so: their squares neither overflow nor vanish in a float.
  scale_ = reach > 0 ? std::ldexp(1.0, -std::ilogb(reach)) : 1.0;
  slack_ = static_cast<float>(reach * scale_ * 4e-7);
  sort_triangles();
  build_lowest_level();
  std::size_t nodes = (order_.size() + kLeafSize - 1) / kLeafSize;
  while (levels_.back().size() > 1) {
    nodes = (nodes + kWidth - 1) / kWidth;
    build_level(levels_.back(), nodes);
  }
}

void ClosestQuery::sort_triangles() {
  const std::size_t count = surface_.triangles.size();
  const Vec3d lower = surface_.facts.lower - surface_.origin;
  const Vec3d extent = surface_.facts.upper - surface_.facts.lower;
  const double longest = std::max({extent[0], extent[1], extent[2], std::numeric_limits<double>::min()});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const auto& [a, b, c] = surface_.triangles[t];
      const Vec3d centre = (surface_.vertices[a] + surface_.vertices[b] + surface_.vertices[c]) / 3.0 - lower;
      std::uint64_t code = 0;
      for (int k = 0; k < 3; ++k)
        code |= spread(static_cast<std::uint64_t>(std::clamp(centre[k] / longest, 0.0, 1.0) * 2097151.0)) << k;
      keys[t] = {code, static_cast<std::uint32_t>(t)};
    }
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  order_.resize(count);
  std::transform(keys.begin(), keys.end(), order_.begin(), [](const auto& key) { return key.second; });
}

void ClosestQuery::build_lowest_level() {
  const std::size_t leaves = (order_.size() + kLeafSize - 1) / kLeafSize;
  auto& level = levels_.emplace_back((leaves + kWidth - 1) / kWidth);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, level.size() * kWidth, 512), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf != range.end(); ++leaf) {
      Siblings& block = level[leaf / kWidth];
      const std::size_t at = leaf % kWidth, end = std::min<std::size_t>((leaf + 1) * kLeafSize, order_.size());
      for (int k = 0; k < 3; ++k) {
        block.lower[k][at] = kInfinity;
        block.upper[k][at] = -kInfinity;
        for (std::size_t i = leaf * kLeafSize; i < end; ++i)
          for (const auto v : surface_.triangles[order_[i]]) {
            const auto x = static_cast<float>(surface_.vertices[v][k] * scale_);
            block.lower[k][at] = std::min(block.lower[k][at], x);
            block.upper[k][at] = std::max(block.upper[k][at], x);
          }
      }
    }
  });
}

void ClosestQuery::build_level(const std::vector<Siblings>& below, std::size_t nodes) {
  std::vector<Siblings> level((nodes + kWidth - 1) / kWidth);
  for (std::size_t node = 0; node < level.size() * kWidth; ++node)
    for (int k = 0; k < 3; ++k) {
      float lower = kInfinity, upper = -kInfinity;
      if (node < below.size())
        for (int i = 0; i < kWidth; ++i) {
          lower = std::min(lower, below[node].lower[k][i]);
          upper = std::max(upper, below[node].upper[k][i]);
        }
      level[node / kWidth].lower[k][node % kWidth] = lower;
      level[node / kWidth].upper[k][node % kWidth] = upper;
    }
  levels_.push_back(std::move(level));
}

Closest ClosestQuery::operator()(const Vec3d& x, std::uint32_t hint) const {
  std::uint32_t best_triangle = hint;
  TrianglePoint best = surface_.walk_to_closest(x, best_triangle);
  const float fx[3] = {static_cast<float>(x[0] * scale_), static_cast<float>(x[1] * scale_),
                       static_cast<float>(x[2] * scale_)};
  // A box is left out only if it is farther than the best by more than float rounding can hide.
  const float rounding = slack_ + 4e-7f * std::max({std::abs(fx[0]), std::abs(fx[1]), std::abs(fx[2])});
  const auto bound = [&] {
    const float reach = (static_cast<float>(std::sqrt(best.squared_distance) * scale_) + rounding) * 1.000001f;
    return reach * reach;
  };
  float limit = bound();

  struct Visit {
    float squared_distance;
    std::uint32_t level, block;
  };
  std::array<Visit, kWidth * 12> stack;  // 8^12 leaves are far more than 2^31 triangles
  std::size_t depth = 0;
  stack[depth++] = {0.0f, static_cast<std::uint32_t>(levels_.size() - 1), 0};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (visit.squared_distance > limit) continue;
    const Siblings& box = levels_[visit.level][visit.block];
    float squared[kWidth];
    for (int i = 0; i < kWidth; ++i) squared[i] = 0;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < kWidth; ++i) {
        const float below = box.lower[k][i] - fx[k], above = fx[k] - box.upper[k][i];
        const float outside = std::max(std::max(below, above), 0.0f);
        squared[i] += outside * outside;
      }
    // Nearest last, so that it is taken first.
    const std::size_t base = depth;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      if (!(squared[i] <= limit)) continue;
      std::size_t at = depth++;
      for (; at > base && stack[at - 1].squared_distance < squared[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {squared[i], visit.level - 1, visit.block * kWidth + i};
    }
    if (visit.level > 0) continue;
    for (; depth > base; --depth) {
      const Visit& leaf = stack[depth - 1];
      if (leaf.squared_distance > limit) continue;
      const std::size_t end = std::min<std::size_t>((std::size_t{leaf.block} + 1) * kLeafSize, order_.size());
      for (std::size_t i = std::size_t{leaf.block} * kLeafSize; i < end; ++i) {
        // A triangle is no nearer than its plane.
        const double height =
            surface_.triangle_normals[order_[i]].dot(x - surface_.vertices[surface_.triangles[order_[i]][0]]);
        if (height * height * kPlaneSlack > best.squared_distance) continue;
        const TrianglePoint candidate = surface_.closest_on(order_[i], x);
        if (candidate.squared_distance < best.squared_distance) {
          best = candidate;
          best_triangle = order_[i];
          limit = bound();
        }
      }
    }
  }
  return {std::sqrt(best.squared_distance), best_triangle, best.feature, best.point};
}

}  // namespace vdb_offset
