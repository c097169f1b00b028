// SPDX-License-Identifier: Apache-2.0
// Finds the faults of an offset of curves, and keeps them up to date as points move. Positions of some points go in;
// for these their exact distances and sides are measured, and for the segments around them length, direction and
// crossings are judged, all on coordinates as they will be written. A crossing counts if the source does not have it; a
// new one close to one of the source has slid along, and is counted apart. If the source has more crossings than can be
// listed, segments near one are not looked at for crossings. A move costs what the moved points and their segments
// cost, and the counts are always those of the present positions. Threads write to places of their own. Nothing is
// mended here.
#include "products/curves/curve_faults.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "motion/paths/propagate.h"

namespace vdb_offset {
namespace {

// The length below which a segment is collapsed, as a share of its length in the source: that of faces'
// areas (see FaultFinder).
constexpr double kCollapsedLength = 1e-6;
// The distance from the source, as a share of the distance asked for, below which the side of a point is only rounding.
// Far below the promised 1e-6, far above rounding; not measured.
constexpr double kOnSource = 1e-9;
// The number of segments along the curve that a crossing of the source may slide over: as two rings of faces.
constexpr int kSlides = 2;

}  // namespace

void CurveFaults::Pairs::add(const SegmentPair& pair) {
  of[pair.first].push_back(pair.second);
  of[pair.second].push_back(pair.first);
  ++count;
}

void CurveFaults::Pairs::remove_all_of(std::uint32_t segment) {
  for (const auto other : of[segment]) std::erase(of[other], segment);
  count -= of[segment].size();
  of[segment].clear();
}

CurveFaults::CurveFaults(const PlaneCurves& curves)
    : curves_(curves),
      position_(curves.source.begin(), curves.source.end()),
      away_(curves.source.size(), Vec2d(0.0)),
      distance_(curves.source.size(), 0.0),
      wrong_side_(curves.source.size(), 0),
      misplaced_at_(curves.source.size(), 0),
      fault_(curves.line().segments.size(), Fault::None),
      finder_(curves.line().segments, position_) {
  VDB_OFFSET_ASSERT(curves.source.size() == curves.line().vertices.size());
  VDB_OFFSET_ASSERT(curves.distances.uniform() || curves.distances.count() == curves.source.size());
  crossing_.of.resize(fault_.size());
  slid_.of.resize(fault_.size());
  auto found = finder_.all(kMostListedCrossings);
  more_in_source_ = !found;
  if (found) source_crossings_ = std::move(*found);
  if (more_in_source_) mark_near();
  if (source_crossings_.empty()) return;
  crossed_.assign(fault_.size(), 0);
  for (const auto& [s, t] : source_crossings_) crossed_[s] = crossed_[t] = 1;
}

/// The segments within kSlides segments of one. Sorted.
Indices CurveFaults::ring(std::uint32_t segment) const {
  Indices some{segment};
  for (int i = 0; i < kSlides; ++i) {
    Indices points;
    for (const auto s : some)
      points.insert(points.end(), curves_.line().segments[s].begin(), curves_.line().segments[s].end());
    sort_unique(points);
    some = segments_around(points);
  }
  return some;
}

/// Marks the segments near source crossings where these are too many to look at each: ring by ring, for all at once.
void CurveFaults::mark_near() {
  near_ = finder_.crossed();
  std::vector<std::uint8_t> points(position_.size());
  for (int i = 0; i < kSlides; ++i) {
    std::fill(points.begin(), points.end(), std::uint8_t{0});
    for (std::size_t s = 0; s < near_.size(); ++s)
      if (near_[s])
        for (const auto p : curves_.line().segments[s]) points[p] = 1;
    for (std::size_t s = 0; s < near_.size(); ++s)
      for (const auto p : curves_.line().segments[s]) near_[s] = near_[s] || points[p];
  }
}

/// Whether some source crossing is within kSlides segments of both segments of a pair.
bool CurveFaults::is_near(const SegmentPair& pair) const {
  if (crossed_.empty()) return false;
  Indices of_first = ring(pair.first), of_second = ring(pair.second);
  const auto is_not_crossed = [&](std::uint32_t s) { return !crossed_[s]; };
  std::erase_if(of_first, is_not_crossed);
  if (of_first.empty()) return false;
  std::erase_if(of_second, is_not_crossed);
  return std::any_of(of_first.begin(), of_first.end(), [&](std::uint32_t s) {
    return std::any_of(of_second.begin(), of_second.end(),
                       [&](std::uint32_t t) { return s != t && !is_new(std::minmax(s, t)); });
  });
}

Indices CurveFaults::segments_around(const Indices& points) const {
  Indices segments;
  for (const auto p : points) segments.insert(segments.end(), around(p).begin(), around(p).end());
  sort_unique(segments);
  return segments;
}

void CurveFaults::measure(std::uint32_t point) {
  const Polyline& line = curves_.line();
  const Vec3d x = curves_.in_frame(position_[point]);
  const Closest closest = curves_.query(x, around(point).front());
  const double target = std::abs(curves_.distances[point]);
  distance_[point] = closest.distance;
  away_[point] = {x[0] - closest.point[0], x[1] - closest.point[1]};
  const bool sided = line.facts.closed() && closest.distance > kOnSource * target;
  const double towards = line.pseudonormal(closest.triangle, closest.feature).dot(x - closest.point);
  wrong_side_[point] = sided && towards * curves_.side(point) < 0;
  const Miter* const miter = curves_.miter_of(point);
  const double farthest = miter ? std::max(target, miter->distance) : target;
  misplaced_at_[point] = wrong_side_[point] || closest.distance > farthest * (1 + kReachedTolerance) + rounding(point);
}

double CurveFaults::rounding(std::uint32_t point) const {
  return curves_.precision.epsilon() * position_[point].length();
}

bool CurveFaults::is_short(std::uint32_t point) const {
  return distance_[point] < std::abs(curves_.distances[point]) * (1 - kReachedTolerance) - rounding(point);
}

CurveFaults::Fault CurveFaults::judge(std::uint32_t segment) const {
  const auto [a, b] = curves_.line().segments[segment];
  const Vec2d along = position_[b] - position_[a], before = curves_.source[b] - curves_.source[a];
  if (position_[a] == curves_.source[a] && position_[b] == curves_.source[b]) return Fault::None;
  if (!(along.length() > kCollapsedLength * before.length())) return Fault::Collapsed;
  const double least = kOnSource * std::max(std::abs(curves_.distances[a]), std::abs(curves_.distances[b]));
  const int side = curves_.distances[a] != 0 ? curves_.side(a) : curves_.side(b);
  // Beside a flank of a deep corner the middle alone, or one end, may be closest to that flank.
  const auto is_against = [&](const Vec2d& away) {
    return !(away.length() > least) || side * (along[1] * away[0] - along[0] * away[1]) <= 0;
  };
  if (!is_against(away_[a]) || !is_against(away_[b])) return Fault::None;
  const Vec3d middle = curves_.in_frame((position_[a] + position_[b]) * 0.5);
  const Vec3d away = middle - curves_.query(middle, around(a).front()).point;
  return is_against({away[0], away[1]}) ? Fault::Inverted : Fault::None;
}

bool CurveFaults::is_new(const SegmentPair& pair) const {
  if (more_in_source_) return !near_[pair.first] && !near_[pair.second];
  return !std::binary_search(source_crossings_.begin(), source_crossings_.end(), pair);
}

void CurveFaults::move(const Indices& points, std::span<const Vec2d> positions) {
  VDB_OFFSET_ASSERT(points.size() == positions.size());
  VDB_OFFSET_ASSERT(std::is_sorted(points.begin(), points.end(), std::less_equal<>()));
  constexpr std::size_t kGrain =
      64;  // points or segments that a thread takes at a time. For speed alone; not measured.
  const Indices segments = segments_around(points);
  const auto count_wrong = [&] {
    std::size_t at_points = 0, of_segments = 0;
    for (const auto p : points) at_points += misplaced_at_[p];
    for (const auto s : segments) of_segments += fault_[s] != Fault::None;
    return std::pair(at_points, of_segments);
  };
  const auto before = count_wrong();
  for_each_index(
      points.size(),
      [&](std::size_t i) {
        const auto p = points[i];
        position_[p] = curves_.as_written(p, positions[i]);
        measure(p);
      },
      kGrain);
  for_each_index(
      segments.size(), [&](std::size_t i) { fault_[segments[i]] = judge(segments[i]); }, kGrain);
  const auto after = count_wrong();
  misplaced_ += after.first - before.first;
  wrong_segments_ += after.second - before.second;
  finder_.update(segments);
  for (const auto s : segments) {
    crossing_.remove_all_of(s);
    slid_.remove_all_of(s);
  }
  Indices judged = segments;
  if (more_in_source_) std::erase_if(judged, [&](std::uint32_t s) { return near_[s] != 0; });
  for (const SegmentPair& pair : finder_.of(judged, [&](const SegmentPair& each) { return is_new(each); }))
    (is_near(pair) ? slid_ : crossing_).add(pair);
}

FaultCounts CurveFaults::count() const {
  FaultCounts counts;
  counts.inverted = static_cast<std::size_t>(std::count(fault_.begin(), fault_.end(), Fault::Inverted));
  counts.collapsed = wrong_segments_ - counts.inverted;
  counts.crossings = crossing_.count;
  return counts;
}

Indices CurveFaults::faulty_points() const {
  Indices faulty;
  for (std::uint32_t p = 0; p < position_.size(); ++p)
    if (misplaced_at_[p]) faulty.push_back(p);
  for (std::uint32_t s = 0; s < fault_.size(); ++s) {
    if (fault_[s] == Fault::None && crossing_.of[s].empty()) continue;
    const Segment& segment = curves_.line().segments[s];
    faulty.insert(faulty.end(), segment.begin(), segment.end());
  }
  sort_unique(faulty);
  return faulty;
}

bool CurveFaults::any_around(const Indices& points) const {
  const auto is_faulty = [&](std::uint32_t s) { return fault_[s] != Fault::None || !crossing_.of[s].empty(); };
  return std::any_of(points.begin(), points.end(), [&](std::uint32_t p) {
    return misplaced_at_[p] || std::any_of(around(p).begin(), around(p).end(), is_faulty);
  });
}

}  // namespace vdb_offset
