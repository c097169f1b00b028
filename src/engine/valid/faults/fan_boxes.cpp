// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/fan_boxes.h"

#include <algorithm>
#include <cmath>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Triangles around a vertex for which directions are kept: with fewer, all pairs are soon tested. Not measured.
constexpr std::uint32_t kMany = 256;
// What rounding to floats may change of a direction, and of the angle between two. Reasoned: far above 2^-24.
constexpr float kDirectionRounding = 1e-6F;

constexpr std::size_t kWidth = BoxTree::kWidth;

/// A box that meets every other one.
FloatBox everywhere() {
  constexpr float kAll = 2;  // beyond all unit vectors
  return {{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}};
}

FloatBox around(const Vec3d& direction, double margin) {
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto x = static_cast<float>(direction[static_cast<int>(k)]);
    box.lower[k] = x - static_cast<float>(margin) - kDirectionRounding;
    box.upper[k] = x + static_cast<float>(margin) + kDirectionRounding;
  }
  return box;
}

bool meet(const FloatBox& a, const FloatBox& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.lower[k] > b.upper[k] || b.lower[k] > a.upper[k]) return false;
  return true;
}

}  // namespace

void FanBoxes::build(const Surface& surface, std::span<const Vec3d> positions, std::size_t levels) {
  surface_ = &surface;
  positions_ = positions;
  nodes_.clear();
  std::vector<std::uint32_t> around(positions.size(), 0);
  for (const auto& corners : surface.triangles)
    for (const auto v : corners) ++around[v];
  if (std::none_of(around.begin(), around.end(), [](std::uint32_t count) { return count > kMany; })) return;
  is_hub_.resize(around.size());
  for (std::size_t v = 0; v < around.size(); ++v) is_hub_[v] = around[v] > kMany;
  nodes_.resize(std::max<std::size_t>(levels, 2));
  std::size_t count = surface.triangles.size();
  for (std::size_t level = 1; level < nodes_.size(); ++level) {
    count = (count + kWidth - 1) / kWidth;
    nodes_[level].resize(count);
    for_each_index(
        count, [&](std::size_t i) { nodes_[level][i] = level == 1 ? node_of_triangles(i) : node_above(level, i); }, 64);
  }
}

void FanBoxes::refit(std::span<const std::uint32_t> changed) {
  if (nodes_.empty()) return;
  std::vector<std::uint32_t> above(changed.begin(), changed.end());
  for (std::size_t level = 1; level < nodes_.size(); ++level) {
    for (std::uint32_t& i : above) i /= kWidth;
    above.erase(std::unique(above.begin(), above.end()), above.end());
    // What triangles have in common stays.
    std::erase_if(above, [&](std::uint32_t i) { return nodes_[level][i].common[0] == kNone; });
    for (const auto i : above) nodes_[level][i] = level == 1 ? node_of_triangles(i) : node_above(level, i);
  }
}

bool FanBoxes::are_apart(const Node& block, std::size_t level, std::size_t child) const {
  if (level == 0) return false;
  const Node& other = nodes_[level][child];
  return other.common == block.common && !meet(other.directions, block.directions);
}

FanBoxes::Node FanBoxes::node_of_triangles(std::size_t block) const {
  const auto begin = static_cast<std::uint32_t>(block * kWidth),
             end = static_cast<std::uint32_t>(std::min(surface_->triangles.size(), (block + 1) * kWidth));
  Node node;
  std::size_t count = 0;
  std::array<std::uint32_t, 3> first = surface_->triangles[begin];
  std::sort(first.begin(), first.end());
  for (const auto v : first) {
    const auto has_it = [&](const auto& corners) {
      return std::find(corners.begin(), corners.end(), v) != corners.end();
    };
    if (count < 2 && is_hub_[v] &&
        std::all_of(surface_->triangles.begin() + begin, surface_->triangles.begin() + end, has_it))
      node.common[count++] = v;
  }
  if (count > 0)
    for (std::uint32_t t = begin; t < end; ++t) node.directions.include(directions_of(t, node.common));
  return node;
}

FanBoxes::Node FanBoxes::node_above(std::size_t level, std::size_t child) const {
  const std::vector<Node>& below = nodes_[level - 1];
  const std::size_t begin = child * kWidth, end = std::min(below.size(), begin + kWidth);
  Node node = below[begin];
  for (std::size_t i = begin + 1; i < end; ++i) {
    if (below[i].common != node.common) return {};
    node.directions.include(below[i].directions);
  }
  return node;
}

/// A box around the directions in which a triangle lies.
FloatBox FanBoxes::directions_of(std::uint32_t triangle, const std::array<std::uint32_t, 2>& common) const {
  const bool is_edge = common[1] != kNone;
  const Vec3d from = positions_[common[0]], along = is_edge ? positions_[common[1]] - from : Vec3d(0.0);
  std::array<Vec3d, 2> directions{Vec3d(0.0), Vec3d(0.0)};
  std::size_t count = 0;
  for (const auto v : surface_->triangles[triangle]) {
    if (v == common[0] || v == common[1]) continue;
    Vec3d direction = positions_[v] - from;
    const double whole = direction.length();
    if (is_edge) direction -= along * (along.dot(direction) / along.lengthSqr());
    const double length = direction.length();
    // Of next to nothing, rounding leaves no direction.
    if (!(length > 1e-6 * whole) || count == 2) return everywhere();
    directions[count++] = direction / length;
  }
  if (count != (is_edge ? 1 : 2)) return everywhere();
  if (is_edge) return around(directions[0], 0);
  // The arc between both lies no farther from the segment between them than its sagitta.
  const double cosine = std::sqrt(std::max(0.0, (1 + directions[0].dot(directions[1])) / 2));
  FloatBox box = around(directions[0], 1 - cosine);
  box.include(around(directions[1], 1 - cosine));
  return box;
}

}  // namespace vdb_offset
