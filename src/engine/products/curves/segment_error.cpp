// SPDX-License-Identifier: Apache-2.0
// Measures how far the segments of an offset of curves are off their distance: positions and states of the line's
// vertices go in, a FaceError comes out. Points stand at the middles of equal parts of the length of all segments, and
// what is asked of one is interpolated between the ends of its segment. A point that is too far away may be off by no
// more than its segment's own line is, as beside a miter. Where the mean error is above a hundredth, each point's error
// goes to one cause, but for the part that comes of a lack of room; the shares of all causes sum up to one. Points are
// measured in parallel and summed up in their order, so that the result does not depend on the number of threads.
// Faults are not looked for here.
#include "products/curves/segment_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "space/curve/curve_corners.h"
#include "valid/faults/face_error.h"

namespace vdb_offset {
namespace {

// Points that are measured, and points of a segment on average where there are few: an odd number, so that the middles
// of even segments are among them. Not measured.
constexpr std::size_t kMostPoints = 40000, kMostOfSegment = 65;
// Share of the farthest distance below which a point counts as asked to stay. Reasoned: errors are relative.
constexpr double kLeastMeasured = 1e-3;

/// A point on the offset.
struct SegmentSample {
  std::uint32_t segment;
  double share;  // of the way from its first end to its second
};

/// Points at the middles of parts of the same length.
std::vector<SegmentSample> spread_over(const Polyline& line, std::span<const Vec2d> positions) {
  std::vector<double> up_to;
  double sum = 0;
  for (const auto& [a, b] : line.segments) up_to.push_back(sum += (positions[b] - positions[a]).length());
  if (!(sum > 0)) return {};
  std::vector<SegmentSample> samples(std::min(kMostPoints, kMostOfSegment * up_to.size()));
  std::uint32_t segment = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = sum * (static_cast<double>(i) + 0.5) / static_cast<double>(samples.size());
    while (segment + 1 < up_to.size() && !(up_to[segment] > at)) ++segment;
    const double begin = segment == 0 ? 0 : up_to[segment - 1], length = up_to[segment] - begin;
    samples[i] = {segment, length > 0 ? std::clamp((at - begin) / length, 0.0, 1.0) : 0.5};
  }
  return samples;
}

/// Whether an end of a segment is not where the segment's own line is at the distance.
bool is_off_line(const PlaneCurves& curves, std::span<const Vec2d> positions, std::uint32_t segment, std::uint32_t v) {
  const double asked = curves.distances[v];
  const Vec3d moved = curves.in_frame(positions[v]) - curves.line().vertices[v];
  return std::abs(curves.line().triangle_normals[segment].dot(moved) - asked) > kAtDistance * std::abs(asked);
}

/// A sample in the polyline's frame, and what is asked there.
std::pair<Vec3d, double> point_of(const PlaneCurves& curves, std::span<const Vec2d> positions,
                                  const SegmentSample& sample) {
  const auto [a, b] = curves.line().segments[sample.segment];
  return {curves.in_frame(positions[a] * (1 - sample.share) + positions[b] * sample.share),
          curves.distances[a] * (1 - sample.share) + curves.distances[b] * sample.share};
}

/// How far a point is over the line that a segment is on in the source.
double over_line(const PlaneCurves& curves, std::uint32_t segment, const Vec3d& x) {
  const Polyline& line = curves.line();
  return line.triangle_normals[segment].dot(x - line.vertices[line.segments[segment][0]]);
}

/// The part of a sample's error that comes of a lack of room.
double lack_of_room_at(const PlaneCurves& curves, std::span<const Vec2d> positions, const SegmentSample& sample,
                       double error) {
  if (!(error > kAtDistance)) return 0;
  const auto [x, asked] = point_of(curves, positions, sample);
  const Vec3d& normal = curves.line().triangle_normals[sample.segment];
  const Vec3d on_line = x + normal * (asked - over_line(curves, sample.segment, x));
  const Closest closest = curves.query(on_line, sample.segment);
  return lack_of_room(on_line, normal, asked, closest, curves.line().pseudonormal(closest.triangle, closest.feature),
                      error);
}

/// Sums up which part of all errors comes of which cause. \param errors of the samples; none: not measured
void find_causes(const PlaneCurves& curves, std::span<const Vec2d> positions, std::span<const SegmentSample> samples,
                 std::span<const std::optional<PointError>> errors, std::span<const VertexState> states,
                 FaceError& result) {
  const Polyline& line = curves.line();
  const std::vector<std::uint8_t> at_corner = vertices_on_creases(line);
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!errors[i]) continue;
    const double error = std::abs(errors[i]->off);
    bool is_short = false, is_stuck = true, is_round = false;
    for (const auto v : line.segments[samples[i].segment]) {
      is_round |= (at_corner[v] || line.triangles_around(v).size() > 2) &&
                  is_off_line(curves, positions, samples[i].segment, v);
      if (states.empty() || !falls_short(states[v])) continue;
      is_short = true;
      is_stuck &= (positions[v] - curves.source[v]).length() <= kStuck * std::abs(curves.distances[v]);
    }
    sum += error;
    if (is_short) {
      (is_stuck ? result.stuck : result.held_back) += error;
      continue;
    }
    const double no_room = lack_of_room_at(curves, positions, samples[i], error);
    result.no_room += no_room;
    (is_round ? result.corners : result.coarse) += error - no_room;
  }
  for (double* const cause : {&result.held_back, &result.stuck, &result.no_room, &result.corners, &result.coarse})
    *cause /= sum;
}

}  // namespace

FaceError measure_segments(const PlaneCurves& curves, std::span<const Vec2d> positions,
                           std::span<const VertexState> states) {
  const Polyline& line = curves.line();
  VDB_OFFSET_ASSERT(positions.size() == line.vertices.size());
  const std::vector<SegmentSample> samples = spread_over(line, positions);
  std::vector<std::optional<PointError>> errors(samples.size());
  for_each_index(
      samples.size(),
      [&](std::size_t i) {
        const std::uint32_t s = samples[i].segment;
        const auto [x, asked] = point_of(curves, positions, samples[i]);
        const double wanted = std::abs(asked);
        if (!(wanted > kLeastMeasured * curves.distances.scale())) return;
        errors[i] = point_error(curves.query(x, s).distance - wanted, over_line(curves, s, x) - asked, wanted);
      },
      64);
  FaceError result = sum_up_errors(errors);
  if (result.mean > kWorthTelling) find_causes(curves, positions, samples, errors, states, result);
  return result;
}

}  // namespace vdb_offset
