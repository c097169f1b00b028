// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "vdb_offset/curve/ribbon.h"

namespace vdb_offset {

/// Fans of segments: those out of a point that many share. Two of a fan meet elsewhere than in it only if they
/// run in the same direction, so that they are kept in the order of their directions (by exact predicates), and none is
/// compared with all. A segment between two such points is in the fan of the first. Memory: 60 bytes a segment in fans.
class SegmentFans {
 public:
  /// Fewer segments than this around a point are compared faster one by one.
  static constexpr std::size_t kLeast = 64;

  /// Of these segments; they are put in an order in which those of each fan stand in a row, behind all others. Keeps
  /// references to the segments of which these are some, and to the positions.
  SegmentFans(std::span<const Segment> segments, std::span<const Vec2d> positions, std::vector<std::uint32_t>& some);
  SegmentFans(const SegmentFans&) = delete;
  SegmentFans& operator=(const SegmentFans&) = delete;

  bool empty() const { return fans_.empty(); }
  /// To be told of segments whose points have moved.
  void update(std::span<const std::uint32_t> segments);

  /// Which of those put in order are in the same fan as a segment.
  struct Row {
    std::size_t begin = 0, end = 0;
  };
  Row row(std::uint32_t segment) const {
    return empty() || fan_of_[segment] == kNoFan ? Row{} : fans_[fan_of_[segment]].row;
  }

  /// Calls is_it(t) for each other segment t of the same fan that runs in the same direction, until one is what is
  /// looked for; whether one is.
  template <class IsIt>
  bool any_along(std::uint32_t segment, IsIt&& is_it) const;

 private:
  static constexpr std::uint32_t kNoFan = 0xffffffffu;

  struct Before {
    const SegmentFans* fans;
    std::uint32_t point;
    bool operator()(std::uint32_t s, std::uint32_t t) const;
  };
  using Ordered = std::multiset<std::uint32_t, Before>;
  struct Fan {
    std::uint32_t point;
    Row row;
    Ordered ordered;  // by direction; without segments that have no length
  };

  void insert(std::uint32_t segment);
  const Vec2d& end_of(std::uint32_t segment, std::uint32_t point) const {
    const Segment& ends = segments_[segment];
    return positions_[ends[0] == point ? ends[1] : ends[0]];
  }

  std::span<const Segment> segments_;
  std::span<const Vec2d> positions_;
  std::vector<Fan> fans_;
  std::vector<std::uint32_t> fan_of_;        // of each segment; empty if there are none
  std::vector<Ordered::const_iterator> at_;  // of each segment: where it stands in its fan
};

template <class IsIt>
bool SegmentFans::any_along(std::uint32_t segment, IsIt&& is_it) const {
  if (empty() || fan_of_[segment] == kNoFan) return false;
  const Ordered& ordered = fans_[fan_of_[segment]].ordered;
  if (at_[segment] == ordered.end()) return false;
  const auto [begin, end] = ordered.equal_range(segment);
  for (auto at = begin; at != end; ++at)
    if (*at != segment && is_it(*at)) return true;
  return false;
}

}  // namespace vdb_offset
