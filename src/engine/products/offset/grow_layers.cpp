// SPDX-License-Identifier: Apache-2.0
// Grows layers on a mesh: heights go in, stacks of positions for each vertex of the input come out. One march goes to
// the outermost heights. Miters with faults are taken back there, and folds are untangled, but nothing is pulled back
// yet. The columns of cells are set on the faces, and stack_layers() puts all other layers in between and thins them
// until cells and the outermost surface are valid. Layers are then rounded to what the file keeps, and distances and
// errors are measured on that. Vertices that are welded share one stack, but for those that stand elsewhere or are in
// no face. Cells are not made here (see products/cells), and distances by axis are refused.
#include "products/offset/grow_layers.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "ground/distances/layer_heights.h"
#include "ground/mesh/count_states.h"
#include "ground/system/assert.h"
#include "ground/system/call_progress.h"
#include "ground/system/parallel.h"
#include "ground/system/stage_timer.h"
#include "products/layers/growth_columns.h"
#include "products/layers/spread_ends.h"
#include "products/layers/surface_layer_grower.h"
#include "products/offset/faulty_miters.h"
#include "valid/faults/face_error.h"
#include "valid/faults/fault_finder.h"
#include "valid/limit/limit.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// Rounds the layers to what the file keeps, and measures their distances there.
void round_to_file(const PreparedMesh& mesh, const ConstrainedSurface& constrained, LayerStack& stack, Paths& paths) {
  round_layers(
      mesh.source(), mesh.options().precision,
      [&](std::uint32_t v) { return mesh.surface().representative[v] != kNone; },
      [&](std::uint32_t v, const Vec3d& position) -> std::optional<double> {
        if (!constrained.vertex_on_part(v)) return std::nullopt;
        return constrained.moving_part(position - constrained.moving_part.surface().origin, constrained.hint(v))
            .distance;
      },
      stack, paths);
}

std::vector<Vec3d> surface_of(const VertexStacks& stacks, std::size_t layer) {
  std::vector<Vec3d> positions;
  positions.reserve(stacks.vertices());
  for (std::size_t w = 0; w < stacks.vertices(); ++w) positions.push_back(stacks.of(w)[layer]);
  return positions;
}

/// Measures the faces of the outermost surface, and of that at the first height, and what is left to obstacles.
void measure_surfaces(const PreparedMesh& mesh, const ConstrainedSurface& constrained,
                      std::span<const Distances> heights, const Paths& paths, LayerStack& stack,
                      OffsetStatistics& statistics) {
  const StageTimer timer(statistics.seconds, Stage::Measure);
  const std::vector<Vec3d> outermost = surface_of(stack.stacks, heights.size());
  const auto measure = [&](std::span<const Vec3d> positions, const Distances& height) {
    return measure_faces({constrained, positions, height, mesh.source(), paths.state});
  };
  statistics.faces = measure(outermost, heights.back());
  stack.statistics.first_faces =
      heights.size() == 1 ? statistics.faces : measure(surface_of(stack.stacks, 1), heights.front());
  if (mesh.surroundings()) statistics.obstacles = mesh.surroundings()->facts(outermost);
}

/// The stacks of the input's vertices. They share those of the surface's vertices, but for vertices that stand
/// elsewhere: a vertex in no face stays in all layers, and a vertex that is welded with a tolerance keeps its position
/// on the wall, and in all layers if its stack is flat.
SharedStacks stacks_of_input(const PreparedMesh& mesh, VertexStacks of_surface) {
  const std::span<const Vec3d> positions = mesh.mesh().positions;
  std::vector<std::uint32_t> stack = mesh.surface().welded, elsewhere;
  for (std::uint32_t v = 0; v < stack.size(); ++v)
    if (stack[v] == kNone || of_surface.of(stack[v])[0] != positions[v]) elsewhere.push_back(v);
  if (elsewhere.empty()) return {std::move(of_surface), std::move(stack)};
  const std::size_t of_the_surface = of_surface.vertices();
  VertexStacks all(of_the_surface + elsewhere.size(), of_surface.layers());
  for_each_index(of_the_surface, [&](std::size_t w) {
    std::copy(of_surface.of(w).begin(), of_surface.of(w).end(), all.of(w).begin());
  });
  for (std::size_t i = 0; i < elsewhere.size(); ++i) {
    const std::uint32_t v = elsewhere[i], w = stack[v];
    const auto own = all.of(of_the_surface + i);
    if (w == kNone || of_surface.is_flat(w)) std::fill(own.begin(), own.end(), positions[v]);
    else std::copy(of_surface.of(w).begin(), of_surface.of(w).end(), own.begin());
    own[0] = positions[v];
    stack[v] = static_cast<std::uint32_t>(of_the_surface + i);
  }
  return {std::move(all), std::move(stack)};
}

/// What each face of the input carries (see LayersResult::carries).
std::vector<std::uint8_t> carries(const PreparedMesh& mesh, const GrowthColumns& columns) {
  std::vector<std::uint8_t> carries(mesh.mesh().face_count(), 1);
  const std::vector<std::uint8_t>& only = mesh.options().only;
  for (std::size_t f = 0; f < only.size(); ++f) carries[f] = only[f] != 0;
  for (const auto f : columns.without_area()) carries[f] = 0;
  for (const auto& [f, from] : columns.split_quads()) carries[f] = static_cast<std::uint8_t>(2 + from);
  return carries;
}

/// What the surface knows of its sides. It is triangles that it knows of: polygons may repeat each other, or be split
/// otherwise. Layers rise from each of its triangles on the side of the heights, as cells are valid: only faces that
/// are turned round in it may do otherwise.
KnownSides known_sides(const MeshFacts& facts) {
  const bool paired =
      facts.two_sided() && facts.faces_by_corners.size() == 1 && facts.faces_by_corners.begin()->first == 3;
  return {paired, paired && facts.turned_triangles == 0 && facts.inside_out_components == 0};
}

/// The layers as those of the input's vertices and faces.
LayersResult hand_over(const PreparedMesh& mesh, OffsetStatistics statistics, const GrowthColumns& columns,
                       const Paths& paths, LayerStack stack, std::span<const Distances> heights) {
  const Surface& surface = mesh.surface();
  const std::size_t count = mesh.mesh().positions.size();
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
    result.achieved[v] = stack.height_at(w, paths.achieved[w]);
    result.share[v] = stack.share[w];
    result.first_achieved[v] = stack.height_at(w, stack.first_achieved[w]);
  });
  result.stacks = stacks_of_input(mesh, std::move(stack.stacks));
  result.welded_to = first_at_position(surface);
  for (const Distances& each : heights) result.heights.push_back(distances_of_input(surface, each));
  result.carries = carries(mesh, columns);
  result.known = known_sides(surface.facts);
  return result;
}

}  // namespace

AskedHeights ask_heights(const PreparedMesh& mesh, std::span<const Distances> heights) {
  AskedHeights asked;
  for (const Distances& each : heights) {
    std::size_t disagreeing = 0;
    asked.of_all.push_back(mesh.distances_of_all(each, disagreeing));
    asked.disagreeing = std::max(asked.disagreeing, disagreeing);
  }
  return asked;
}

LayersResult grow_marched(const PreparedMesh& mesh, const AskedHeights& asked, PreparedMesh::Marched marched,
                          CellRules rules, std::span<const std::uint32_t> foot) {
  const OffsetOptions& options = mesh.options();
  const Distances& outer = asked.of_all.back();
  Paths& paths = marched.paths;
  OffsetStatistics statistics = mesh.statistics();
  statistics.disagreeing_distances = asked.disagreeing;
  const ConstrainedSurface constrained = mesh.constrained(marched, true, mesh.slides() ? mesh.mesh().face_count() : 0);
  std::optional<FaultFinder> faults;
  std::vector<double> marched_distances;
  {
    const StageTimer timer(statistics.seconds, Stage::Limit);
    faults.emplace(constrained, mesh.source(), outer, options.precision, mesh.known_crossings());
    faults->move_to_ends(paths);
    take_faulty_miters_back(*faults, mesh.surface(), mesh.corners(), outer.scale(), marched);
    marched_distances = paths.achieved;
    statistics.limit =
        untangle(*faults, {constrained, mesh.source(), outer, paths, &marched.mitered}, options.progress);
  }
  std::optional<GrowthColumns> columns;
  LayerStack stack;
  {
    const StageTimer timer(statistics.seconds, Stage::Layers);
    columns.emplace(mesh.mesh(), constrained, mesh.source(), rules, foot);
    const SpreadInput to_spread{constrained, *columns, mesh.source(), outer};
    const std::vector<Vec3d> unspread = spread_ends(to_spread, *faults, paths);
    stack = stack_layers(constrained, mesh.slides(), *columns, mesh.source(), asked.of_all, *faults, paths, unspread,
                         options.progress);
    round_to_file(mesh, constrained, stack, paths);
    count_crowded(to_spread, paths, stack.share, stack.statistics);
  }
  statistics.limit.left = faults->count();
  statistics.limit.crossings_near_source = faults->crossings_near_source().size();
  count_held_back(paths, outer, marched_distances, statistics.limit);
  statistics.miters = marched.miter_facts;
  count_miters(marched.miters, paths.state, statistics.miters);
  statistics.borders = mesh.borders(paths);
  statistics.room = mesh.room(paths, outer, true);  // what a flow is inside of is often meshed as a solid
  if (mesh.surroundings()) statistics.limit.source_crossings -= mesh.surroundings()->crossing();
  measure_surfaces(mesh, constrained, asked.of_all, paths, stack, statistics);
  return hand_over(mesh, std::move(statistics), *columns, paths, std::move(stack), asked.of_all);
}

void require_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options) {
  require_usable(mesh, heights, options);
  require_heights(heights, mesh.positions.size());
  if (!options.metric.even()) throw InvalidInput("metric: expected one in which all axes count alike, for layers");
  VDB_OFFSET_ASSERT(goes_anywhere(farthest_of(heights.last(1))));
}

LayersResult grow_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                         CellRules rules) {
  require_layers(mesh, heights, options);
  const OffsetOptions of_stages = with_call_progress(options);
  LayersResult result = in_arena(options.threads, [&](int threads) {
    const InMetric space(mesh, options.metric);
    PreparedMesh prepared(space, of_stages, threads, farthest_of(heights.last(1)), {.layers = heights.size()});
    const AskedHeights asked = ask_heights(prepared, heights);
    return grow_marched(prepared, asked, std::move(prepared.march({&asked.of_all.back(), 1}, Ridges::Smooth).front()),
                        rules);
  });
  count_states(result.states, result.statistics);
  report_share(of_stages.progress, Stage::Measure, 1);
  return result;
}

}  // namespace vdb_offset
