#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/box_tree.h"
#include "vdb_offset/ribbon.h"

namespace vdb_offset {

/// Two segments, the smaller index first.
using SegmentPair = std::pair<std::uint32_t, std::uint32_t>;

/// Finds the pairs of segments of plane curves that meet elsewhere than in the points they share: decided with exact
/// predicates (CGAL's kernel), without a tolerance. Neighbours meet if one is folded back onto the other. Segments
/// without length meet nothing. Memory: 28 bytes a segment.
class SegmentCrossings {
 public:
  /// `places` of the points may lie anywhere. Keeps references to both.
  SegmentCrossings(std::span<const Segment> segments, std::span<const Vec2d> places);

  /// To be told of segments whose points have moved; sorted, no two the same.
  void update(std::span<const std::uint32_t> segments);

  /// All pairs, sorted; the same for any number of threads.
  std::vector<SegmentPair> all() const;
  /// The pairs that one of these segments is part of, sorted.
  std::vector<SegmentPair> of(std::span<const std::uint32_t> segments) const;

 private:
  FloatBox box_of(std::size_t segment) const;
  bool meet(std::uint32_t s, std::uint32_t t) const;

  std::span<const Segment> segments_;
  std::span<const Vec2d> places_;
  BoxTree tree_;
};

}  // namespace vdb_offset
