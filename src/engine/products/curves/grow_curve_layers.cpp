// SPDX-License-Identifier: Apache-2.0
// Grows layers on plane curves: heights go in, stacks of positions for each point of the curves come out. One march
// goes to the outermost heights. The curve there is made valid as an offset, with points that have crowded at corners
// spread evenly. Then stack_curves() puts the other layers below it, and thins all layers of a point by one share where
// cells would be invalid. Errors between the points are measured on the outermost layer and on the first. What has been
// found for the line's vertices is handed out to the points of the curves that stand there; a point on no curve stays
// where it is in all layers. Cells are not made here (see curve_cells.cpp).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "ground/distances/layer_heights.h"
#include "ground/mesh/count_states.h"
#include "ground/system/call_progress.h"
#include "ground/system/stage_timer.h"
#include "products/curves/curve_layer_grower.h"
#include "products/curves/curve_limit.h"
#include "products/curves/fanned_curves.h"
#include "products/curves/prepared_curves.h"
#include "products/curves/segment_error.h"
#include "products/offset/moved_input.h"
#include "products/offset/stand_off.h"
#include "vdb_offset/curve_offset.h"

namespace vdb_offset {
namespace {

/// Hands out the layers as those of the curves' points. `heights` are those of the line's vertices.
LayersResult hand_over(const PreparedCurves& curves, OffsetStatistics statistics, std::span<const Distances> heights,
                       const Paths& paths, const LayerStack& stack) {
  const CurvePoints points = curves.points();
  OffsetResult outermost = unmoved_result(points);
  move_vertices(points, paths, outermost);
  LayersResult result;
  result.statistics = std::move(statistics);
  result.layer_statistics = stack.statistics;
  result.states = std::move(outermost.states);
  result.achieved = std::move(outermost.achieved);
  const std::size_t count = points.positions().size();
  result.share.assign(count, 0.0);
  result.first_achieved.assign(count, 0.0);
  VertexStacks stacks(count, heights.size());
  std::vector<std::vector<double>> asked(heights.size(), std::vector<double>(count, 0.0));
  for (std::uint32_t p = 0; p < count; ++p) {
    const auto v = points.shape_vertex(p);
    const auto to = stacks.of(p);
    std::fill(to.begin(), to.end(), points.positions()[p]);
    if (v == kNone) continue;
    result.share[p] = stack.share[v];
    result.first_achieved[p] = stack.height_at(v, stack.first_achieved[v]);
    result.achieved[p] = stack.height_at(v, result.achieved[p]);
    const auto positions = stack.stacks.of(v);
    for (std::size_t k = 0; k < heights.size(); ++k) {
      asked[k][p] = heights[k][v];
      if (!stack.stacks.is_flat(v)) to[k + 1] += points.to_input(positions[k + 1] - positions[0]);
    }
  }
  std::vector<std::uint32_t> own(count);
  std::iota(own.begin(), own.end(), 0);
  result.stacks = SharedStacks(std::move(stacks), std::move(own));
  for (auto& each : asked) result.heights.emplace_back(std::move(each));
  return result;
}

/// The error along the segments of one layer's outer side. The stacks' positions are in the plane.
FaceError measure_layer(const PreparedCurves& curves, const Distances& heights, std::span<const VertexState> states,
                        const VertexStacks& stacks, std::size_t layer) {
  std::vector<Vec2d> positions;
  for (std::size_t v = 0; v < stacks.vertices(); ++v) {
    const Vec3d& at = stacks.of(v)[layer];
    positions.emplace_back(at[0], at[1]);
  }
  return measure_segments({curves.query(), curves.source(), heights, curves.options().precision, {}}, positions,
                          states);
}

LayersResult grow_on(PreparedCurves& curves, std::span<const Distances> heights, Spacing spacing) {
  const OffsetOptions& options = curves.options();
  std::vector<Distances> asked;
  std::size_t most_disagreeing = 0;
  for (const Distances& each : heights) {
    std::size_t disagreeing = 0;
    asked.push_back(curves.distances_of_line(each, disagreeing));
    most_disagreeing = std::max(most_disagreeing, disagreeing);
  }
  const Distances& outer = asked.back();
  Paths paths = std::move(curves.march({&outer, 1}, Ridges::Smooth).front());
  const std::vector<double> marched_distances = paths.achieved;
  OffsetStatistics statistics = curves.statistics();
  statistics.disagreeing_distances = most_disagreeing;
  std::vector<Miter> miters;
  if (options.corners == Corners::Miter)
    miters =
        MiterFinder<CurveQuery>(curves.query(), Corners::Miter, options.miter_limit, nullptr)(outer, statistics.miters);
  const PlaneCurves plane{curves.query(), curves.source(), outer, options.precision, miters};
  {
    const StageTimer timer(statistics.seconds, Stage::Limit);
    statistics.limit = limit_curves(plane, paths, options.progress, spacing);
  }
  LayerStack stack;
  {
    const StageTimer timer(statistics.seconds, Stage::Layers);
    CurveFaults faults(plane);
    stack = stack_curves(plane, asked, faults, paths, options.progress);
    statistics.limit.left = faults.count();
    statistics.limit.crossings_near_source = faults.crossings_near_source();
  }
  count_held_back(paths, outer, marched_distances, statistics.limit);
  count_miters(miters, paths.state, statistics.miters);
  statistics.room = curves.room(paths, outer);
  {
    const StageTimer timer(statistics.seconds, Stage::Measure);
    statistics.faces = measure_layer(curves, outer, paths.state, stack.stacks, heights.size());
    stack.statistics.first_faces = measure_layer(curves, asked.front(), paths.state, stack.stacks, 1);
  }
  return hand_over(curves, std::move(statistics), asked, paths, stack);
}

/// Puts the layers of opened curves where the source is.
void put_on_source(CurvesView source, std::span<const Distances> heights, const FannedCurves& fanned,
                   LayersResult& layers) {
  std::vector<Vec3d> wall;
  wall.reserve(fanned.origin.size());
  for (const std::uint32_t p : fanned.origin) wall.push_back(source.positions[p]);
  layers.stacks.put_on_wall(wall);
  layers.statistics.facts = facts_of(source, chains_in_plane(source));
  layers.foot = fanned.foot;
  layers.heights = copied_to(heights, fanned.origin);
  const Distances& outer = layers.heights.back();
  for (std::size_t p = 0; p < layers.share.size(); ++p) {
    if (layers.share[p] == 0) continue;
    layers.achieved[p] += kStandOff * std::abs(outer[p]);
    layers.first_achieved[p] += kStandOff * std::abs(outer[p]);
  }
}

}  // namespace

LayersResult grow_curve_layers(CurvesView curves, std::span<const Distances> heights, const OffsetOptions& options) {
  return grow_fanned_curve_layers(curves, heights, options, 0).layers;
}

FannedCurveLayers grow_fanned_curve_layers(CurvesView curves, std::span<const Distances> heights,
                                           const OffsetOptions& options, double angle) {
  require_one_for_each_point(curves, heights);
  require_heights(heights, curves.positions.size());
  require_fan_angle(angle);
  OffsetOptions of_stages = with_call_progress(options);
  const auto grow = [&](CurvesView of, std::span<const Distances> to, int threads, Spacing spacing) {
    PreparedCurves prepared(of, of_stages,
                            plan_ribbon(of, of_stages, threads, farthest_of(to.last(1)), {.layers = to.size()}));
    return grow_on(prepared, to, spacing);
  };
  FannedCurveLayers result = in_arena(options.threads, [&](int threads) -> FannedCurveLayers {
    FannedCurves fanned;
    if (angle > 0) fanned = open_corners(curves, heights.back(), angle * std::numbers::pi / 180);
    if (fanned.origin.empty()) return {{}, grow(curves, heights, threads, Spacing::Even)};
    const std::vector<Distances> off_source = less_stand_off(copied_to(heights, fanned.origin));
    LayersResult layers = grow(fanned.curves.view(), off_source, threads, Spacing::Graded);
    put_on_source(curves, heights, fanned, layers);
    const bool is_full =
        std::all_of(layers.states.begin(), layers.states.end(), [](VertexState state) { return !falls_short(state); });
    FannedCurveLayers opened{std::move(fanned.curves), std::move(layers)};
    if (is_full) return opened;
    // Fans may have less room than what they take the place of. Memory has been asked for.
    of_stages.reserve = {};
    LayersResult plain = grow(curves, heights, threads, Spacing::Even);
    if (plain.statistics.faces.mean < opened.layers.statistics.faces.mean) return {{}, std::move(plain)};
    return opened;
  });
  // Those of the curves' points, which come first.
  count_states(std::span(result.layers.states).first(curves.positions.size()), result.layers.statistics);
  report_share(of_stages.progress, Stage::Measure, 1);
  return result;
}

}  // namespace vdb_offset
