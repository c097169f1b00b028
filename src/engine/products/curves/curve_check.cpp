// SPDX-License-Identifier: Apache-2.0
// Measures given positions as an offset of plane curves, wherever they come from. The source is joined in its plane, in
// which all positions have to lie. If no distance is given, it is the median of those found, on the side that most
// vertices of the line lie on. Faults are found by the class that limit_curves() works with. A point is reached at its
// exact distance, mitered or cut at the end of its miter, and limited elsewhere; points that are too far away, on the
// wrong side, or apart although they are one in the source are counted. Segments are measured between their ends. Where
// all distances are 0, all points count as reached. No point is moved here.
#include "vdb_offset/curve_offset.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "ground/distances/mean_distances.h"
#include "ground/numbers/median.h"
#include "ground/numbers/rounding.h"
#include "ground/system/parallel.h"
#include "ground/system/progress_count.h"
#include "products/curves/curve_faults.h"
#include "products/curves/segment_error.h"
#include "space/curve/curve_line.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The largest distance of an offset's points from the plane of the curves, as a share of their extent. As for
// the source (space/curve/ribbon.cpp). Not measured.
constexpr double kFlatCurve = 1e-6;

void require_usable(CurvesView source, std::span<const Vec3d> positions, const std::optional<Distances>& distance) {
  if (positions.size() != source.positions.size())
    throw InvalidInput("check: expected as many points as the source's " + std::to_string(source.positions.size()) +
                       ", found " + std::to_string(positions.size()));
  for (std::size_t p = 0; p < positions.size(); ++p)
    if (!positions[p].isFinite())
      throw InvalidInput("check: point " + std::to_string(p) + ": expected finite coordinates");
  if (distance && !distance->uniform() && distance->count() != positions.size())
    throw InvalidInput("check: expected a distance for each of " + std::to_string(positions.size()) + " points, got " +
                       std::to_string(distance->count()));
}

class CurveChecker {
 public:
  CurveChecker(CurvesView source, std::span<const Vec3d> positions, const CheckOptions& options, CheckResult& result)
      : plane_(chains_in_plane(source)),
        drawn_(draw_line(plane_, Vec3d(0.0), 0)),
        query_(drawn_.line),
        options_(options),
        result_(result) {
    result.facts = facts_of(source, plane_);
    find_positions(positions);
  }

  void run() {
    Progress progress(options_.progress, Stage::Measure, 3);  // of three steps
    result_.distances = options_.distance ? options_.distance->of_vertices() : Distances(find_distance());
    result_.distance = result_.distances.farthest();
    for (std::size_t p = 0; p < drawn_.vertex.size(); ++p)
      if (drawn_.vertex[p] != kNone) result_.states[p] = VertexState::Reached;
    if (result_.distance == 0) return;
    const Distances distances = distances_of_line();
    std::vector<Miter> miters;
    if (options_.corners.value_or(Corners::Miter) == Corners::Miter)
      miters = MiterFinder<CurveQuery>(query_, Corners::Miter, options_.miter_limit, nullptr).all(distances);
    const PlaneCurves curves{query_, drawn_.source, distances, {}, miters};
    CurveFaults faults(curves);
    Indices all(positions_.size());
    std::iota(all.begin(), all.end(), 0u);
    progress.advance(1);
    faults.move(all, positions_);
    progress.advance(1);
    result_.faults = faults.count();
    result_.source_crossings = faults.source_crossings();
    result_.more_source_crossings = faults.more_in_source();
    result_.crossings_near_source = faults.crossings_near_source();
    judge_points(curves, faults);
    std::vector<VertexState> states(positions_.size(), VertexState::Reached);
    for (std::size_t p = 0; p < drawn_.vertex.size(); ++p)
      if (drawn_.vertex[p] != kNone) states[drawn_.vertex[p]] = result_.states[p];
    result_.faces = measure_segments(curves, positions_, states);
    progress.advance(1);
  }

 private:
  /// Finds the positions of the line's vertices in the offset, in the plane.
  void find_positions(std::span<const Vec3d> positions) {
    positions_.assign(drawn_.source.size(), Vec2d(0.0));
    std::vector<std::uint32_t> first(positions_.size(), kNone);
    const Vec3d normal = plane_.frame.u.cross(plane_.frame.v).unit();
    for (std::uint32_t p = 0; p < positions.size(); ++p) {
      const std::uint32_t v = drawn_.vertex[p];
      if (v == kNone) continue;
      const double off = std::abs(normal.dot(positions[p] - plane_.frame.origin));
      if (off > kFlatCurve * (result_.facts.diagonal + (positions[p] - plane_.frame.origin).length()))
        throw InvalidInput("check: expected points in the plane of the source, found point " + std::to_string(p) +
                           " (from 0) " + std::to_string(off) + " off it");
      if (first[v] == kNone) {
        first[v] = p;
        positions_[v] = plane_.frame.to_plane(positions[p]);
      } else {
        result_.torn += positions[p] != positions[first[v]];
      }
    }
  }

  /// As an offset has them: the mean where points at one position differ.
  Distances distances_of_line() const {
    if (result_.distances.uniform()) return result_.distances;
    std::vector<std::uint32_t> first(positions_.size(), kNone);
    for (std::uint32_t p = 0; p < drawn_.vertex.size(); ++p)
      if (drawn_.vertex[p] != kNone && plane_.chains.welded_to[p] == p) first[drawn_.vertex[p]] = p;
    return Distances(mean_distances(result_.distances, drawn_.vertex, first).each);
  }

  Closest closest_to(const Vec2d& position, std::uint32_t vertex) const {
    return query_(Vec3d(position[0], position[1], 0), drawn_.line.triangles_around(vertex).front());
  }

  /// The median distance, with the sign of the side that most points lie on.
  double find_distance() const {
    std::vector<double> distance;
    std::ptrdiff_t outside = 0;
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      const Closest closest = closest_to(positions_[v], v);
      const Vec3d away = Vec3d(positions_[v][0], positions_[v][1], 0) - closest.point;
      distance.push_back(closest.distance);
      outside += drawn_.line.pseudonormal(closest.triangle, closest.feature).dot(away) < 0 ? -1 : 1;
    }
    return outside < 0 ? -median(distance) : median(distance);
  }

  void judge_points(const PlaneCurves& curves, const CurveFaults& faults) {
    const double epsilon = Rounding(options_.precision).epsilon();
    for (std::size_t p = 0; p < drawn_.vertex.size(); ++p) {
      const std::uint32_t v = drawn_.vertex[p];
      if (v == kNone) continue;
      const double target = std::abs(curves.distances[v]), distance = faults.distance_of(v), error = distance - target,
                   tolerance = kReachedTolerance * target + epsilon * positions_[v].length();
      result_.achieved[p] = distance;
      const Miter* const miter = curves.miter_of(v);
      const bool is_mitered =
          miter &&
          (positions_[v] - curves.source[v] - Vec2d(miter->displacement[0], miter->displacement[1])).length() <=
              tolerance;
      const bool is_on_wrong_side = faults.on_wrong_side(v);
      if (is_mitered && !is_on_wrong_side) result_.states[p] = miter->state;
      else if (is_on_wrong_side || std::abs(error) > tolerance) result_.states[p] = VertexState::Limited;
      result_.beyond += error > tolerance && !is_mitered;
      result_.wrong_side += is_on_wrong_side;
    }
  }

  PlaneChains plane_;
  DrawnLine drawn_;
  CurveQuery query_;
  const CheckOptions& options_;
  CheckResult& result_;
  std::vector<Vec2d> positions_;  // of the line's vertices
};

}  // namespace

CheckResult check_curves(CurvesView source, std::span<const Vec3d> positions, const CheckOptions& options) {
  require_usable(source, positions, options.distance);
  CheckResult result;
  result.states.assign(positions.size(), VertexState::Unused);
  result.achieved.assign(positions.size(), 0.0);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] { CurveChecker(source, positions, options, result).run(); });
  return result;
}

}  // namespace vdb_offset
