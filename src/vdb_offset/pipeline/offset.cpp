#include "vdb_offset/offset.h"

#include "vdb_offset/base/progress_count.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/base/stage_timer.h"
#include "vdb_offset/base/thread_count.h"
#include "vdb_offset/data/count_states.h"
#include "vdb_offset/error.h"
#include "vdb_offset/field/describe_field.h"
#include "vdb_offset/field/direction_field.h"
#include "vdb_offset/field/grid_plan.h"
#include "vdb_offset/field/rasterise.h"
#include "vdb_offset/field/sweep.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/layers/growth_columns.h"
#include "vdb_offset/layers/surface_layer_grower.h"
#include "vdb_offset/limit/limit.h"
#include "vdb_offset/limit/warm_start.h"
#include "vdb_offset/mesh/layer_heights.h"
#include "vdb_offset/parts/border_facts.h"
#include "vdb_offset/parts/border_slide.h"
#include "vdb_offset/paths/side_room.h"
#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/sheets/sheet_sides.h"
#include "vdb_offset/validity/face_error.h"
#include "vdb_offset/validity/fault_finder.h"
#include "vdb_offset/validity/obstacle_facts.h"
#include "vdb_offset/validity/triangle_crossings.h"

namespace vdb_offset {
namespace {

// Triangles that the error between vertices is measured on.
constexpr std::size_t kInteriorTriangles = 10000;

// A frame for a mesh without any size.
constexpr double kLeastSize = 1e-100;

void require_one_each(PolygonView mesh, const Distances& distances) {
  if (!distances.uniform() && distances.count() != mesh.positions.size())
    throw InvalidInput("offset: expected a distance for each of " + std::to_string(mesh.positions.size()) +
                       " vertices, got " + std::to_string(distances.count()));
}

/// Clearances and thicknesses are lengths in the file.
void require_metric(const OffsetOptions& options) {
  if (!options.metric.even() && (options.obstacles.face_count() > 0 || options.off_source))
    throw InvalidInput("metric: expected neither obstacles nor a shell where axes count differently");
}

void require_clearance(const OffsetOptions& options) {
  if (!(options.clearance >= 0) || !std::isfinite(options.clearance))
    throw InvalidInput("clearance: expected a length >= 0, got " + std::to_string(options.clearance));
}

OffsetResult unmoved(PolygonView mesh) {
  OffsetResult result;
  result.positions.assign(mesh.positions.begin(), mesh.positions.end());
  result.states.assign(mesh.positions.size(), VertexState::Unused);
  result.achieved.assign(mesh.positions.size(), 0.0);
  return result;
}

/// Those of the front's vertices among the body's.
Distances distances_on_front(const MeshParts& parts, const Distances& of_body) {
  if (parts.front_vertex.empty() || of_body.uniform()) return of_body;
  std::vector<double> each(parts.front.vertices.size(), 0.0);
  for (std::size_t w = 0; w < parts.front_vertex.size(); ++w)
    if (parts.front_vertex[w] != kNone) each[parts.front_vertex[w]] = of_body[w];
  return Distances(std::move(each));
}

/// The front's paths as those of the body's vertices; who is not on the front stays, as was asked.
Paths paths_of_body(const MeshParts& parts, Paths of_front) {
  if (parts.front_vertex.empty()) return of_front;
  const std::size_t count = parts.front_vertex.size();
  Paths paths{std::vector<Vec3d>(count, Vec3d(0.0)), std::vector<double>(count, 0.0),
              std::vector<VertexState>(count, VertexState::Reached), std::vector<std::uint32_t>(count, kNone),
              of_front.straight};
  for (std::size_t w = 0; w < count; ++w) {
    const auto f = parts.front_vertex[w];
    if (f == kNone) continue;
    paths.displacement[w] = of_front.displacement[f];
    paths.achieved[w] = of_front.achieved[f];
    paths.state[w] = of_front.state[f];
    paths.closest[w] = of_front.closest[f];
  }
  if (of_front.trace.empty()) return paths;
  paths.trace.resize(count);
  for (std::size_t w = 0; w < count; ++w)
    if (parts.front_vertex[w] != kNone) paths.trace[w] = std::move(of_front.trace[parts.front_vertex[w]]);
  return paths;
}

/// Hands the surface vertices' paths to the input's vertices.
void move_vertices(PolygonView mesh, const Surface& surface, const Paths& paths, OffsetResult& result) {
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const auto w = surface.welded[v];
    if (w == kNone) continue;
    if (paths.displacement[w] != Vec3d(0.0))  // else it keeps its place, welded with a tolerance though it may be
      result.positions[v] = mesh.positions[surface.representative[w]] + paths.displacement[w];
    result.states[v] = paths.state[w];
    result.achieved[v] = paths.achieved[w];
  }
  result.statistics.straight_vertices = paths.straight;
}

void hand_out_paths(const Surface& surface, const std::vector<Vec3d>& source, const Paths& paths,
                    OffsetResult& result) {
  result.paths.resize(result.positions.size());
  for_each_index(result.paths.size(), [&](std::size_t v) {
    const auto w = surface.welded[v];
    if (w == kNone) result.paths[v] = {result.positions[v]};
    else result.paths[v] = places_on_path(source[w], paths.trace[w], paths.displacement[w]);
  });
}

/// How far any vertex goes on each side, for any of the distances.
Reach farthest_of(std::span<const Distances> distances) {
  Reach farthest{0, 0};
  for (const Distances& d : distances)
    farthest = {std::max(farthest.inside, d.inward()), std::max(farthest.outside, d.outward())};
  return farthest;
}

// What a vertex takes while a result in which much is held back is made valid; measured: up to 430.
constexpr std::size_t kLimitBytes = 500;

/// How much a run makes: so many results, or layers of cells under one.
struct Yield {
  std::size_t results = 1, layers = 0;
};

GridPlan plan(const MeshParts& parts, PolygonView mesh, const Reach& farthest, const OffsetOptions& options,
              int threads, const Yield& yield) {
  std::size_t beside = layers_bytes(mesh, yield.layers) + results_bytes(mesh, yield.results);
  for (const auto* surface : {&parts.whole, &parts.rest, &parts.obstacles})
    if (*surface) beside += surface_bytes(**surface);
  if (options.collision == Collision::Limit) beside += kLimitBytes * mesh.positions.size();
  if (options.keep_paths) beside += yield.results * kPathBytes * mesh.positions.size();
  return plan_grid(parts.front, farthest, options.grid, options.max_memory, threads, {beside});
}

bool goes_anywhere(const Reach& farthest) { return farthest.inside > 0 || farthest.outside > 0; }

/// The pipeline: surface, front, field, directions, paths, and what of them is valid.
class Pipeline {
 public:
  Pipeline(const InMetric& mesh, const OffsetOptions& options, int threads)
      : space_(mesh), mesh_(mesh.view()), options_(options), threads_(threads) {}

  std::vector<OffsetResult> run(std::span<const Distances> wanted) {
    const Reach farthest = farthest_of(wanted);
    prepare(farthest, {.results = wanted.size()});
    // The body is complete by now, obstacles and all.
    if (options_.off_source) junctions_ = find_junctions(parts_.front, mesh_, options_.only);
    std::vector<std::size_t> disagreeing(wanted.size(), 0);
    for (std::size_t i = 0; i < wanted.size(); ++i) asked_.push_back(on_body(wanted[i], disagreeing[i]));
    for (const Distances& asked : asked_) distances_.push_back(without_junctions(asked));
    std::vector<OffsetResult> results(wanted.size());
    if (goes_anywhere(farthest)) {
      make(results);
      if (options_.keep_field) results.front().field = std::make_shared<DistanceField>(std::move(field_));
    } else {
      if (parts_.obstacles)
        place(parts_, std::max(parts_.front.facts.diagonal, kLeastSize) / 256, options_.symmetry, 0);
      look_around();
      for (std::size_t i = 0; i < results.size(); ++i) results[i] = stay(distances_[i]);
    }
    for (std::size_t i = 0; i < results.size(); ++i) results[i].statistics.disagreeing_distances = disagreeing[i];
    return results;
  }

  /// Layers up to the last of the heights, which is the one that the march goes to.
  LayersResult grow(std::span<const Distances> heights, CellRules rules) {
    prepare(farthest_of(heights.last(1)), {.layers = heights.size()});
    std::vector<Distances> on_vertices;
    for (const Distances& each : heights) {
      std::size_t disagreeing = 0;
      on_vertices.push_back(on_body(each, disagreeing));
      shared_.disagreeing_distances = std::max(shared_.disagreeing_distances, disagreeing);
    }
    distances_.push_back(on_vertices.back());
    std::vector<Paths> paths = march(Ridges::Smooth);
    const std::vector<double> marched = paths.front().achieved;
    OffsetStatistics statistics = shared_;
    const ConstrainedSurface constrained =
        parts_.constrained(*query_, keep_away(), true, slides_ ? mesh_.face_count() : 0);
    const std::vector<Vec3d> source = parts_.source(mesh_);
    std::optional<FaultFinder> faults;
    {
      const StageTimer timer(statistics.seconds, Stage::Limit);
      faults.emplace(constrained, source, distances_.front(), options_.precision, source_crossings_);
      faults->move_to_ends(paths.front());
      statistics.limit = untangle(*faults, {constrained, source, distances_.front(), paths.front()}, options_.progress);
    }
    std::optional<GrowthColumns> columns;
    LayerStack stack;
    {
      const StageTimer timer(statistics.seconds, Stage::Layers);
      columns.emplace(mesh_, constrained, source, rules);
      stack = stack_layers(constrained, slides_ ? &*slides_ : nullptr, *columns, source, on_vertices, *faults,
                           paths.front(), options_.progress);
      round_layers(
          source, options_.precision, [&](std::uint32_t v) { return parts_.surface().representative[v] != kNone; },
          [&](std::uint32_t v, const Vec3d& place) -> std::optional<double> {
            if (!constrained.on_front(v)) return std::nullopt;
            return constrained.front(place - constrained.front.surface().origin, constrained.hint(v)).distance;
          },
          stack, paths.front());
    }
    statistics.limit.left = faults->count();
    statistics.limit.crossings_near_source = faults->crossings_near_source();
    count_held_back(paths.front(), distances_.front(), marched, statistics.limit);
    statistics.borders = borders(paths.front());
    statistics.room = room(paths.front(), distances_.front());
    if (surroundings_) {
      statistics.limit.source_crossings -= surroundings_->crossing();
      statistics.obstacles = surroundings_->facts(outermost(stack.stacks));
    }
    return hand_over(std::move(statistics), *columns, paths.front(), std::move(stack), on_vertices);
  }

 private:
  void prepare(const Reach& farthest, const Yield& yield) {
    {
      const StageTimer timer(shared_.seconds, Stage::Rasterise);
      parts_ = build_mesh_parts(mesh_, {options_.only, options_.obstacles, options_.weld, options_.orient});
    }
    shared_.facts = parts_.surface().facts;
    shared_.threads = threads_;
    if (goes_anywhere(farthest)) make_field(farthest, yield);
  }

  Distances on_body(const Distances& of_input, std::size_t& disagreeing) const {
    disagreeing = 0;
    return distances_on_body(parts_, options_.border, of_input, disagreeing);
  }

  bool is_junction(std::size_t vertex) const {
    if (junctions_.empty()) return false;
    const std::size_t on_front = parts_.front_vertex.empty() ? vertex : parts_.front_vertex[vertex];
    return on_front < junctions_.size() && junctions_[on_front];
  }

  /// Vertices at junctions stay.
  Distances without_junctions(const Distances& of_body) const {
    if (junctions_.empty()) return of_body;
    std::vector<double> each(parts_.surface().vertices.size());
    for (std::size_t w = 0; w < each.size(); ++w) each[w] = is_junction(w) ? 0 : of_body[w];
    return Distances(std::move(each));
  }

  /// They fall short, until a shell gives each sheet there a place of its own (see shell_of()).
  void tell_of_junctions(OffsetResult& result) const {
    if (junctions_.empty()) return;
    for (std::size_t v = 0; v < result.states.size(); ++v) {
      const auto w = parts_.surface().welded[v];
      if (w != kNone && is_junction(w) && result.distances[v] != 0) result.states[v] = VertexState::Limited;
    }
  }

  void make_field(const Reach& farthest, const Yield& yield) {
    Front front;
    {
      const StageTimer timer(shared_.seconds, Stage::Rasterise);
      shared_.plan = plan(parts_, mesh_, farthest, options_, threads_, yield);
      place(parts_, shared_.plan.voxel_size, options_.symmetry, std::max(farthest.inside, farthest.outside));
      front = rasterise(parts_.front, {shared_.plan.voxel_size, shared_.plan.band}, options_.progress);
    }
    const StageTimer timer(shared_.seconds, Stage::Sweep);
    field_ = sweep(std::move(front), parts_.front, {options_.solver, shared_.plan.reach}, options_.progress);
  }

  DirectionField find_directions() {
    const StageTimer timer(shared_.seconds, Stage::Gradient);
    const MeshFacts& facts = parts_.front.facts;
    DirectionField directions = make_directions(field_, !facts.closed() || !facts.oriented());
    describe_field(field_, directions, shared_);
    return directions;
  }

  /// One march for all distances.
  std::vector<Paths> march(Ridges ridges) {
    const DirectionField directions = find_directions();
    const StageTimer timer(shared_.seconds, Stage::Propagate);
    query_.emplace(parts_.front);
    look_around();
    std::vector<Distances> on_front;
    for (const Distances& distances : distances_) on_front.push_back(distances_on_front(parts_, distances));
    std::vector<Paths> paths = propagate(*query_, directions, on_front, keep_away(), options_.progress,
                                         {options_.keep_paths ? Traces::Keep : Traces::Drop, ridges});
    if (options_.border == Border::Slide && parts_.rest) slides_.emplace(parts_, *query_);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (slides_) slide_borders(parts_, *slides_, *query_, on_front[i], paths[i]);
      paths[i] = paths_of_body(parts_, std::move(paths[i]));
      if (surroundings_) surroundings_->hold(paths[i], distances_[i], parts_.bound);
      end_traces(paths[i]);
    }
    return paths;
  }

  /// How the input stands to obstacles.
  void look_around() {
    if (!parts_.obstacles) return;
    source_ = parts_.source(mesh_);
    surroundings_.emplace(parts_, source_, options_.clearance);
    source_crossings_ = SelfCrossings{surroundings_->source_crossings(), false, {}};
  }

  /// One of the results in the making.
  struct Draft {
    ConstrainedSurface constrained;
    const Distances& distances;
    const Distances& asked;
    Paths& paths;
    OffsetStatistics statistics;
    std::optional<FaultFinder> faults;  // if it has to be valid
    WarmStart precedent;                // if others follow it
  };

  /// A few at a time; those that others follow go first.
  void make(std::vector<OffsetResult>& results) {
    std::vector<Paths> paths = march(options_.collision == Collision::Merge ? Ridges::Sharp : Ridges::Smooth);
    source_ = parts_.source(mesh_);
    if (!space_.metric().even()) {
      file_source_ = parts_.source(space_.file());
      file_.emplace(FileFrame{space_, file_source_, {}});
    }
    const bool to_be_valid = options_.collision == Collision::Limit;
    if (results.size() > 1 && to_be_valid && !source_crossings_)
      source_crossings_ = CrossingFinder(parts_.surface(), file_ ? file_source_ : source_).listed();
    std::deque<Draft> drafts;
    for (std::size_t i = 0; i < results.size(); ++i)
      drafts.push_back({body_of_results(), distances_[i], asked_[i], paths[i], shared_, {}, {}});
    const std::size_t outer = results.size() - options_.inner_skin_last;
    if (options_.inner_skin_last) {
      look(drafts[outer], options_.progress);
      make_valid(drafts[outer], options_.progress, nullptr, nullptr);
      results[outer] = finish(drafts[outer]);
      keep_as_inner_skin(results[outer]);
      for (Draft& draft : drafts) draft.constrained.other_skin = inner_skin_;
    }
    std::vector<std::size_t> order(outer);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::vector<std::size_t> followed =
        to_be_valid ? find_warm_starts(std::span(distances_).first(outer)) : order;
    std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return followed[i] == i; });
    JointProgress progress(options_.progress, outer);
    const auto complete = [&](std::size_t i, const WarmStart* precedent) {
      const bool sets_one = std::count(followed.begin(), followed.end(), i) > 1;
      make_valid(drafts[i], progress.of(i), precedent, sets_one ? &drafts[i].precedent : nullptr);
      results[i] = finish(drafts[i]);
    };
    for (std::size_t first = 0; first < outer; first += kResultsTogether) {
      const auto some = std::span(order).subspan(first, std::min(kResultsTogether, outer - first));
      std::vector<std::uint8_t> waits(outer, 0);
      do_together(some, [&](std::size_t i) {
        look(drafts[i], progress.of(i));
        waits[i] = followed[i] != i && has_to_be_mended(drafts[i]);
        if (!waits[i]) complete(i, nullptr);
      });
      do_together(some, [&](std::size_t i) {
        if (waits[i]) complete(i, &drafts[followed[i]].precedent);
      });
    }
  }

  template <class Work>
  static void do_together(std::span<const std::size_t> results, Work&& parts) {
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
      // Who waits for work on one result is not to begin another meanwhile.
      tbb::this_task_arena::isolate([&] { parts(results[i]); });
    });
  }

  ConstrainedSurface body_of_results() const {
    ConstrainedSurface constrained = parts_.constrained(*query_, keep_away(), options_.off_source);
    constrained.with_rim = options_.off_source;
    constrained.file = file_ ? &*file_ : nullptr;
    return constrained;
  }

  /// What is wrong with a result, if it has to be valid.
  void look(Draft& draft, const ProgressCallback& callback) const {
    if (options_.collision != Collision::Limit) return;
    const Progress progress(callback, Stage::Limit, 1);  // tells that the stage has begun
    const StageTimer timer(draft.statistics.seconds, Stage::Limit);
    draft.faults.emplace(draft.constrained, source_, draft.distances, options_.precision, source_crossings_);
    draft.faults->move_to_ends(draft.paths);
  }

  static bool has_to_be_mended(const Draft& draft) {
    const auto& states = draft.paths.state;
    return draft.faults &&
           (draft.faults->any() || std::find(states.begin(), states.end(), VertexState::Collision) != states.end());
  }

  void make_valid(Draft& draft, const ProgressCallback& progress, const WarmStart* followed, WarmStart* set) const {
    if (!draft.faults) return;
    const StageTimer timer(draft.statistics.seconds, Stage::Limit);
    draft.statistics.limit =
        limit(*draft.faults, {draft.constrained, source_, draft.distances, draft.paths}, progress, followed, set);
    if (surroundings_) draft.statistics.limit.source_crossings -= surroundings_->crossing();
    draft.faults.reset();
  }

  /// What is told of a result, and handed out.
  OffsetResult finish(Draft& draft) const {
    OffsetResult result = unmoved(mesh_);
    result.statistics = draft.statistics;
    const Surface& surface = parts_.surface();
    move_vertices(mesh_, surface, draft.paths, result);
    if (options_.keep_paths) hand_out_paths(surface, source_, draft.paths, result);
    result.statistics.borders = borders(draft.paths);
    result.statistics.room = room(draft.paths, draft.distances);
    if (file_) bring_to_file(surface, result);
    result.distances = distances_of_input(surface, draft.asked);
    tell_of_junctions(result);
    const std::vector<Vec3d> places = as_written(draft.paths);
    {
      const StageTimer timer(result.statistics.seconds, Stage::Measure);
      if (surroundings_) result.statistics.obstacles = surroundings_->facts(as_written(draft.paths));
      result.statistics.interior = measure_interior(draft.constrained, places, draft.distances, kInteriorTriangles);
    }
    return result;
  }

  /// Of what is open, where much falls short.
  SideRoom room(const Paths& of_body, const Distances& distances) const {
    if (parts_.front.facts.closed() || !falls_short(of_body.state)) return {};
    return room_on_sides(*query_, distances_on_front(parts_, distances));
  }

  BorderFacts borders(const Paths& of_body) const {
    if (parts_.front_vertex.empty()) return border_facts(parts_.front, of_body.displacement, {});
    std::vector<Vec3d> way(parts_.front.vertices.size(), Vec3d(0.0));
    std::vector<std::uint8_t> sliding(way.size(), 0);
    for (std::size_t w = 0; w < parts_.front_vertex.size(); ++w) {
      const auto f = parts_.front_vertex[w];
      if (f == kNone) continue;
      way[f] = of_body.displacement[w];
      sliding[f] = slides_ && parts_.at_border[w];
    }
    return border_facts(parts_.front, way, sliding);
  }

  /// Positions and paths are the file's; so are the facts of the mesh.
  void bring_to_file(const Surface& surface, OffsetResult& result) const {
    const PolygonView file = space_.file();
    for (std::size_t v = 0; v < result.positions.size(); ++v) {
      const auto w = surface.welded[v];
      if (result.positions[v] == mesh_.positions[v]) {
        result.positions[v] = file.positions[v];
      } else if (w != kNone) {
        const auto first = surface.representative[w];
        result.positions[v] = space_.moved(file.positions[first], mesh_.positions[first], result.positions[v]);
      }
    }
    for (auto& path : result.paths)
      for (Vec3d& place : path) place = space_.metric().from(place);
    result.statistics.facts = build_surface(file, options_.weld, options_.orient).facts;
  }

  std::vector<Vec3d> as_written(const Paths& paths) const {
    std::vector<Vec3d> places = source_;
    const auto& of_mesh = parts_.surface().representative;
    for (std::size_t w = 0; w < places.size(); ++w)
      if (w < of_mesh.size() && of_mesh[w] != kNone)
        places[w] = Rounding(options_.precision)(places[w], places[w] + paths.displacement[w]);
    return places;
  }

  /// As it will be written.
  void keep_as_inner_skin(const OffsetResult& result) {
    const Surface& surface = parts_.surface();
    inner_skin_ = source_;
    for (std::size_t w = 0; w < inner_skin_.size(); ++w) {
      const auto v = surface.representative[w];
      if (v != kNone) inner_skin_[w] = Rounding(options_.precision)(source_[w], result.positions[v]);
    }
  }

  /// Vertices share the stacks of the surface's, but for those that stand elsewhere: what no face uses, or has been
  /// welded with a tolerance, which keeps its place on the wall, and in all layers if it is flat.
  SharedStacks stacks_of_input(VertexStacks of_surface) const {
    std::vector<std::uint32_t> stack = parts_.surface().welded, elsewhere;
    for (std::uint32_t v = 0; v < stack.size(); ++v)
      if (stack[v] == kNone || of_surface.of(stack[v])[0] != mesh_.positions[v]) elsewhere.push_back(v);
    if (elsewhere.empty()) return {std::move(of_surface), std::move(stack)};
    const std::size_t of_the_surface = of_surface.vertices();
    VertexStacks all(of_the_surface + elsewhere.size(), of_surface.layers());
    for_each_index(of_the_surface, [&](std::size_t w) {
      std::copy(of_surface.of(w).begin(), of_surface.of(w).end(), all.of(w).begin());
    });
    for (std::size_t i = 0; i < elsewhere.size(); ++i) {
      const std::uint32_t v = elsewhere[i], w = stack[v];
      const auto own = all.of(of_the_surface + i);
      if (w == kNone || of_surface.is_flat(w)) std::fill(own.begin(), own.end(), mesh_.positions[v]);
      else std::copy(of_surface.of(w).begin(), of_surface.of(w).end(), own.begin());
      own[0] = mesh_.positions[v];
      stack[v] = static_cast<std::uint32_t>(of_the_surface + i);
    }
    return {std::move(all), std::move(stack)};
  }

  /// Layers as those of the input's vertices and faces.
  LayersResult hand_over(OffsetStatistics statistics, const GrowthColumns& columns, const Paths& paths,
                         LayerStack stack, std::span<const Distances> heights) const {
    const Surface& surface = parts_.surface();
    const std::size_t count = mesh_.positions.size();
    LayersResult result;
    result.statistics = std::move(statistics);
    result.layer_statistics = stack.statistics;
    result.states.assign(count, VertexState::Unused);
    result.achieved.assign(count, 0.0);
    result.share.assign(count, 0.0);
    result.first_achieved.assign(count, 0.0);
    for_each_index(count, [&](std::size_t v) {
      const auto w = surface.welded[v];
      if (w == kNone) return;
      result.states[v] = paths.state[w];
      result.achieved[v] = paths.achieved[w];
      result.share[v] = stack.share[w];
      result.first_achieved[v] = stack.first_achieved[w];
    });
    result.stacks = stacks_of_input(std::move(stack.stacks));
    result.place = first_at_place(surface);
    for (const Distances& each : heights) result.heights.push_back(distances_of_input(surface, each));
    result.carries.assign(mesh_.face_count(), 1);
    for (std::size_t f = 0; f < options_.only.size(); ++f) result.carries[f] = options_.only[f] != 0;
    for (const auto f : columns.without_area()) result.carries[f] = 0;
    for (const auto& [f, from] : columns.split_quads()) result.carries[f] = static_cast<std::uint8_t>(2 + from);
    return result;
  }

  static std::vector<Vec3d> outermost(const VertexStacks& stacks) {
    std::vector<Vec3d> places;
    places.reserve(stacks.vertices());
    for (std::size_t w = 0; w < stacks.vertices(); ++w) places.push_back(stacks.of(w).back());
    return places;
  }

  /// A distance of 0 needs no field: every vertex in use is where it should be.
  OffsetResult stay(const Distances& distances) const {
    OffsetResult result = unmoved(mesh_);
    result.statistics = shared_;
    if (surroundings_) result.statistics.obstacles = surroundings_->facts(source_);
    result.distances = distances_of_input(parts_.surface(), distances);
    for (std::size_t v = 0; v < result.states.size(); ++v)
      if (parts_.surface().welded[v] != kNone) result.states[v] = VertexState::Reached;
    if (options_.keep_paths)
      for (const Vec3d& position : result.positions) result.paths.push_back({position});
    return result;
  }

  const Obstacles* keep_away() const { return surroundings_ ? &surroundings_->obstacles() : nullptr; }

  const InMetric& space_;
  PolygonView mesh_;  // in that space
  const OffsetOptions& options_;
  int threads_;
  OffsetStatistics shared_;  // by all results
  MeshParts parts_;
  std::vector<std::uint8_t> junctions_;  // of the front's vertices, for shells; empty if there is none
  std::vector<Distances> asked_,
      distances_;  // of the body's vertices, one set for each result; 0 at junctions in these
  DistanceField field_;
  std::optional<ClosestQuery> query_;
  std::optional<Surroundings> surroundings_;  // if there are obstacles
  std::optional<BorderSlides> slides_;
  std::vector<Vec3d> file_source_;  // where they stand in the file, if distances are measured in another space
  std::optional<FileFrame> file_;
  std::vector<Vec3d> source_;                      // where the body's vertices stand, world coordinates
  std::optional<SelfCrossings> source_crossings_;  // that all of several results are compared with
  std::vector<Vec3d> inner_skin_;                  // of the body's vertices, once it is made
};

}  // namespace

std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                         const OffsetOptions& options) {
  if (distances.empty()) throw InvalidInput("offset: expected a distance, got none");
  for (const Distances& each : distances) require_one_each(mesh, each);
  require_clearance(options);
  require_metric(options);
  const int threads = thread_count(options.threads);
  const InMetric in_metric(mesh, options.metric);
  std::vector<OffsetResult> results;
  // An arena of its own keeps the number of threads a matter of this call alone.
  tbb::task_arena arena(threads);
  arena.execute([&] { results = Pipeline(in_metric, options, threads).run(distances); });
  for (OffsetResult& result : results) count_states(result.states, result.statistics);
  return results;
}

LayersResult grow_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                         CellRules rules) {
  for (const Distances& each : heights) require_one_each(mesh, each);
  require_heights(heights, mesh.positions.size());
  require_clearance(options);
  if (!options.metric.even()) throw InvalidInput("metric: expected one in which all axes count alike, for layers");
  const int threads = thread_count(options.threads);
  const InMetric in_metric(mesh, options.metric);
  LayersResult result;
  tbb::task_arena arena(threads);
  arena.execute([&] { result = Pipeline(in_metric, options, threads).grow(heights, rules); });
  count_states(result.states, result.statistics);
  return result;
}

OffsetResult offset(PolygonView mesh, const OffsetOptions& options) {
  return std::move(offset_several(mesh, {&options.distance, 1}, options).front());
}

OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options) {
  return plan_several(mesh, {&options.distance, 1}, options);
}

OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options,
                              std::size_t layers) {
  OffsetStatistics statistics;
  statistics.threads = thread_count(options.threads);
  const InMetric in_metric(mesh, options.metric);
  const MeshParts parts =
      build_mesh_parts(in_metric.view(), {options.only, options.obstacles, options.weld, options.orient});
  statistics.facts = parts.surface().facts;
  const Reach farthest = farthest_of(distances);
  if (goes_anywhere(farthest))
    statistics.plan = plan(parts, in_metric.view(), farthest, options, statistics.threads, {distances.size(), layers});
  return statistics;
}

}  // namespace vdb_offset
