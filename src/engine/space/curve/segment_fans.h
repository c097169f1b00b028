// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "space/curve/ribbon.h"

namespace vdb_offset {

/// Segment fans: the segments out of a point that many share. Two segments of a fan meet elsewhere than in that point
/// only if they run in the same direction, so that they are kept in the order of their directions (by exact
/// predicates), and none is compared with all. A segment between two such points is in the fan of the first. Memory: 60
/// bytes a segment in fans.
class SegmentFans {
 public:
  /// Least number of segments in a fan: fewer of them are faster compared one by one. Not measured more closely.
  static constexpr std::size_t kLeast = 64;

  /// Makes the fans of some segments. `some` is reordered: the segments of each fan follow each other, behind all
  /// others. Keeps references to `segments` and `positions`.
  SegmentFans(std::span<const Segment> segments, std::span<const Vec2d> positions, std::vector<std::uint32_t>& some);
  SegmentFans(const SegmentFans&) = delete;
  SegmentFans& operator=(const SegmentFans&) = delete;

  bool empty() const { return fans_.empty(); }
  /// To be called for segments whose points have moved.
  void update(std::span<const std::uint32_t> segments);

  /// The range of the reordered segments that are in one fan.
  struct Row {
    std::size_t begin = 0, end = 0;
  };
  Row row(std::uint32_t segment) const {
    return empty() || fan_of_[segment] == kNoFan ? Row{} : fans_[fan_of_[segment]].row;
  }

  /// Calls is_it(t) for each other segment t of the same fan that runs in the same direction, until it
  /// returns true. Returns whether it did.
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
    Ordered ordered;  // segments with a length, by direction
  };

  void insert(std::uint32_t segment);
  const Vec2d& end_of(std::uint32_t segment, std::uint32_t point) const {
    const Segment& ends = segments_[segment];
    return positions_[ends[0] == point ? ends[1] : ends[0]];
  }

  std::span<const Segment> segments_;
  std::span<const Vec2d> positions_;
  std::vector<Fan> fans_;
  std::vector<std::uint32_t> fan_of_;        // of each segment: its fan, or kNoFan; empty if there are no fans
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
