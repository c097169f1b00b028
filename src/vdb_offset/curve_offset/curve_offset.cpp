#include "vdb_offset/curve_offset.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/base/stage_timer.h"
#include "vdb_offset/base/thread_count.h"
#include "vdb_offset/curve/curve_line.h"
#include "vdb_offset/curve_offset/curve_limit.h"
#include "vdb_offset/curve_offset/grow_curve_layers.h"
#include "vdb_offset/data/count_states.h"
#include "vdb_offset/error.h"
#include "vdb_offset/field/describe_field.h"
#include "vdb_offset/field/direction_field.h"
#include "vdb_offset/field/grid_plan.h"
#include "vdb_offset/field/rasterise.h"
#include "vdb_offset/field/sweep.h"
#include "vdb_offset/mesh/layer_heights.h"
#include "vdb_offset/paths/side_room.h"
#include "vdb_offset/validity/face_error.h"

namespace vdb_offset {
namespace {

/// The ribbon fills the voxel centres of one leaf node's height.
constexpr double kRibbonVoxels = kLeafWidth - 1;
// What a point takes in each layer: its places, beside what cells are made of it.
constexpr std::size_t kLayerPointBytes = 180;

/// The pipeline of curves: joined, stood up as a ribbon, then what surfaces go through.
class CurvePipeline {
 public:
  CurvePipeline(CurvesView curves, const OffsetOptions& options, int threads, std::size_t layers = 0)
      : curves_(curves), options_(options), layers_(layers), plane_(chains_in_plane(curves)) {
    shared_.threads = threads;
  }

  /// Facts and plan, of which all that follows makes use. False if nobody goes anywhere.
  bool prepare(std::span<const Distances> wanted) {
    Reach farthest{0, 0};
    for (const Distances& d : wanted)
      farthest = {std::max(farthest.inside, d.inward()), std::max(farthest.outside, d.outward())};
    shared_.facts = facts_of(curves_, plane_);
    const bool goes = farthest.inside > 0 || farthest.outside > 0;
    if (goes) stand_up(farthest, wanted.size());
    return goes;
  }
  const OffsetStatistics& statistics() const { return shared_; }

  std::vector<OffsetResult> run(std::span<const Distances> wanted) {
    std::vector<OffsetResult> results;
    if (!prepare(wanted)) {
      for (const Distances& d : wanted) results.push_back(unmoved(d));
      return results;
    }
    make_field();
    draw();
    std::vector<std::size_t> disagreeing(wanted.size(), 0);
    for (std::size_t i = 0; i < wanted.size(); ++i) distances_.push_back(on_line(wanted[i], disagreeing[i]));
    std::vector<Paths> paths = march(options_.collision == Collision::Merge ? Ridges::Sharp : Ridges::Smooth);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      results.push_back(finish(wanted[i], distances_[i], paths[i]));
      results[i].statistics.disagreeing_distances = disagreeing[i];
    }
    if (options_.keep_field) results.front().field = std::make_shared<DistanceField>(std::move(field_));
    return results;
  }

  LayersResult grow(std::span<const Distances> heights) {
    prepare(heights.last(1));
    make_field();
    draw();
    std::vector<Distances> on_points;
    for (const Distances& each : heights) {
      std::size_t disagreeing = 0;
      on_points.push_back(on_line(each, disagreeing));
      shared_.disagreeing_distances = std::max(shared_.disagreeing_distances, disagreeing);
    }
    distances_.push_back(on_points.back());
    std::vector<Paths> paths = march(Ridges::Smooth);
    const std::vector<double> marched = paths.front().achieved;
    OffsetStatistics statistics = shared_;
    limit(on_points.back(), paths.front(), statistics, Spacing::Even);
    LayerStack stack;
    {
      const StageTimer timer(statistics.seconds, Stage::Layers);
      const PlaneCurves plane{*query_, drawn_.source, on_points.back(), options_.precision};
      CurveFaults faults(plane);
      stack = stack_curves(plane, on_points, faults, paths.front(), options_.progress);
      statistics.limit.left = faults.count();
      statistics.limit.crossings_near_source = faults.crossings_near_source();
    }
    count_held_back(paths.front(), on_points.back(), marched, statistics.limit);
    statistics.room = room(on_points.back(), paths.front());
    return hand_over(std::move(statistics), on_points, paths.front(), stack);
  }

 private:
  std::size_t bytes_beside(std::size_t results) const {
    return plane_.points.size() * (layers_ * kLayerPointBytes + (options_.keep_paths ? results * kPathBytes : 0));
  }

  /// Puts the curves into a ribbon as high as the voxel size asks for.
  void stand_up(const Reach& farthest, std::size_t results) {
    const StageTimer timer(shared_.seconds, Stage::Rasterise);
    const MeshFacts& facts = shared_.facts;
    const VoxelSize chosen = choose_voxel_size(facts.median_edge, facts.diagonal,
                                               std::max(farthest.inside, farthest.outside), options_.grid);
    ribbon_ = build_surface(make_ribbon(plane_.chains.segments, plane_.points, kRibbonVoxels * chosen.size).view(), {});
    // The rims only stand for what goes on for ever.
    ribbon_.facts.boundary_left = 2 * plane_.chains.ends;
    GridOptions grid;
    grid.voxel_size = chosen.size;
    shared_.plan =
        plan_grid(ribbon_, farthest, grid, options_.max_memory, shared_.threads, {bytes_beside(results), true});
    shared_.plan.reason = chosen.reason;
  }

  /// The curves in the ribbon's frame, half way up.
  void draw() {
    const double middle = kRibbonVoxels / 2 * shared_.plan.voxel_size - ribbon_.origin[2];
    drawn_ = draw_line(plane_, ribbon_.origin, middle);
    query_.emplace(drawn_.line);
  }

  /// The distances of the line's vertices: points at one place go as one, by the mean.
  Distances on_line(const Distances& of_points, std::size_t& disagreeing) const {
    disagreeing = 0;
    if (of_points.uniform()) return of_points;
    std::vector<double> sum(drawn_.source.size(), 0.0);
    std::vector<std::uint32_t> copies(sum.size(), 0), apart(sum.size(), 0);
    for (std::uint32_t p = 0; p < plane_.points.size(); ++p) {
      if (drawn_.vertex[p] == kNone) continue;
      sum[drawn_.vertex[p]] += of_points[p];
      ++copies[drawn_.vertex[p]];
      apart[drawn_.vertex[p]] += of_points[p] != of_points[plane_.chains.place[p]];
    }
    for (std::uint32_t p = 0; p < plane_.points.size(); ++p) {
      if (drawn_.vertex[p] == kNone || plane_.chains.place[p] != p) continue;
      const auto v = drawn_.vertex[p];
      disagreeing += apart[v];
      sum[v] = apart[v] ? sum[v] / copies[v] : of_points[p];
    }
    return Distances(std::move(sum));
  }

  void make_field() {
    Front front;
    {
      const StageTimer timer(shared_.seconds, Stage::Rasterise);
      place(ribbon_, shared_.plan.voxel_size);
      front = rasterise(ribbon_, {shared_.plan.voxel_size, shared_.plan.band, true}, options_.progress);
    }
    const StageTimer timer(shared_.seconds, Stage::Sweep);
    field_ = sweep(std::move(front), ribbon_, {options_.solver, shared_.plan.reach}, options_.progress);
  }

  DirectionField find_directions() {
    const StageTimer timer(shared_.seconds, Stage::Gradient);
    DirectionField directions = make_directions(field_, !ribbon_.facts.closed() || !ribbon_.facts.oriented());
    describe_field(field_, directions, shared_);
    return directions;
  }

  std::vector<Paths> march(Ridges ridges) {
    const DirectionField directions = find_directions();
    const StageTimer timer(shared_.seconds, Stage::Propagate);
    std::vector<Paths> paths = propagate(*query_, directions, distances_, options_.progress,
                                         {options_.keep_paths ? Traces::Keep : Traces::Drop, ridges});
    for (Paths& each : paths) end_traces(each);
    return paths;
  }

  OffsetResult finish(const Distances& wanted, const Distances& distances, Paths& paths) {
    OffsetResult result;
    result.statistics = shared_;
    if (options_.collision == Collision::Limit) limit(distances, paths, result.statistics);
    result.statistics.room = room(distances, paths);
    result.statistics.interior = measure_segments(distances, paths);
    hand_over(distances, paths, result);
    if (wanted.uniform()) result.distances = wanted;
    return result;
  }

  void limit(const Distances& distances, Paths& paths, OffsetStatistics& statistics,
             Spacing spacing = Spacing::AsItIs) const {
    const StageTimer timer(statistics.seconds, Stage::Limit);
    statistics.limit =
        limit_curves({*query_, drawn_.source, distances, options_.precision}, paths, options_.progress, spacing);
  }

  /// Of open curves, where much falls short.
  SideRoom room(const Distances& distances, const Paths& paths) const {
    if (plane_.chains.ends == 0 || !falls_short(paths.state)) return {};
    return room_on_sides(*query_, distances);
  }

  /// How far off segments are at their middles, relative to what their ends are asked for.
  FaceInteriorError measure_segments(const Distances& distances, const Paths& paths) const {
    std::vector<double> errors(drawn_.line.segments.size(), -1);
    for_each_index(errors.size(), [&](std::size_t s) {
      const auto [a, b] = drawn_.line.segments[s];
      const double target = std::abs(distances[a] + distances[b]) / 2;
      if (target <= 1e-3 * distances.scale()) return;
      const Vec3d middle =
          (drawn_.line.vertices[a] + paths.displacement[a] + drawn_.line.vertices[b] + paths.displacement[b]) * 0.5;
      errors[s] = std::abs((*query_)(middle, static_cast<std::uint32_t>(s)).distance - target) / target;
    });
    std::erase(errors, -1);
    return sum_up_errors(std::move(errors));
  }

  void hand_over(const Distances& distances, const Paths& paths, OffsetResult& result) const {
    const std::size_t count = plane_.points.size();
    result.positions.assign(curves_.positions.begin(), curves_.positions.end());
    result.states.assign(count, VertexState::Unused);
    result.achieved.assign(count, 0.0);
    std::vector<double> asked(count, 0.0);
    for (std::uint32_t p = 0; p < count; ++p) {
      const auto v = drawn_.vertex[p];
      if (v == kNone) continue;
      const Vec3d& way = paths.displacement[v];
      if (way[0] != 0 || way[1] != 0) result.positions[p] += plane_.frame.to_space({way[0], way[1]});
      result.states[p] = paths.state[v];
      result.achieved[p] = paths.achieved[v];
      asked[p] = distances[v];
    }
    if (!paths.trace.empty()) hand_out_paths(paths, result);
    result.distances = Distances(std::move(asked));
    count_states(result.states, result.statistics);
  }

  void hand_out_paths(const Paths& paths, OffsetResult& result) const {
    const auto to_space = [&](const Vec3d& way) { return plane_.frame.to_space({way[0], way[1]}); };
    result.paths.resize(plane_.points.size());
    for_each_index(plane_.points.size(), [&](std::size_t p) {
      const auto v = drawn_.vertex[p];
      result.paths[p] = {curves_.positions[p]};
      if (v == kNone) return;
      std::vector<Vec3d> trace;
      for (const Vec3d& way : paths.trace[v]) trace.push_back(to_space(way));
      result.paths[p] = places_on_path(curves_.positions[p], trace, to_space(paths.displacement[v]));
    });
  }

  LayersResult hand_over(OffsetStatistics statistics, std::span<const Distances> heights, const Paths& paths,
                         const LayerStack& stack) const {
    OffsetResult outermost;
    outermost.statistics = std::move(statistics);
    hand_over(heights.back(), paths, outermost);
    LayersResult result;
    result.statistics = std::move(outermost.statistics);
    result.layer_statistics = stack.statistics;
    result.states = std::move(outermost.states);
    result.achieved = std::move(outermost.achieved);
    const std::size_t count = plane_.points.size();
    result.share.assign(count, 0.0);
    result.first_achieved.assign(count, 0.0);
    VertexStacks stacks(count, heights.size());
    std::vector<std::vector<double>> asked(heights.size(), std::vector<double>(count, 0.0));
    for (std::uint32_t p = 0; p < count; ++p) {
      const auto v = drawn_.vertex[p];
      const auto to = stacks.of(p);
      std::fill(to.begin(), to.end(), curves_.positions[p]);
      if (v == kNone) continue;
      result.share[p] = stack.share[v];
      result.first_achieved[p] = stack.first_achieved[v];
      const auto places = stack.stacks.of(v);
      for (std::size_t k = 0; k < heights.size(); ++k) {
        asked[k][p] = heights[k][v];
        if (stack.stacks.is_flat(v)) continue;
        const Vec3d way = places[k + 1] - places[0];
        to[k + 1] += plane_.frame.to_space({way[0], way[1]});
      }
    }
    std::vector<std::uint32_t> own(count);
    std::iota(own.begin(), own.end(), 0);
    result.stacks = SharedStacks(std::move(stacks), std::move(own));
    for (auto& each : asked) result.heights.emplace_back(std::move(each));
    return result;
  }

  /// A distance of 0 needs no field.
  OffsetResult unmoved(const Distances& distances) const {
    OffsetResult result;
    result.statistics = shared_;
    result.positions.assign(curves_.positions.begin(), curves_.positions.end());
    result.achieved.assign(plane_.points.size(), 0.0);
    for (const auto place : plane_.chains.place)
      result.states.push_back(place == kNone ? VertexState::Unused : VertexState::Reached);
    result.distances = distances;
    if (options_.keep_paths)
      for (const Vec3d& position : result.positions) result.paths.push_back({position});
    count_states(result.states, result.statistics);
    return result;
  }

  CurvesView curves_;
  const OffsetOptions& options_;
  std::size_t layers_;
  PlaneChains plane_;
  OffsetStatistics shared_;  // by all results
  Surface ribbon_;
  DrawnLine drawn_;
  std::vector<Distances> distances_;  // of the line's vertices, one set for each result
  DistanceField field_;
  std::optional<CurveQuery> query_;
};

void require_one_for_each_point(CurvesView curves, std::span<const Distances> distances) {
  for (const Distances& each : distances)
    if (!each.uniform() && each.count() != curves.positions.size())
      throw InvalidInput("offset: expected a distance for each of " + std::to_string(curves.positions.size()) +
                         " points, got " + std::to_string(each.count()));
}

std::vector<OffsetResult> offset_curves_in_metric(CurvesView curves, std::span<const Distances> distances,
                                                  const OffsetOptions& options) {
  const InMetric space(curves, options.metric);
  OffsetOptions even = options;
  even.metric = {};
  std::vector<OffsetResult> results = offset_curves(space.view(), distances, even);
  const MeshFacts facts = facts_of(curves, chains_in_plane(curves));
  for (OffsetResult& result : results) {
    for (std::size_t p = 0; p < result.positions.size(); ++p)
      result.positions[p] = space.moved(curves.positions[p], space.view().positions[p], result.positions[p]);
    for (auto& path : result.paths)
      for (Vec3d& place : path) place = options.metric.from(place);
    result.statistics.facts = facts;
  }
  return results;
}

}  // namespace

OffsetStatistics plan_curves(CurvesView curves, std::span<const Distances> distances, const OffsetOptions& options,
                             std::size_t layers) {
  const InMetric space(curves, options.metric);
  CurvePipeline pipeline(space.view(), options, thread_count(options.threads), layers);
  pipeline.prepare(distances);
  OffsetStatistics statistics = pipeline.statistics();
  if (!options.metric.even()) statistics.facts = facts_of(curves, chains_in_plane(curves));
  return statistics;
}

std::vector<OffsetResult> offset_curves(CurvesView curves, std::span<const Distances> distances,
                                        const OffsetOptions& options) {
  if (distances.empty()) throw InvalidInput("offset: expected a distance, got none");
  require_one_for_each_point(curves, distances);
  if (!options.metric.even()) return offset_curves_in_metric(curves, distances, options);
  const int threads = thread_count(options.threads);
  std::vector<OffsetResult> results;
  // An arena of its own keeps the number of threads a matter of this call alone.
  tbb::task_arena arena(threads);
  arena.execute([&] { results = CurvePipeline(curves, options, threads).run(distances); });
  return results;
}

LayersResult grow_curve_layers(CurvesView curves, std::span<const Distances> heights, const OffsetOptions& options) {
  require_one_for_each_point(curves, heights);
  require_heights(heights, curves.positions.size());
  const int threads = thread_count(options.threads);
  LayersResult result;
  tbb::task_arena arena(threads);
  arena.execute([&] { result = CurvePipeline(curves, options, threads, heights.size()).grow(heights); });
  return result;
}

}  // namespace vdb_offset
