// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "space/curve/oriented_boxes.h"
#include "space/curve/polyline.h"
#include "space/query/closest_query.h"

namespace vdb_offset {

/// Exact distance to plane curves: what ClosestQuery is to a surface, with segments for triangles. z does not count.
///
/// Segments lie along their curves, four in a row to a box of an implicit tree. A query cannot miss: the hint only
/// bounds the search. Where the curves are so crowded that boxes hold more than a hundred segments of others at once,
/// they are in OrientedBoxes instead. Memory: about 10 bytes a segment, 40 if crowded. Safe from any number of threads.
class CurveQuery {
 public:
  /// Keeps a reference. \pre the curves have a segment
  explicit CurveQuery(const Polyline& line);

  /// The closest point to x; which of several as close depends only on x, the hint and the curves.
  Closest operator()(const Vec3d& x, std::uint32_t hint) const;

  /// The closest point to x as a TrianglePoint, searched from `segment`, which becomes the closest one. A search that
  /// starts near its end costs little more than a walk along the curve.
  TrianglePoint near(const Vec3d& x, std::uint32_t& segment) const;

  /// The closest points to several points. \pre as many hints and answers as points
  void answer_together(std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
                       std::span<Closest> answers) const;

  /// The closest points to points on paths that lead away from the curves: see ClosestQuery.
  void answer_along_paths(std::span<const Vec3d> points, std::span<const std::size_t> begin,
                          std::span<const std::uint32_t> hints, std::span<Closest> answers) const;

  const Polyline& surface() const { return line_; }

 private:
  static constexpr std::size_t kLeafSize = 4;  // segments in a lowest box

  FloatBox box_of(std::size_t leaf) const;
  void look_into(std::size_t box, const Vec3d& x, TrianglePoint& best, std::uint32_t& segment) const;
  bool is_crowded() const;

  const Polyline& line_;
  std::vector<std::uint32_t> distinct_;  // the segments in the tree, without repeated ones
  BoxTree tree_;
  std::optional<OrientedBoxes> crowd_;  // if the curves are crowded
};

}  // namespace vdb_offset
