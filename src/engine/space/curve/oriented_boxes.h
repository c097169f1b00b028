// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "space/curve/polyline.h"

namespace vdb_offset {

/// The closest point of plane curves where many segments lie across, beside or on each other, so that upright boxes
/// around those in a row hold nearly everything: a tree of boxes that each lie along their segments, which are put into
/// groups by where they lie and which way they run.
///
/// Segments that are as near as the closest one found, but for rounding (some 1e-15 of the extent), are not looked at:
/// otherwise thousands of segments on one line would all have to be. Memory: 28 bytes a segment.
class OrientedBoxes {
 public:
  /// Keeps a reference. `segments` are those of the line that count, at least one.
  OrientedBoxes(const Polyline& line, std::vector<std::uint32_t> segments);

  /// The closest point to x, from a segment that becomes the closest. Depends only on these and the curves.
  TrianglePoint near(const Vec3d& x, std::uint32_t& segment) const;

 private:
  static constexpr std::size_t kLeafSize = 4;  // segments of a lowest box, or up to twice as many

  struct Box {
    Vec2d along{1, 0};  // unit length: the first axis of the box; the second is to the left of it
    Vec2d lower, upper;
  };
  /// Nodes 2 n and 2 n + 1 are halves of node n; 1 is the root.
  struct Range {
    std::size_t begin, end;
  };
  Range range(std::size_t level, std::size_t node) const {
    const std::size_t i = node - (std::size_t{1} << level);
    return {segments_.size() * i >> level, segments_.size() * (i + 1) >> level};
  }
  Vec2d end_of(std::uint32_t segment, int end) const {
    const Vec3d& position = line_.vertices[line_.segments[segment][static_cast<std::size_t>(end)]];
    return {position[0], position[1]};
  }
  double squared_to(std::size_t node, const Vec2d& x) const;
  void build(std::size_t level, std::size_t node);
  Vec2d mean_direction(std::span<const std::uint32_t> segments) const;
  Box box_of(std::span<const std::uint32_t> segments, const Vec2d& along) const;
  void halve(std::span<std::uint32_t> segments, std::size_t middle, const Vec2d& along) const;

  const Polyline& line_;
  std::vector<std::uint32_t> segments_;
  std::size_t levels_ = 0;  // above the lowest boxes
  std::vector<Box> boxes_;
  double extent_ = 0;  // sum of the coordinates' largest
};

}  // namespace vdb_offset
