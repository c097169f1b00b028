// SPDX-License-Identifier: Apache-2.0
// Offsets plane curves by the stages that meshes go through: curves and sets of distances go in; positions, states and
// figures of their points come out. The curves are joined in their plane and raised to a ribbon, whose field all
// results share. One march leads the line half way up the ribbon to all distances. Each result is then made valid by
// itself, or with Collision::Merge given those miters that add no fault, and measured between its points. Distances by
// axis are measured in scaled space and scaled back. A point that does not move keeps its coordinates to the last bit;
// where none is asked to move, no field is made. How curves become valid is in curve_limit.cpp.
#include "vdb_offset/curve_offset.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "ground/distances/in_metric.h"
#include "ground/mesh/count_states.h"
#include "ground/system/call_progress.h"
#include "ground/system/parallel.h"
#include "ground/system/stage_timer.h"
#include "products/curves/curve_limit.h"
#include "products/curves/curve_miters.h"
#include "products/curves/prepared_curves.h"
#include "products/curves/segment_error.h"
#include "products/offset/moved_input.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// Where the vertices of the polyline are at the ends of their paths, in the plane, as they will be written.
std::vector<Vec2d> ends_as_written(const PlaneCurves& plane, const Paths& paths) {
  std::vector<Vec2d> ends(plane.source.begin(), plane.source.end());
  for (std::uint32_t v = 0; v < ends.size(); ++v) {
    const Vec3d& displacement = paths.displacement[v];
    ends[v] = plane.as_written(v, ends[v] + Vec2d(displacement[0], displacement[1]));
  }
  return ends;
}

/// Makes the paths valid, if that is asked for, and hands them out as the result of one set of distances.
OffsetResult make_result(const PreparedCurves& curves, const Distances& distances, Paths& paths) {
  const OffsetOptions& options = curves.options();
  OffsetResult result = unmoved_result(curves.points());
  result.statistics = curves.statistics();
  MiterFacts& facts = result.statistics.miters;
  std::vector<Miter> miters;
  if (options.corners.value_or(Corners::Miter) == Corners::Miter)
    miters = MiterFinder<CurveQuery>(curves.query(), Corners::Miter, options.miter_limit, nullptr)(distances, facts);
  const PlaneCurves plane{curves.query(), curves.source(), distances, options.precision, miters};
  if (options.collision == Collision::Limit) {
    const StageTimer timer(result.statistics.seconds, Stage::Limit);
    result.statistics.limit = limit_curves(plane, paths, options.progress);
  } else {
    miter_sound_corners(plane, paths);
  }
  count_miters(miters, paths.state, facts);
  result.statistics.room = curves.room(paths, distances);
  result.statistics.faces = measure_segments(plane, ends_as_written(plane, paths), paths.state);
  move_vertices(curves.points(), paths, result);
  if (options.keep_paths) hand_out_paths(curves.points(), paths, result);
  result.distances = distances_of_input(curves.points(), distances);
  return result;
}

/// The results where no point moves.
std::vector<OffsetResult> results_at_source(CurvesView curves, const CurvePlan& plan,
                                            std::span<const Distances> distances, bool keep_paths) {
  std::vector<OffsetResult> results;
  for (const Distances& each : distances)
    results.push_back(result_at_source(CurvePoints{curves, plan.plane.chains.welded_to, plan.plane.frame}, each,
                                       keep_paths, plan.statistics));
  return results;
}

std::vector<OffsetResult> offset_prepared(PreparedCurves& curves, std::span<const Distances> wanted) {
  std::vector<std::size_t> disagreeing(wanted.size(), 0);
  std::vector<Distances> distances;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    distances.push_back(curves.distances_of_line(wanted[i], disagreeing[i]));
  std::vector<Paths> paths = curves.march(distances, ridges_of(curves.options()));
  std::vector<OffsetResult> results;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    results.push_back(make_result(curves, distances[i], paths[i]));
    results.back().statistics.disagreeing_distances = disagreeing[i];
  }
  if (curves.options().keep_field)
    results.front().field = hand_out(std::move(curves.field()), results.front().statistics.facts.closed());
  return results;
}

std::vector<OffsetResult> offset_curves_in_metric(CurvesView curves, std::span<const Distances> distances,
                                                  const OffsetOptions& options) {
  const InMetric space(curves, options.metric, InMetric::Of::Lines);
  OffsetOptions even = options;
  even.metric = {};
  std::vector<OffsetResult> results = offset_curves(space.view(), distances, even);
  const MeshFacts facts = facts_of(curves, chains_in_plane(curves));
  for (OffsetResult& result : results) {
    for (std::size_t p = 0; p < result.positions.size(); ++p)
      result.positions[p] = space.moved(curves.positions[p], space.view().positions[p], result.positions[p]);
    for (auto& path : result.paths)
      for (Vec3d& position : path) position = options.metric.from(position);
    result.statistics.facts = facts;
  }
  return results;
}

}  // namespace

OffsetStatistics plan_curves(CurvesView curves, std::span<const Distances> distances, const OffsetOptions& options,
                             std::size_t layers) {
  const InMetric space(curves, options.metric, InMetric::Of::Lines);
  OffsetStatistics statistics = plan_ribbon(space.view(), options, thread_count(options.threads),
                                            farthest_of(distances), {distances.size(), layers})
                                    .statistics;
  if (!options.metric.even()) statistics.facts = facts_of(curves, chains_in_plane(curves));
  return statistics;
}

std::vector<OffsetResult> offset_curves(CurvesView curves, std::span<const Distances> distances,
                                        const OffsetOptions& options) {
  if (distances.empty()) throw InvalidInput("offset: expected a distance, got none");
  require_one_for_each_point(curves, distances);
  if (!options.metric.even()) return offset_curves_in_metric(curves, distances, options);
  const OffsetOptions of_stages = with_call_progress(options);
  std::vector<OffsetResult> results = in_arena(options.threads, [&](int threads) {
    const Reach farthest = farthest_of(distances);
    CurvePlan plan = plan_ribbon(curves, of_stages, threads, farthest, {.results = distances.size()});
    if (!goes_anywhere(farthest)) return results_at_source(curves, plan, distances, options.keep_paths);
    PreparedCurves prepared(curves, of_stages, std::move(plan));
    return offset_prepared(prepared, distances);
  });
  for (OffsetResult& result : results) count_states(result.states, result.statistics);
  report_share(of_stages.progress, Stage::Measure, 1);
  return results;
}

}  // namespace vdb_offset
