// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ground/numbers/rounding.h"
#include "motion/paths/miters.h"
#include "space/curve/curve_query.h"
#include "space/curve/segment_crossings.h"
#include "valid/faults/fault_finder.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Curves in their plane, and the distances that are asked for.
struct PlaneCurves {
  const CurveQuery& query;
  std::span<const Vec2d> source;  ///< Positions of the polyline's vertices in the plane.
  const Distances& distances;     ///< Of the polyline's vertices.
  Rounding precision;             ///< Of the coordinates that will be written.
  std::span<const Miter> miters;  ///< Of vertices at corners, sorted by vertex; empty if corners are not mitered.

  /// The miter of a vertex; nullptr if it has none.
  const Miter* miter_of(std::uint32_t vertex) const { return find_miter(miters, vertex); }
  const Polyline& line() const { return query.surface(); }
  /// A point of the plane in the polyline's frame.
  Vec3d in_frame(const Vec2d& x) const {
    return {x[0] - line().origin[0], x[1] - line().origin[1], line().vertices.front()[2]};
  }
  /// A position of a vertex in the plane as it will be written.
  Vec2d as_written(std::uint32_t vertex, const Vec2d& x) const {
    if (x == source[vertex] && !precision.rounds_all) return x;
    return {precision(x[0]), precision(x[1])};
  }
  /// The side that a vertex goes to: 1 outward, -1 inward.
  int side(std::uint32_t vertex) const { return distances[vertex] < 0 ? -1 : 1; }
};

/// The faults of an offset of curves, kept up to date while its points are moved.
///
/// A segment is inverted if its outer side, by the direction in which its source runs, faces the source at its middle
/// and at both ends (the offset has folded over there). It is collapsed if it is shorter than 1e-6 of its source. New
/// crossings are found with exact predicates. A point is misplaced if it is farther off than asked, or than its miter
/// is, or on the other side. All is judged on coordinates as they will be written. The result does not depend on the
/// number of threads.
class CurveFaults {
 public:
  /// Starts with all points at their source. Keeps a reference to `curves`.
  explicit CurveFaults(const PlaneCurves& curves);

  /// Moves points to positions, and finds the faults around them. \pre `points` are sorted, each once
  void move(const Indices& points, std::span<const Vec2d> positions);

  bool any() const { return total() > 0; }
  /// Inverted and collapsed segments, misplaced points and new crossings.
  std::size_t total() const { return wrong_segments_ + misplaced_ + crossing_.count; }
  FaultCounts count() const;
  /// The misplaced points, and those of faulty segments. Sorted.
  Indices faulty_points() const;
  /// Whether any of these points is misplaced, or any segment around them faulty.
  bool any_around(const Indices& points) const;

  const Vec2d& position(std::uint32_t point) const { return position_[point]; }
  double distance_of(std::uint32_t point) const { return distance_[point]; }
  /// How far rounding to the precision may have moved a point.
  double rounding(std::uint32_t point) const;
  /// Whether a point is nearer than asked, by more than what rounding takes.
  bool is_short(std::uint32_t point) const;
  /// Whether a point is on the other side of its curve. False for all points of open curves.
  bool on_wrong_side(std::uint32_t point) const { return wrong_side_[point]; }
  std::size_t source_crossings() const { return more_in_source_ ? kMostListedCrossings : source_crossings_.size(); }
  /// Whether there are more source crossings than are counted. Then segments within two segments of one are not judged.
  bool more_in_source() const { return more_in_source_; }
  /// New pairs within two segments of a source crossing, which has slid along.
  std::size_t crossings_near_source() const { return slid_.count; }
  /// The segments around a point: at most two, except where curves branch.
  std::span<const std::uint32_t> around(std::uint32_t point) const { return curves_.line().triangles_around(point); }

 private:
  enum class Fault : std::uint8_t { None, Inverted, Collapsed };

  /// Pairs of segments, listed at both, so that those of a few segments are found without going through all.
  struct Pairs {
    std::vector<Indices> of;  // each segment's partners
    std::size_t count = 0;
    void add(const SegmentPair& pair);
    void remove_all_of(std::uint32_t segment);
  };

  Indices segments_around(const Indices& points) const;
  void measure(std::uint32_t point);
  Fault judge(std::uint32_t segment) const;
  bool is_new(const SegmentPair& pair) const;
  Indices ring(std::uint32_t segment) const;
  bool is_near(const SegmentPair& pair) const;
  void mark_near();

  const PlaneCurves& curves_;
  std::vector<Vec2d> position_, away_;  // of each point: its position, and the vector there from its closest point
  std::vector<double> distance_;
  std::vector<std::uint8_t> wrong_side_, misplaced_at_;  // of each point
  std::vector<Fault> fault_;                             // of each segment
  SegmentCrossings finder_;
  std::size_t wrong_segments_ = 0, misplaced_ = 0;
  Pairs crossing_, slid_;
  std::vector<SegmentPair> source_crossings_;  // empty if there are too many
  std::vector<std::uint8_t> crossed_;          // of each segment: 1 if it is in one of them; empty if there are none
  std::vector<std::uint8_t> near_;             // of each segment, if there are too many: 1 if one of them is near
  bool more_in_source_ = false;
};

}  // namespace vdb_offset
