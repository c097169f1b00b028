// SPDX-License-Identifier: Apache-2.0
// Prepares a mesh for all results of a run, and finds the paths of its vertices. Faces are sorted into what moves, what
// stays and obstacles; if a vertex moves, the grid is planned within the memory allowed, the mesh goes into its local
// frame, and the field is made. march() leads the moving part's vertices through the directions, has borders slide and
// obstacles hold what touches them, and finds miters. marched_to() needs no field, and puts vertices to given targets.
// Paths are those of all vertices; what is not on the moving part stays, and has reached what it was asked. The other
// functions collect what a result must keep to, and what became of borders. Faults are not looked for here.
#include "products/offset/prepared_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "ground/numbers/rounding.h"
#include "ground/system/assert.h"
#include "ground/system/call_progress.h"
#include "ground/system/memory.h"
#include "ground/system/stage_timer.h"
#include "motion/parts/border_facts.h"
#include "motion/parts/part_miters.h"
#include "products/offset/moved_input.h"
#include "products/offset/vertex_targets.h"
#include "space/field/grid_plan.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The paths of all vertices from those of the moving part's; all other vertices stay, as was asked.
Paths paths_of_all(const MeshParts& parts, Paths of_part) {
  if (parts.part_vertex.empty()) return of_part;
  const std::size_t count = parts.part_vertex.size();
  Paths paths{std::vector<Vec3d>(count, Vec3d(0.0)), std::vector<double>(count, 0.0),
              std::vector<VertexState>(count, VertexState::Reached), std::vector<std::uint32_t>(count, kNone),
              of_part.straight};
  for (std::size_t w = 0; w < count; ++w) {
    const auto f = parts.part_vertex[w];
    if (f == kNone) continue;
    paths.displacement[w] = of_part.displacement[f];
    paths.achieved[w] = of_part.achieved[f];
    paths.state[w] = of_part.state[f];
    paths.closest[w] = of_part.closest[f];
  }
  if (of_part.trace.empty()) return paths;
  paths.trace.resize(count);
  for (std::size_t w = 0; w < count; ++w)
    if (parts.part_vertex[w] != kNone) paths.trace[w] = std::move(of_part.trace[parts.part_vertex[w]]);
  return paths;
}

// Seconds that layers take for each vertex, and for each of its layers. Measured on scans of 60,000 to 200,000
// triangles with 1 to 20 layers.
constexpr double kLayersVertex = 2e-6, kLayerVertex = 6e-7;

// What making a result valid is reckoned to take for each vertex before it is known whether anything is faulty: with
// it, about half of a run is shown as done by then.
constexpr double kMendLikely = 1.5e-5;

bool is_open(const MeshFacts& facts) { return !facts.closed() || !facts.oriented(); }

/// What the run takes besides its grid and the moving part.
RunBytes bytes_of_run(const MeshParts& parts, PolygonView mesh, const OffsetOptions& options, const Yield& yield) {
  const Surface& surface = parts.surface();
  RunBytes bytes{options.bytes_held, result_bytes(surface) + further_bytes(mesh.positions.size(), yield.results) +
                                         layers_bytes(mesh, surface, yield.layers)};
  for (const auto* more : {&parts.whole, &parts.rest, &parts.obstacles})
    if (*more) bytes.always += surface_bytes(**more);
  // What is found near obstacles, and the whole of mesh and obstacles as it is judged.
  if (parts.obstacles) bytes.after_grid += 2 * surface_bytes(*parts.obstacles);
  if (options.exact) bytes.always += exact_bytes(mesh.positions.size());
  if (options.keep_paths) bytes.after_grid += paths_bytes(mesh.positions.size(), yield.results);
  if (options.off_source) bytes.after_grid += shell_bytes(mesh, surface);
  if (yield.has_targets) bytes.after_grid += refinement_bytes(mesh, surface);
  return bytes;
}

/// What is left of a run once the mesh is sorted into parts.
StageSeconds seconds_after_parts(const GridPlan& plan, double vertices, const Yield& yield) {
  StageSeconds seconds = expected_seconds(static_cast<double>(plan.leaf_nodes), 0, vertices);
  const auto results = static_cast<double>(yield.results), layers = static_cast<double>(yield.layers);
  seconds[static_cast<std::size_t>(Stage::Limit)] += vertices * kMendLikely;
  for (const Stage stage : {Stage::Propagate, Stage::Limit, Stage::Measure})
    seconds[static_cast<std::size_t>(stage)] *= results;
  seconds[static_cast<std::size_t>(Stage::Layers)] = vertices * (kLayersVertex + layers * kLayerVertex);
  return seconds;
}

}  // namespace

void require_usable(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options) {
  for (const Distances& each : distances)
    if (!each.uniform() && each.count() != mesh.positions.size())
      throw InvalidInput("offset: expected a distance for each of " + std::to_string(mesh.positions.size()) +
                         " vertices, got " + std::to_string(each.count()));
  if (!(options.clearance >= 0) || !std::isfinite(options.clearance))
    throw InvalidInput("clearance: expected a length >= 0, got " + std::to_string(options.clearance));
  if (options.corners == Corners::Arc)
    throw InvalidInput("corners: expected miter or round, as only an offset to a tolerance has faces for arcs");
  if (!(options.taper >= 0) || !std::isfinite(options.taper))
    throw InvalidInput("taper: expected a number >= 0, got " + std::to_string(options.taper));
}

GridPlan plan_run(const MeshParts& parts, PolygonView mesh, const Reach& farthest, const OffsetOptions& options,
                  int threads, const Yield& yield) {
  const MeshFacts& facts = parts.moving_part.facts;
  const double rounding = Rounding(options.precision).half_unit() * farthest_coordinate(facts);
  require_fine_coordinates(rounding, std::max(farthest.inside, farthest.outside), "the distance");
  require_fine_coordinates(rounding, facts.diagonal, "the mesh's diagonal");
  return plan_grid(parts.moving_part, farthest, options.grid, options.max_memory, threads,
                   {bytes_of_run(parts, mesh, options, yield), !yield.has_targets});
}

WeldOptions weld_for(const OffsetOptions& options, const Yield& yield) {
  // Hanging vertices are not joined for layers, as cells need whole faces, nor for parts, as the moving side would be
  // split and the resting side not.
  return options.only.empty() && yield.layers == 0 && !yield.by_corner ? options.weld : options.weld.without_joins();
}

PreparedMesh::PreparedMesh(const InMetric& space, const OffsetOptions& options, int threads, const Reach& farthest,
                           const Yield& yield)
    : space_(space),
      mesh_(space.view()),
      options_(options),
      corners_(options.corners.value_or(yield.layers > 0 ? Corners::Round : Corners::Miter)),
      measured_faces_(yield.measured_faces) {
  const bool moves = goes_anywhere(farthest);
  GridPlan plan;
  const auto corners = static_cast<double>(mesh_.corners.size()), faces = static_cast<double>(mesh_.face_count()),
             vertices = static_cast<double>(mesh_.positions.size());
  expect_stages(options.progress, expected_seconds(0, corners - 2 * faces, vertices));
  report_share(options.progress, Stage::Rasterise, 0);
  {
    const StageTimer timer(statistics_.seconds, Stage::Rasterise);
    parts_ = build_mesh_parts(mesh_, {options.only, options.obstacles, weld_for(options, yield), options.orient});
    statistics_.facts = parts_.surface().facts;
    statistics_.threads = threads;
    if (moves) {
      plan = plan_run(parts_, mesh_, farthest, options, threads, yield);
      to_local_frame(parts_, plan.voxel_size, options.symmetry, std::max(farthest.inside, farthest.outside),
                     yield.layers > 0 ? PartEdges::KeepPlanes : PartEdges::FollowFaces);
    } else if (parts_.obstacles) {
      to_local_frame(parts_, frame_voxel_size(parts_.moving_part.facts), options.symmetry, 0);
    }
  }
  statistics_.plan = plan;
  report_share(options.progress, Stage::Rasterise, 1);
  expect_stages(options.progress, seconds_after_parts(plan, vertices, yield));
  if (moves) reserve_memory(options.reserve, plan.bytes);
  if (moves && !yield.has_targets) field_ = make_field(parts_.moving_part, plan, false, options, statistics_);
  const StageTimer timer(statistics_.seconds, moves ? Stage::Propagate : Stage::Rasterise);
  if (moves) query_.emplace(parts_.moving_part, yield.measured_faces);
  if (moves && options.exact && options.metric.even())
    exact_.emplace(*options.exact, mesh_, options.only, parts_.moving_part);
  if (moves || parts_.obstacles) source_ = parts_.source(mesh_);
  if (parts_.obstacles) surroundings_.emplace(parts_, source_, options.clearance);
  if (moves && options.border == Border::Slide && parts_.rest) slides_.emplace(parts_, *query_);
  has_edge_miters_ = slides_ && yield.layers == 0;
}

std::optional<SelfCrossings> PreparedMesh::known_crossings() const {
  if (!surroundings_) return std::nullopt;
  return SelfCrossings{surroundings_->source_crossings(), false, {}};
}

Distances PreparedMesh::distances_of_all(const Distances& of_input, std::size_t& disagreeing) const {
  disagreeing = 0;
  return distances_on_parts(parts_, options_.border, of_input, disagreeing);
}

std::vector<PreparedMesh::Marched> PreparedMesh::march(std::span<const Distances> distances, Ridges ridges) {
  std::vector<Distances> on_part;
  for (const Distances& each : distances) on_part.push_back(distances_of_part(parts_, each));
  std::vector<Paths> of_part = find_paths(on_part, ridges);
  const StageTimer timer(statistics_.seconds, Stage::Propagate);
  std::vector<Marched> marched;
  for (std::size_t i = 0; i < of_part.size(); ++i)
    hold(distances[i], marched.emplace_back(of_all(on_part[i], std::move(of_part[i]))));
  // Paths along sharp ridges are what is asked for: they end where those do.
  const bool on_creases = corners_ == Corners::Miter || ridges == Ridges::Smooth || exact_;
  if (on_creases || has_edge_miters_) miter(on_part, marched, on_creases);
  return marched;
}

/// Gives vertices on creases their miters, or with Corners::Round those whose ends are at the distance; and border
/// vertices of a part that slide theirs where the moved faces meet those that stay.
void PreparedMesh::miter(std::span<const Distances> on_part, std::span<Marched> marched, bool on_creases) {
  const bool may_go_farther = corners_ == Corners::Miter;
  const std::vector<MiterWalls> walls =
      may_go_farther ? walls_at_edge(parts_, options_.border) : std::vector<MiterWalls>();
  std::optional<MiterFinder<ClosestQuery>> miters;
  if (on_creases) {
    miters.emplace(*query_, corners_, options_.miter_limit, obstacles(), std::span<const MiterWalls>(walls), exact());
    on_crease_ = miters->on_crease();
  }
  for (std::size_t i = 0; i < marched.size(); ++i) {
    Marched& each = marched[i];
    MiterFacts facts;
    const auto own = OwnDistances::of(on_part[i], mesh_, options_.only, parts_.moving_part);
    const OwnDistances* const own_distances = own ? &*own : nullptr;
    std::vector<Miter> found;
    if (miters) found = miters_of_all(parts_, (*miters)(on_part[i], facts, own_distances));
    // What is bound to its path stays there, but for the edge of a part where that slides.
    facts.unproven += std::erase_if(found, [&](const Miter& miter) {
      const std::uint32_t v = miter.vertex;
      const bool slides = slides_ && parts_.at_border[v] && each.paths.displacement[v] != Vec3d(0.0);
      return !each.bound.empty() && each.bound[v] && !slides;
    });
    if (has_edge_miters_)
      found = with_edge_miters(parts_, *slides_, std::move(found),
                               edge_miters_of(parts_, *slides_, *query_, on_part[i], own_distances), walls);
    each.mitered = MiteredPaths(found, each.paths);
    if (!may_go_farther) continue;
    each.miters = std::move(found);
    each.miter_facts = facts;
  }
}

PreparedMesh::Marched PreparedMesh::marched_to(const Distances& distances, const VertexTargets& targets) {
  const StageTimer timer(statistics_.seconds, Stage::Propagate);
  const std::size_t count = surface().vertices.size();
  Marched marched;
  marched.paths = {std::vector<Vec3d>(count, Vec3d(0.0)),
                   std::vector<double>(count, 0.0),
                   std::vector<VertexState>(count, VertexState::Reached),
                   std::vector<std::uint32_t>(count, kNone),
                   0,
                   {}};
  std::vector<std::uint32_t> moving;
  std::vector<Vec3d> ends;
  for (std::uint32_t w = 0; w < count; ++w) {
    const std::uint32_t v = surface().representative[w];
    const bool on_part = parts_.part_vertex.empty() || parts_.part_vertex[w] != kNone;
    if (v == kNone || !on_part || distances[w] == 0) continue;
    const Vec3d displacement = round_displacement(targets.displacement[v], std::abs(distances[w]));
    marched.paths.displacement[w] = displacement;
    moving.push_back(w);
    ends.push_back((surface().vertices[w] + surface().origin) + displacement - surface().origin);
  }
  const std::vector<Closest> closest = closest_points(*query_, ends);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const std::uint32_t w = moving[i];
    const double asked = std::abs(distances[w]), off = closest[i].distance - asked,
                 most = kReachedTolerance * asked + vertex_error_at(targets.vertex_error, asked);
    const VertexState state = targets.state[surface().representative[w]];
    marched.paths.achieved[w] = closest[i].distance;
    marched.paths.closest[w] = closest[i].triangle;
    marched.paths.state[w] = std::abs(off) <= most ? VertexState::Reached
                             : falls_short(state)  ? state
                                                   : VertexState::Limited;
    if (off > 0 && (state == VertexState::Mitered || state == VertexState::Cut))
      marched.miters.push_back(
          {w, marched.paths.displacement[w], closest[i].distance, 0, closest[i].triangle, state, 0});
  }
  bring_to_distance(distances, marched);
  marched.bound = std::exchange(parts_.bound, {});
  hold(distances, marched);
  marched.miter_facts.on_creases = marched.miters.size();
  marched.vertex_error = targets.vertex_error;
  marched.mitered = MiteredPaths(marched.miters, marched.paths);
  return marched;
}

/// Gives mitered vertices the paths that they have where they give their miters up: back towards what is closest, to
/// their distance.
void PreparedMesh::bring_to_distance(const Distances& distances, Marched& marched) const {
  for (const Miter& miter : marched.miters) {
    const Vec3d x = surface().vertices[miter.vertex] + miter.displacement;
    const double asked = std::abs(distances[miter.vertex]);
    const Vec3d back = (parts_.moving_part.closest_on(miter.closest, x).point - x) * (1 - asked / miter.distance);
    marched.paths.displacement[miter.vertex] = round_displacement(miter.displacement + back, asked);
    marched.paths.achieved[miter.vertex] = asked;
    marched.paths.state[miter.vertex] = VertexState::Reached;
  }
}

/// The paths of the moving part's vertices for some sets of their distances.
std::vector<Paths> PreparedMesh::find_paths(std::span<const Distances> on_part, Ridges ridges) {
  VDB_OFFSET_ASSERT(query_.has_value());
  VDB_OFFSET_ASSERT(std::all_of(on_part.begin(), on_part.end(), [&](const Distances& each) {
    return each.uniform() || each.count() == parts_.moving_part.vertices.size();
  }));
  const DirectionField directions = find_directions(field_, is_open(parts_.moving_part.facts), statistics_);
  const StageTimer timer(statistics_.seconds, Stage::Propagate);
  std::vector<Paths> paths =
      propagate(*query_, directions, on_part, obstacles(), options_.progress, march_options(options_, ridges));
  VDB_OFFSET_ASSERT(paths.size() == on_part.size());
  return paths;
}

/// The paths of all vertices, and which of these are bound.
PreparedMesh::Marched PreparedMesh::of_all(const Distances& on_part, Paths of_part) {
  if (slides_) slide_borders(parts_, *slides_, *query_, on_part, of_part);
  Marched marched;
  marched.paths = paths_of_all(parts_, std::move(of_part));
  marched.bound = std::exchange(parts_.bound, {});  // what is bound at one distance may be free at another
  return marched;
}

/// Has obstacles hold what touches them, once all paths are known.
void PreparedMesh::hold(const Distances& distances, Marched& marched) const {
  if (surroundings_) surroundings_->hold(marched.paths, distances, marched.bound);
  end_traces(marched.paths);
}

ConstrainedSurface PreparedMesh::constrained(const Marched& marched, bool off_source, std::size_t resting_faces) const {
  VDB_OFFSET_ASSERT(query_ && marched.paths.displacement.size() == surface().vertices.size());
  VDB_OFFSET_ASSERT(marched.bound.empty() || marched.bound.size() == surface().vertices.size());
  ConstrainedSurface constrained = parts_.constrained(*query_, obstacles(), off_source, resting_faces);
  constrained.bound = marched.bound;
  constrained.farther = marched.mitered.farther();
  constrained.nearer = marched.mitered.nearer();
  constrained.on_crease = on_crease_;
  constrained.vertex_error = marched.vertex_error;
  return constrained;
}

SideRoom PreparedMesh::room(const Paths& paths, const Distances& distances, bool closed_too) const {
  return room_beside(*query_, !closed_too && parts_.moving_part.facts.closed(), paths.state,
                     [&] { return distances_of_part(parts_, distances); });
}

BorderFacts PreparedMesh::borders(const Paths& paths) const {
  if (parts_.part_vertex.empty()) return border_facts(parts_.moving_part, paths.displacement, {});
  std::vector<Vec3d> displacement(parts_.moving_part.vertices.size(), Vec3d(0.0));
  std::vector<std::uint8_t> sliding(displacement.size(), 0);
  for (std::size_t w = 0; w < parts_.part_vertex.size(); ++w) {
    const auto f = parts_.part_vertex[w];
    if (f == kNone) continue;
    displacement[f] = paths.displacement[w];
    sliding[f] = slides_ && parts_.at_border[w];
  }
  return border_facts(parts_.moving_part, displacement, sliding);
}

}  // namespace vdb_offset
