// SPDX-License-Identifier: Apache-2.0
#include "space/curve/segment_crossings.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "ground/mesh/exact_predicates.h"
#include "ground/system/memory.h"

namespace vdb_offset {
namespace {

/// Of segments on one line: whether their boxes meet.
bool boxes_meet(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  for (int k = 0; k < 2; ++k)
    if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k])) return false;
  return true;
}

/// Whether the segments from p to b and from p to d lie on one line and run in the same direction.
bool overlap_from(const Vec2d& p, const Vec2d& b, const Vec2d& d) {
  if (side_of(p, b, d) != 0) return false;
  const int k = p[0] != b[0] ? 0 : 1;
  return (b[k] > p[k]) == (d[k] > p[k]);
}

using Found = tbb::enumerable_thread_specific<std::vector<SegmentPair>>;

constexpr const char* kCrossings = "crossings";  // begins a refusal
// Bytes of a list that memory is not asked for. Reasoned: to ask takes longer than to find so few pairs.
constexpr std::size_t kSmallList = std::size_t{1} << 20;

std::vector<SegmentPair> gather(const Found& found) {
  std::vector<SegmentPair> all;
  std::size_t count = 0;
  for (const auto& some : found) count += some.size();
  if (count * sizeof(SegmentPair) > kSmallList) require_memory(count * sizeof(SegmentPair), kCrossings);
  all.reserve(count);
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

std::vector<std::uint32_t> distinct_segments(std::span<const Segment> segments) {
  std::vector<std::uint32_t> order(segments.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto ends = [&](std::uint32_t s) { return std::minmax(segments[s][0], segments[s][1]); };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t s, std::uint32_t t) { return std::pair(ends(s), s) < std::pair(ends(t), t); });
  order.erase(
      std::unique(order.begin(), order.end(), [&](std::uint32_t s, std::uint32_t t) { return ends(s) == ends(t); }),
      order.end());
  std::sort(order.begin(), order.end());
  return order;
}

SegmentCrossings::SegmentCrossings(std::span<const Segment> segments, std::span<const Vec2d> positions)
    : segments_(segments),
      positions_(positions),
      distinct_(distinct_segments(segments)),
      fans_(segments, positions, distinct_),
      leaf_of_(segments.size(), kNone) {
  for (std::uint32_t leaf = 0; leaf < distinct_.size(); ++leaf) leaf_of_[distinct_[leaf]] = leaf;
  tree_.build(distinct_.size(), [&](std::size_t leaf) { return box_of(distinct_[leaf]); });
}

void SegmentCrossings::update(std::span<const std::uint32_t> segments) {
  std::vector<std::uint32_t> leaves;
  leaves.reserve(segments.size());
  for (const auto s : segments)
    if (!is_repeated(s)) leaves.push_back(leaf_of_[s]);
  // Leaves of segments in fans come after the others, and so are not in the order of `segments`.
  if (!fans_.empty()) std::sort(leaves.begin(), leaves.end());
  fans_.update(segments);
  if (!leaves.empty()) tree_.refit(leaves, [&](std::size_t leaf) { return box_of(distinct_[leaf]); });
}

// Rounded outwards, as boxes are of floats.
FloatBox SegmentCrossings::box_of(std::size_t segment) const {
  FloatBox box;
  box.lower[2] = box.upper[2] = 0;
  for (const auto p : segments_[segment])
    for (std::size_t k = 0; k < 2; ++k) {
      const auto x = static_cast<float>(positions_[p][static_cast<int>(k)]);
      const float rounding = std::abs(x) * 0x1p-23f + std::numeric_limits<float>::denorm_min();
      box.lower[k] = std::min(box.lower[k], x - rounding);
      box.upper[k] = std::max(box.upper[k], x + rounding);
    }
  return box;
}

bool SegmentCrossings::meet(std::uint32_t s, std::uint32_t t) const {
  Segment a = segments_[s], b = segments_[t];
  // If the segments share a point, it becomes the first of both.
  if (a[1] == b[0] || a[1] == b[1]) std::swap(a[0], a[1]);
  if (a[0] == b[1]) std::swap(b[0], b[1]);
  const Vec2d &p = positions_[a[0]], &q = positions_[a[1]], &r = positions_[b[0]], &u = positions_[b[1]];
  if (p == q || r == u) return false;
  if (a[0] == b[0]) return a[1] != b[1] && overlap_from(p, q, u);
  const int r_side = side_of(p, q, r), u_side = side_of(p, q, u);
  if (r_side * u_side > 0) return false;
  if (r_side == 0 && u_side == 0) return boxes_meet(p, q, r, u);
  return side_of(r, u, p) * side_of(r, u, q) <= 0;
}

// Other segments of the same fan are left out of the search in the tree: the boxes of all of them meet.
template <class IsIt>
bool SegmentCrossings::any_met(std::uint32_t s, std::uint32_t least, IsIt&& is_it) const {
  const auto look_at = [&](std::size_t leaf) {
    const std::uint32_t t = distinct_[leaf];
    return t != s && t >= least && meet(std::min(s, t), std::max(s, t)) && is_it(t);
  };
  if (fans_.empty()) return tree_.any_overlap(box_of(s), look_at);
  const SegmentFans::Row row = fans_.row(s);
  return tree_.any_overlap_beside(row.begin, row.end, box_of(s), look_at) ||
         fans_.any_along(s, [&](std::uint32_t t) { return t >= least && is_it(t); });
}

std::optional<std::vector<SegmentPair>> SegmentCrossings::all(std::size_t most) const {
  Found found;
  std::atomic<std::size_t> count = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, distinct_.size(), 256), [&](const auto& range) {
    auto& mine = found.local();
    for (std::size_t i = range.begin(); i != range.end() && count <= most; ++i) {
      const std::uint32_t s = distinct_[i];
      any_met(s, s + 1, [&](std::uint32_t t) {
        mine.emplace_back(s, t);
        return ++count > most;
      });
    }
  });
  if (count > most) return std::nullopt;
  return gather(found);
}

std::vector<std::uint8_t> SegmentCrossings::crossed() const {
  std::vector<std::uint8_t> crossed(segments_.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, distinct_.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::uint32_t s = distinct_[i];
      crossed[s] = any_met(s, 0, [](std::uint32_t) { return true; });
    }
  });
  return crossed;
}

std::vector<SegmentPair> SegmentCrossings::of(std::span<const std::uint32_t> segments,
                                              const std::function<bool(const SegmentPair&)>& counts) const {
  Found found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, segments.size(), 64), [&](const auto& range) {
    auto& mine = found.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::uint32_t s = segments[i];
      if (is_repeated(s)) continue;
      any_met(s, 0, [&](std::uint32_t t) {
        const SegmentPair pair = std::minmax(s, t);
        if (counts(pair)) append_within_limit(mine, pair, kCrossings);
        return false;
      });
    }
  });
  return gather(found);
}

}  // namespace vdb_offset
