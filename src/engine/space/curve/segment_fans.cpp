// SPDX-License-Identifier: Apache-2.0
#include "space/curve/segment_fans.h"

#include <algorithm>

#include "ground/mesh/exact_predicates.h"

namespace vdb_offset {

// Counterclockwise around the point, from the direction of the x axis.
bool SegmentFans::Before::operator()(std::uint32_t s, std::uint32_t t) const {
  const Vec2d &p = fans->positions_[point], &a = fans->end_of(s, point), &b = fans->end_of(t, point);
  const auto is_below = [&](const Vec2d& x) { return x[1] < p[1] || (x[1] == p[1] && x[0] < p[0]); };
  if (is_below(a) != is_below(b)) return is_below(b);
  return side_of(p, a, b) > 0;
}

SegmentFans::SegmentFans(std::span<const Segment> segments, std::span<const Vec2d> positions,
                         std::vector<std::uint32_t>& some)
    : segments_(segments), positions_(positions) {
  std::vector<std::uint32_t> around(positions.size(), 0), fan_at(positions.size(), kNoFan);
  for (const auto s : some)
    for (const auto p : segments[s]) ++around[p];
  for (std::uint32_t p = 0; p < positions.size(); ++p) {
    if (around[p] < kLeast) continue;
    fan_at[p] = static_cast<std::uint32_t>(fans_.size());
    fans_.push_back({p, {}, Ordered(Before{this, p})});
  }
  if (fans_.empty()) return;
  fan_of_.assign(segments.size(), kNoFan);
  for (const auto s : some) fan_of_[s] = std::min(fan_at[segments[s][0]], fan_at[segments[s][1]]);
  // Segments in no fan come first: kNoFan + 1 is 0.
  std::stable_sort(some.begin(), some.end(),
                   [&](std::uint32_t s, std::uint32_t t) { return fan_of_[s] + 1 < fan_of_[t] + 1; });
  at_.resize(segments.size());
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (fan_of_[some[i]] == kNoFan) continue;
    Row& row = fans_[fan_of_[some[i]]].row;
    if (row.end == 0) row.begin = i;
    row.end = i + 1;
    insert(some[i]);
  }
}

void SegmentFans::insert(std::uint32_t segment) {
  Fan& fan = fans_[fan_of_[segment]];
  const bool has_length = positions_[fan.point] != end_of(segment, fan.point);
  at_[segment] = has_length ? fan.ordered.insert(segment) : fan.ordered.end();
}

void SegmentFans::update(std::span<const std::uint32_t> segments) {
  if (empty()) return;
  // All moved segments are removed before any is inserted: until then, the others are in a consistent order.
  for (const auto s : segments) {
    if (fan_of_[s] == kNoFan) continue;
    Ordered& ordered = fans_[fan_of_[s]].ordered;
    if (at_[s] != ordered.end()) ordered.erase(at_[s]);
  }
  for (const auto s : segments)
    if (fan_of_[s] != kNoFan) insert(s);
}

}  // namespace vdb_offset
