// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "space/curve/ribbon.h"
#include "space/curve/segment_fans.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Two segments, the smaller index first.
using SegmentPair = std::pair<std::uint32_t, std::uint32_t>;

/// The segments without repeated ones, which have the same two ends as an earlier one. Sorted.
std::vector<std::uint32_t> distinct_segments(std::span<const Segment> segments);

/// Most pairs that are kept in a list: 8 MB, found in about a second.
inline constexpr std::size_t kMostListedCrossings = 1000000;

/// Finds the pairs of segments of plane curves that meet elsewhere than in the points they share: decided with exact
/// predicates (CGAL's kernel), without a tolerance. Neighbours meet if one is folded back onto the other. Segments
/// without length meet nothing; of repeated segments, the first counts. Memory: 32 bytes a segment,
/// and what fans take.
class SegmentCrossings {
 public:
  /// `positions` of the points may lie anywhere. Keeps references to both.
  SegmentCrossings(std::span<const Segment> segments, std::span<const Vec2d> positions);

  /// To be called for segments whose points have moved. \pre sorted, each once
  void update(std::span<const std::uint32_t> segments);

  /// All pairs, sorted; the same for any number of threads. None if there are more than `most`.
  std::optional<std::vector<SegmentPair>> all(std::size_t most) const;
  /// Marks the segments that meet another one.
  std::vector<std::uint8_t> crossed() const;
  /// The pairs with one of these segments for which counts() holds, sorted.
  std::vector<SegmentPair> of(std::span<const std::uint32_t> segments,
                              const std::function<bool(const SegmentPair&)>& counts) const;

 private:
  FloatBox box_of(std::size_t segment) const;
  bool is_repeated(std::uint32_t segment) const { return leaf_of_[segment] == kNone; }
  bool meet(std::uint32_t s, std::uint32_t t) const;
  /// Calls is_it(t) for the segments that s meets, with numbers from `least` on, until it returns true. Returns whether
  /// it did.
  template <class IsIt>
  bool any_met(std::uint32_t s, std::uint32_t least, IsIt&& is_it) const;

  std::span<const Segment> segments_;
  std::span<const Vec2d> positions_;
  std::vector<std::uint32_t> distinct_;  // the segment of each leaf of the tree
  SegmentFans fans_;
  std::vector<std::uint32_t> leaf_of_;  // of each segment: its leaf; kNone for a repeated one
  BoxTree tree_;
};

}  // namespace vdb_offset
