// SPDX-License-Identifier: Apache-2.0
#include "sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

#include "ground/process/packing.h"

namespace vdb_offset {
namespace {

constexpr std::uint32_t kMostInLeaf = 8;

}  // namespace

Sizes::Sizes(const FillDomain& domain) : slope_(domain.growth - 1), longest_(domain.longest) {
  std::vector<double> sum(domain.points.size(), 0);
  std::vector<std::uint32_t> count(domain.points.size(), 0);
  for (const auto& triangle : domain.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      const double length = (domain.points[b] - domain.points[a]).length();
      for (const std::uint32_t p : {a, b}) sum[p] += length, ++count[p];
    }
  for (std::size_t p = 0; p < sum.size(); ++p)
    if (count[p] > 0) points_.push_back({domain.points[p], sum[p] / count[p]});
  build();
}

Sizes::Sizes(const std::string& file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  try {
    const std::string text = bytes.str();
    Unpacker unpacker(text);
    slope_ = unpacker.value<double>();
    longest_ = unpacker.value<double>();
    points_ = unpacker.list<Point>();
    unpacker.end();
  } catch (const BadMessage&) {
    throw FillFailed("no sizes in " + file);
  }
  build();
}

void Sizes::write(const std::string& file) const {
  Packer packer;
  packer.value(slope_).value(longest_).list(points_);
  const std::string bytes = packer.take();
  std::ofstream to(file, std::ios::binary);
  if (!to.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    throw FillFailed("no room for " + file);
}

double Sizes::at(const Vec3d& x) const {
  double size = longest_;
  if (!nodes_.empty() && bound(nodes_[0], x) < size) search(0, x, size);
  return size;
}

void Sizes::build() {
  nodes_.reserve(points_.size() / 2);
  if (!points_.empty()) split(0, static_cast<std::uint32_t>(points_.size()));
}

void Sizes::split(std::uint32_t first, std::uint32_t end) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const std::size_t made = nodes_.size();
  Node node{Vec3d(kFar), Vec3d(-kFar), kFar, first, end, kNone};
  for (std::uint32_t p = first; p < end; ++p) {
    node.lowest = openvdb::math::minComponent(node.lowest, points_[p].place);
    node.highest = openvdb::math::maxComponent(node.highest, points_[p].place);
    node.least = std::min(node.least, points_[p].size);
  }
  nodes_.push_back(node);
  if (end - first <= kMostInLeaf) return;
  const Vec3d extent = node.highest - node.lowest;
  const int axis = static_cast<int>(openvdb::math::MaxIndex(extent));
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + end,
                   [axis](const Point& a, const Point& b) { return a.place[axis] < b.place[axis]; });
  split(first, middle);
  nodes_[made].other = static_cast<std::uint32_t>(nodes_.size());
  split(middle, end);
}

double Sizes::bound(const Node& node, const Vec3d& x) const {
  const Vec3d beyond =
      openvdb::math::maxComponent(openvdb::math::maxComponent(node.lowest - x, x - node.highest), Vec3d(0.0));
  return node.least + slope_ * beyond.length();
}

void Sizes::search(std::uint32_t n, const Vec3d& x, double& size) const {
  const Node& node = nodes_[n];
  if (node.other == kNone) {
    for (std::uint32_t p = node.first; p < node.end; ++p)
      size = std::min(size, points_[p].size + slope_ * (points_[p].place - x).length());
    return;
  }
  std::array<std::uint32_t, 2> halves{n + 1, node.other};
  std::array<double, 2> least{bound(nodes_[halves[0]], x), bound(nodes_[halves[1]], x)};
  if (least[1] < least[0]) std::swap(halves[0], halves[1]), std::swap(least[0], least[1]);
  for (std::size_t k = 0; k < 2; ++k)
    if (least[k] < size) search(halves[k], x, size);
}

void serve_sizes(const std::string& file) {
  const Sizes sizes(file);
  double place[3];
  while (std::fread(place, sizeof place, 1, stdin) == 1) {
    if (std::isnan(place[0])) return;
    const double size = sizes.at({place[0], place[1], place[2]});
    if (std::fwrite(&size, sizeof size, 1, stdout) != 1 || std::fflush(stdout) != 0) return;
  }
}

}  // namespace vdb_offset
