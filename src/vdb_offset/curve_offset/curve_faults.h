#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/curve/curve_query.h"
#include "vdb_offset/curve/segment_crossings.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {

/// Curves in their plane, and what is asked of them.
struct PlaneCurves {
  const CurveQuery& front;
  std::span<const Vec2d> source;  ///< Where the vertices of its polyline stand in the plane.
  const Distances& distances;     ///< Of the same.
  Rounding precision;             ///< Of the coordinates that will be written.

  const Polyline& line() const { return front.surface(); }
  /// A place of the plane in the polyline's frame.
  Vec3d in_frame(const Vec2d& x) const {
    return {x[0] - line().origin[0], x[1] - line().origin[1], line().vertices.front()[2]};
  }
  int side(std::uint32_t vertex) const { return distances[vertex] < 0 ? -1 : 1; }
};

/// What is wrong with an offset of curves, as their points are moved about.
///
/// A segment is inverted if, on the way that its source runs, the side that it turns outward is not the one away from
/// the source at its middle nor at either end (there, its distance has folded over); collapsed if it is shorter than
/// 1e-6 of its source. Pairs that meet anew are found with exact predicates. A point is misplaced if it is farther off
/// than asked, or on the other side. All is judged on coordinates as they will be written. The result does not depend
/// on the number of threads.
class CurveFaults {
 public:
  /// The points stand at their source. Keeps a reference.
  explicit CurveFaults(const PlaneCurves& curves);

  /// Moves points, sorted, no two the same, to `place` and looks at what is around them.
  void move(const Indices& points, std::span<const Vec2d> place);

  bool any() const { return wrong_segments_ + misplaced_ + crossing_.count > 0; }
  FaultCounts count() const;
  /// Points that something is wrong with.
  Indices wrong_points() const;
  /// The same among these points, and the segments around them.
  bool any_around(const Indices& points) const;

  const Vec2d& place(std::uint32_t point) const { return place_[point]; }
  double distance_of(std::uint32_t point) const { return distance_[point]; }
  /// How far rounding to the precision may have moved a point.
  double rounding(std::uint32_t point) const;
  /// Whether a point is nearer than asked, by more than what rounding takes.
  bool is_short(std::uint32_t point) const;
  /// Of closed curves alone.
  bool on_wrong_side(std::uint32_t point) const { return wrong_side_[point]; }
  std::size_t source_crossings() const { return more_in_source_ ? kMostListedCrossings : source_crossings_.size(); }
  /// There are more of them than are counted. Then nothing is asked of segments that are no more than two from one.
  bool more_in_source() const { return more_in_source_; }
  /// New pairs that have only slid along from one of those.
  std::size_t crossings_near_source() const { return slid_.count; }
  /// The segments around a point: at most two, but where curves branch.
  std::span<const std::uint32_t> around(std::uint32_t point) const { return curves_.line().triangles_around(point); }

 private:
  enum class Fault : std::uint8_t { None, Inverted, Collapsed };

  /// Pairs of segments, each known to both: what a few of them are part of is found without looking at the others.
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
  std::vector<Vec2d> place_, away_;  // of each point: where it stands, and the way there from the closest one
  std::vector<double> distance_;
  std::vector<std::uint8_t> wrong_side_, misplaced_at_;  // of each point
  std::vector<Fault> fault_;                             // of each segment
  SegmentCrossings finder_;
  std::size_t wrong_segments_ = 0, misplaced_ = 0;
  Pairs crossing_, slid_;
  std::vector<SegmentPair> source_crossings_;  // empty if there are too many
  std::vector<std::uint8_t> crossed_;          // of each segment, whether it is in one of them; empty if there are none
  std::vector<std::uint8_t> near_;             // of each segment, if there are too many: whether one is near
  bool more_in_source_ = false;
};

}  // namespace vdb_offset
