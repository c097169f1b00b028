// Compiled with -frounding-math, which CGAL's interval arithmetic needs.
#include "vdb_offset/segment_crossings.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdb_offset {
namespace {

int side_of(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  using Point2 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  return CGAL::orientation(Point2(a[0], a[1]), Point2(b[0], b[1]), Point2(c[0], c[1]));
}

/// Of segments on one line: whether their boxes meet.
bool boxes_meet(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  for (int k = 0; k < 2; ++k)
    if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k])) return false;
  return true;
}

/// Whether the ways from p to b and to d run along the same line to the same side.
bool overlap_from(const Vec2d& p, const Vec2d& b, const Vec2d& d) {
  if (side_of(p, b, d) != 0) return false;
  const int k = p[0] != b[0] ? 0 : 1;
  return (b[k] > p[k]) == (d[k] > p[k]);
}

std::vector<SegmentPair> gather(const tbb::enumerable_thread_specific<std::vector<SegmentPair>>& found) {
  std::vector<SegmentPair> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

SegmentCrossings::SegmentCrossings(std::span<const Segment> segments, std::span<const Vec2d> places)
    : segments_(segments), places_(places) {
  tree_.build(segments.size(), [&](std::size_t s) { return box_of(s); });
}

void SegmentCrossings::update(std::span<const std::uint32_t> segments) {
  tree_.refit(segments, [&](std::size_t s) { return box_of(s); });
}

/// Rounded outwards.
FloatBox SegmentCrossings::box_of(std::size_t segment) const {
  FloatBox box;
  box.lower[2] = box.upper[2] = 0;
  for (const auto p : segments_[segment])
    for (std::size_t k = 0; k < 2; ++k) {
      const auto x = static_cast<float>(places_[p][static_cast<int>(k)]);
      const float rounding = std::abs(x) * 0x1p-23f + std::numeric_limits<float>::denorm_min();
      box.lower[k] = std::min(box.lower[k], x - rounding);
      box.upper[k] = std::max(box.upper[k], x + rounding);
    }
  return box;
}

bool SegmentCrossings::meet(std::uint32_t s, std::uint32_t t) const {
  Segment a = segments_[s], b = segments_[t];
  // A point that both have comes first in both.
  if (a[1] == b[0] || a[1] == b[1]) std::swap(a[0], a[1]);
  if (a[0] == b[1]) std::swap(b[0], b[1]);
  const Vec2d &p = places_[a[0]], &q = places_[a[1]], &r = places_[b[0]], &u = places_[b[1]];
  if (p == q || r == u) return false;
  if (a[0] == b[0]) return a[1] != b[1] && overlap_from(p, q, u);
  const int r_side = side_of(p, q, r), u_side = side_of(p, q, u);
  if (r_side * u_side > 0) return false;
  if (r_side == 0 && u_side == 0) return boxes_meet(p, q, r, u);
  return side_of(r, u, p) * side_of(r, u, q) <= 0;
}

std::vector<SegmentPair> SegmentCrossings::all() const {
  tbb::enumerable_thread_specific<std::vector<SegmentPair>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, segments_.size(), 256), [&](const auto& range) {
    auto& mine = found.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto s = static_cast<std::uint32_t>(i);
      tree_.for_each_overlap(box_of(i), [&](std::size_t child) {
        const auto t = static_cast<std::uint32_t>(child);
        if (t > s && meet(s, t)) mine.emplace_back(s, t);
      });
    }
  });
  return gather(found);
}

std::vector<SegmentPair> SegmentCrossings::of(std::span<const std::uint32_t> segments) const {
  tbb::enumerable_thread_specific<std::vector<SegmentPair>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, segments.size(), 64), [&](const auto& range) {
    auto& mine = found.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::uint32_t s = segments[i];
      tree_.for_each_overlap(box_of(s), [&](std::size_t child) {
        const auto t = static_cast<std::uint32_t>(child);
        if (t != s && meet(std::min(s, t), std::max(s, t))) mine.push_back(std::minmax(s, t));
      });
    }
  });
  return gather(found);
}

}  // namespace vdb_offset
