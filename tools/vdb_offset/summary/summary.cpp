// SPDX-License-Identifier: Apache-2.0
#include "summary/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "messages.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::tool {
namespace {

/// Whether standard output is one of the files that are written.
bool output_is_taken(const Job& job) {
  return std::ranges::any_of(job.files.written, [](const RunFile& file) { return is_standard_output(file.path); });
}

void print_curve_facts(std::FILE* out, const MeshFacts& facts) {
  fmt::print(out,
             "curves     {} points ({} positions, {} unused), {} segments, {} curve{} ({} closed), diagonal {:.6g}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, facts.faces_by_corners.at(2),
             facts.components, plural(facts.components), facts.closed_components, facts.diagonal);
  fmt::print(out, "           {} ends, {} points where curves branch\n", facts.boundary_edges,
             facts.non_manifold_edges);
}

void print_facts(std::FILE* out, const MeshFacts& facts, bool curves = false) {
  if (curves) return print_curve_facts(out, facts);
  fmt::print(out, "mesh       {} vertices ({} positions, {} unused), {} faces, {} component{}, diagonal {:.6g}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, faces_in(facts), facts.components,
             facts.components == 1 ? "" : "s", facts.diagonal);
  fmt::print(out,
             "           {} boundary edges, {} non-manifold edges, {} degenerate faces, {} orientation conflicts\n",
             facts.boundary_edges, facts.non_manifold_edges, facts.degenerate_faces, facts.orientation_conflicts);
  if (facts.repeated_faces + facts.folded_triangles > 0)
    fmt::print(
        out, "           {} repeated faces, {} folded triangles; without them {} boundary and {} non-manifold edges\n",
        facts.repeated_faces, facts.folded_triangles, facts.boundary_left, facts.non_manifold_left);
}

std::string range_of(const Distances& distances) {
  if (distances.uniform()) return fmt::format("{:.9g}", distances[0]);
  return fmt::format("{:.9g} inward to {:.9g} outward", distances.inward(), distances.outward());
}

void print_grid(std::FILE* out, const OffsetStatistics& statistics) {
  const GridPlan& plan = statistics.plan;
  if (plan.voxel_size == 0) return;
  fmt::print(out, "voxel size {:.6g} ({})\n", plan.voxel_size, plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} voxels, {:.1f} MiB, {:.2g} s on {} thread{}\n", plan.leaf_nodes,
             plan.voxels, static_cast<double>(plan.bytes) / 1048576.0, plan.seconds, statistics.threads,
             statistics.threads == 1 ? "" : "s");
}

void print_plan(std::FILE* out, const OffsetStatistics& statistics, const Distances& distances) {
  fmt::print(out, "distance   {}\n", range_of(distances));
  print_grid(out, statistics);
}

void print_planes(std::FILE* out, const BorderFacts& borders) {
  if (borders.planes.empty()) return;
  fmt::print(out, "planes     {} vertices stay in {}\n", borders.held_vertices, planes_in_words(borders.planes));
}

/// Prints all facts about the mesh and the grid, and the seconds of each stage.
void print_details(std::FILE* out, const OffsetStatistics& statistics, const Distances& distances, bool curves) {
  print_facts(out, statistics.facts, curves);
  print_planes(out, statistics.borders);
  print_plan(out, statistics, distances);
  for (std::size_t s = 0; s < kStageCount; ++s)
    fmt::print(out, "{:<10} {:.3f} s\n", name(static_cast<Stage>(s)), statistics.seconds[s]);
}

void print_disagreeing(std::FILE* out, const Job& job, const OffsetStatistics& statistics) {
  if (statistics.disagreeing_distances > 0)
    fmt::print(out, "{} {} share a position with one that was given a different distance; the mean is used\n",
               statistics.disagreeing_distances, job.curves() ? "points" : "vertices");
}

/// Prints the gap between a result and its obstacles, and that of the source.
void print_obstacles(std::FILE* out, const ObstacleFacts& obstacles, double clearance) {
  fmt::print(out, "gap to obstacles {:.6g}, {:.6g} at the start", obstacles.gap, obstacles.starting_gap);
  if (obstacles.near > 0)
    fmt::print(out, ": {} triangles {} one", obstacles.near,
               clearance > 0 ? fmt::format("are nearer than {:.6g} to", clearance) : "touch");
  fmt::print(out, "\n");
  if (obstacles.touching + obstacles.crossing > 0)
    fmt::print(out, "at the start {} pairs of the input's triangles and obstacles' touch, {} go through each other\n",
               obstacles.touching, obstacles.crossing);
}

/// Gaps of what is written: of a CAD model its own, and not those of the mesh. Nothing where that is not whole.
std::optional<ObstacleFacts> obstacles_of(const OffsetStatistics& statistics, const Products& made) {
  std::optional<ObstacleFacts> facts = statistics.obstacles;
  if (!facts || !made.cad) return facts;
  if (!made.cad->obstacle_gap) return std::nullopt;
  facts->gap = *made.cad->obstacle_gap;
  facts->near = 0;
  return facts;
}

void print_fit(std::FILE* out, const FitFacts& fit) {
  fmt::print(out, "gap {:.9g}, {:.6g} at the start: {} of {} triangles are still nearer than {:.6g}", fit.gap,
             fit.starting_gap, fit.near, fit.near_at_start, fit.clearance);
  fmt::print(out, "; {} vertices gave way, by {:.6g} at most\n", fit.moved, fit.deepest);
  if (!fit.is_signed)
    fmt::print(out,
               "the other mesh is not closed, or its faces do not agree about the outside: each side of it is one\n");
  if (fit.enclosed > 0)
    fmt::print(out, "{} components of the other mesh lie inside of the result: nothing can give way to them\n",
               fit.enclosed);
}

void print_states(std::FILE* out, const OffsetResult& result) {
  const auto in = [&](VertexState state) {
    return result.statistics.vertices_by_state[static_cast<std::size_t>(state)];
  };
  if (in(VertexState::Mitred)) fmt::print(out, ", {} of them mitred", in(VertexState::Mitred));
  if (in(VertexState::Cut)) fmt::print(out, ", {} miters cut", in(VertexState::Cut));
  if (in(VertexState::Collision)) fmt::print(out, ", {} stopped by collision", in(VertexState::Collision));
  if (in(VertexState::Limited)) fmt::print(out, ", {} held back to stay valid", in(VertexState::Limited));
  if (in(VertexState::OutsideField)) fmt::print(out, ", {} outside the field", in(VertexState::OutsideField));
}

/// Nothing where every vertex of the offset belongs to an edge.
void print_exactness(std::FILE* out, const ExactFacts& exact) {
  if (exact.vertices == 0) return;
  fmt::print(
      out, "from the faces of the CAD model, {} vertices are off their distance by {:.2g} on average, {:.2g} at most\n",
      exact.vertices, exact.mean, exact.worst);
}

void print_cad(std::FILE* out, const std::string& path, const CadFileFacts& cad) {
  constexpr const char* kMade[] = {"a valid solid", "valid shells", "faces alone", "a solid of triangles"};
  fmt::print(out, "{}: {}: {} faces kept, {} fitted", path, kMade[static_cast<int>(cad.made)], cad.kept, cad.fitted);
  if (cad.fitted > 0) fmt::print(out, " to {:.2g}", cad.fit_error);
  if (cad.swallowed > 0) fmt::print(out, ", {} swallowed", cad.swallowed);
  if (cad.missing > 0) fmt::print(out, ", {} missing", cad.missing);
  if (cad.held > 0) fmt::print(out, ", {} held back to {:.3g} of the distance", cad.held, cad.least_held);
  if (cad.samples > 0)
    fmt::print(out, "; read again, {} points at {:.3g} to {:.3g} of the distance", cad.samples, cad.least, cad.most);
  if (cad.volume > 0) fmt::print(out, ", volume {:.6g}", cad.volume);
  fmt::print(out, "\n");
}

void print_shell(std::FILE* out, const std::string& path, const ShellFacts& shell) {
  fmt::print(out, "{}: shell {}{}, {}, volume {:.6g}, rim of {} quads and {} triangles", path,
             shell.has_thickness ? "" : "without any thickness, ", shell.closed ? "closed" : "not closed",
             shell.oriented ? "oriented" : "not oriented", shell.volume, shell.rim_quads, shell.rim_triangles);
  if (shell.junction_vertices) {
    fmt::print(out, ", {} vertices at junctions of sheets", shell.junction_vertices);
    if (shell.short_junctions) fmt::print(out, " ({} of them held back)", shell.short_junctions);
  }
  if (shell.border_edges_left) fmt::print(out, ", {} border edges left", shell.border_edges_left);
  if (shell.non_manifold_edges) fmt::print(out, ", {} non-manifold edges", shell.non_manifold_edges);
  if (shell.pinched_vertices) fmt::print(out, ", without thickness at {} vertices", shell.pinched_vertices);
  if (shell.crossings) fmt::print(out, ", {} pairs of triangles meet", shell.crossings);
  if (shell.source_crossings + shell.crossings_near_source)
    fmt::print(out, ", {} where the source crosses itself ({} of them its own)",
               shell.source_crossings + shell.crossings_near_source, shell.source_crossings);
  fmt::print(out, "\n");
}

/// Says which parts of the mesh have an inside, and how that is known.
void print_solids(std::FILE* out, const IsoStatistics& found) {
  const SolidFacts& solid = found.solid;
  if (!found.is_signed)
    fmt::print(out,
               "the input is not closed, or its faces do not agree about the outside: the surface is on all its "
               "sides\n");
  else if (solid.open_parts > 0)
    fmt::print(out, "{} of {} parts of the input are open, and have no inside\n", solid.open_parts, solid.parts);
  if (solid.holes > 0)
    fmt::print(out,
               "{} hole{} of the input ({:.2g} % of its area) filled, so that it has an inside (--inside never takes "
               "it as open)\n",
               solid.holes, solid.holes == 1 ? "" : "s", 100 * solid.hole_share);
  if (solid.buried + solid.cut > 0)
    fmt::print(out, "{} triangles of the input are buried inside it, {} in part: distances are to the others\n",
               solid.buried + solid.cut, solid.cut);
}

void print_iso_plan(std::FILE* out, const IsoStatistics& statistics, double distance) {
  const IsoPlan& plan = statistics.plan;
  print_facts(out, statistics.source);
  fmt::print(out, "distance   {:.9g}{}\n", distance,
             statistics.is_signed ? "" : ", on all sides of the surface, as it has no inside");
  fmt::print(out, "voxel size {:.6g} ({})\n", plan.voxel_size, plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} triangles, {:.1f} MiB\n", plan.leaf_nodes, plan.triangles,
             static_cast<double>(plan.bytes) / 1048576.0);
}

/// In layers, what became of corners.
void print_layers_corners(std::FILE* out, const Job& job, const MiterFacts& miters) {
  if (job.options.corners == Corners::Round || miters.on_creases == 0) return;
  const std::size_t round = miters.unproven + miters.taken_back;
  fmt::print(out, "corners: {} mitred", miters.mitred);
  if (miters.cut > 0) fmt::print(out, ", {} cut at the limit", miters.cut);
  if (round > 0) fmt::print(out, ", {} left round", round);
  fmt::print(out, "{}\n",
             miters.cut + round > 0 ? ": beside those that are not mitred layers are thinner on the faces" : "");
}

}  // namespace

void print_dry_run(const Job& job, const OffsetStatistics& statistics, const Distances& farthest) {
  const Printout out;
  print_facts(out, statistics.facts, job.curves());
  print_plan(out, statistics, farthest);
  print_seams(out, statistics.facts.seams, std::abs(farthest.farthest()));
  if (!job.curves()) print_orientation(out, statistics.facts, job.options.orient);
}

void print_fit_dry_run(const Job& job, const OffsetStatistics& statistics) {
  const Printout out;
  const FitFacts& fit = *statistics.fit;
  print_facts(out, statistics.facts);
  fmt::print(out, "fit        the least gap is {:.6g}; {} triangles are nearer than {:g}", fit.starting_gap,
             fit.near_at_start, fit.clearance);
  if (fit.deepest > 0) fmt::print(out, ": the first round goes up to {:.6g} inward", fit.deepest);
  fmt::print(out, "\n");
  if (statistics.plan.voxel_size > 0) print_grid(out, statistics);
  else fmt::print(out, "estimate   {:.1f} MiB\n", static_cast<double>(statistics.plan.bytes) / 1048576.0);
  print_orientation(out, statistics.facts, job.options.orient);
}

void print_summary(const Job& job, const Outcome& outcome, const Products& made, double total_seconds) {
  const Printout out(output_is_taken(job));
  // Whose faces are not the mesh's.
  const bool is_cad_model = made.cad && made.cad->made != CadFileFacts::Made::Facets;
  const OffsetResult& result = outcome.result;
  const AchievedSummary achieved = summarise(result);
  const char* const vertices = job.curves() ? "points" : "vertices";
  if (job.request.verbose) print_details(out, result.statistics, result.distances, job.curves());
  const std::string least = fmt::format("{:.6g}", achieved.asked_least),
                    most = fmt::format("{:.6g}", achieved.asked_most);
  const std::string asked = result.distances.uniform() ? fmt::format("{:.6g}", result.distances[0])
                            : least == most            ? least
                                                       : fmt::format("{} to {}", least, most);
  fmt::print(out, "{}: {}{} {} at {}: {:.3f} % reached", outcome.to.mesh, is_cad_model ? "as a mesh, " : "",
             achieved.vertices, vertices, asked, 100 * achieved.share_reached);
  print_states(out, result);
  if (!is_cad_model) print_faces(out, result.statistics.faces, job.curves());
  if (result.statistics.certified)
    print_certified(out, *result.statistics.certified, faces_in(result.statistics.facts));
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  if (result.statistics.exact) print_exactness(out, *result.statistics.exact);
  if (made.shell) print_shell(out, outcome.to.mesh, *made.shell);
  if (made.cad) print_cad(out, outcome.to.mesh, *made.cad);
  print_disagreeing(out, job, result.statistics);
  if (result.statistics.fit) print_fit(out, *result.statistics.fit);
  if (const auto obstacles = obstacles_of(result.statistics, made))
    print_obstacles(out, *obstacles, job.options.clearance);
  if (!is_cad_model) print_face_causes(out, job, result.statistics);
  print_doubts(out, job, result.statistics, result.distances);
}

void print_iso_dry_run(const Job& job, const IsoStatistics& statistics, double distance) {
  const Printout out;
  print_iso_plan(out, statistics, distance);
  print_seams(out, statistics.source.seams, std::abs(distance));
  print_orientation(out, statistics.source, job.options.orient);
}

void print_hollow_summary(const Job& job, const std::string& path, double distance, const Hollow& hollow,
                          const IsoResult& iso, const IsoResult* inner, double total_seconds) {
  print_iso_summary(job, path, distance, iso, total_seconds);
  if (inner) print_iso_summary(job, path, inner->statistics.distance, *inner, total_seconds);
  const ShellFacts& shell = hollow.facts;
  const Printout out(output_is_taken(job));
  fmt::print(out, "{}: hollow solid {}, {}, volume {:.6g}, {} pairs of triangles meet", path,
             shell.closed ? "closed" : "not closed", shell.oriented ? "oriented" : "not oriented", shell.volume,
             shell.crossings);
  if (shell.border_edges_left) fmt::print(out, ", {} border edges left", shell.border_edges_left);
  if (shell.non_manifold_edges) fmt::print(out, ", {} non-manifold edges", shell.non_manifold_edges);
  if (shell.source_crossings) fmt::print(out, ", {} of the source's own", shell.source_crossings);
  fmt::print(out, "\n");
}

void print_iso_summary(const Job& job, const std::string& path, double distance, const IsoResult& result,
                       double total_seconds, const std::optional<LevelSetFacts>& level_set) {
  const Printout out(output_is_taken(job));
  const IsoStatistics& found = result.statistics;
  const MeshFaults& left = found.mending.left;
  if (job.request.verbose) {
    print_iso_plan(out, found, distance);
    for (const Stage stage : kIsoStages)
      fmt::print(out, "{:<10} {:.3f} s\n", name(stage), found.seconds[static_cast<std::size_t>(stage)]);
  }
  if (level_set)
    fmt::print(out, "{}: level set of {} active voxels of {:.6g}, made of this surface\n", path,
               level_set->active_voxels, level_set->voxel_size);
  fmt::print(out, "{}: {} vertices and {} triangles at {:.6g}: {} component{}, {}, {}, {} crossing{}",
             level_set ? "surface" : path, found.vertices, found.triangles, distance, found.components,
             found.components == 1 ? "" : "s", found.closed() ? "closed" : "not closed",
             found.manifold() ? "manifold" : "not manifold", left.crossings, left.crossings == 1 ? "" : "s");
  if (left.needles > 0) fmt::print(out, ", {} triangles without area", left.needles);
  fmt::print(out, ", distance off by {:.2g} at most", found.worst_error);
  print_faces(out, found.faces, false);
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  print_iso_cause(out, found.faces);
  if (found.dropped_specks > 0)
    fmt::print(out, "{} speck{} dropped that enclosed less than a voxel of {:.6g} (--keep-specks keeps them)\n",
               found.dropped_specks, found.dropped_specks == 1 ? "" : "s", found.plan.voxel_size);
  print_solids(out, found);
  print_seams(out, found.source.seams, std::abs(distance));
  print_orientation(out, found.source, job.options.orient);
}

void print_layers_summary(const Job& job, const LayersResult& result, const LayerReport& report, double total_seconds) {
  const Printout out(output_is_taken(job));
  if (job.request.verbose) print_details(out, result.statistics, result.heights.back(), job.curves());
  fmt::print(out, "{}: {}", job.request.output, summary(report));
  fmt::print(out, "{:.2f} s\n", total_seconds);
  print_layers_faces(out, result.statistics.faces, result.layer_statistics.first_faces, job.curves());
  print_face_causes(out, job, result.statistics);
  print_layers_corners(out, job, result.statistics.miters);
  print_disagreeing(out, job, result.statistics);
  if (result.statistics.obstacles) print_obstacles(out, *result.statistics.obstacles, job.options.clearance);
  print_doubts(out, job, result.statistics, result.heights.back());
}

}  // namespace vdb_offset::tool
