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

/// The gap between a result and its obstacles, and that of the source.
void add_obstacles(const ObstacleFacts& obstacles, double clearance, Remarks& remarks) {
  const std::string gap =
      fmt::format("gap to obstacles {:.6g}, {:.6g} at the start", obstacles.gap, obstacles.starting_gap);
  if (obstacles.near > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("{}: {} triangles {} one", gap, obstacles.near,
                            clearance > 0 ? fmt::format("are nearer than {:.6g} to", clearance) : "touch"));
  else remarks.add(Gravity::Detail, gap);
  if (obstacles.touching + obstacles.crossing > 0)
    remarks.add(Gravity::Input, fmt::format("already in the input {} pairs of triangles of it and of obstacles touch, "
                                            "{} intersect",
                                            obstacles.touching, obstacles.crossing));
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

std::string fit_in_words(const FitFacts& fit) {
  std::string text = fmt::format("gap {:.9g}, {:.6g} at the start; {} vertices gave way, by {:.6g} at most", fit.gap,
                                 fit.starting_gap, fit.moved, fit.deepest);
  if (fit.near > 0)
    text +=
        fmt::format("; {} of {} triangles are still nearer than {:.6g}", fit.near, fit.near_at_start, fit.clearance);
  return text;
}

void add_fit(const FitFacts& fit, Remarks& remarks) {
  if (!fit.is_signed)
    remarks.add(Gravity::Input,
                "the mesh to fit is not closed or inconsistently oriented: both sides of it keep clear");
  if (fit.enclosed > 0)
    remarks.add(Gravity::Wrong, fmt::format("{} pieces of the mesh to fit lie inside the result: nothing can give way "
                                            "to them",
                                            fit.enclosed));
}

/// How many vertices reached the distance, which `asked` names, and what became of the others.
std::string vertices_in_words(const OffsetResult& result, const AchievedSummary& achieved, const std::string& asked,
                              bool curves) {
  std::string text = fmt::format("{} % of {} {} reached {}", area_percent(achieved.share_reached, 3), achieved.vertices,
                                 curves ? "points" : "vertices", asked);
  const auto add = [&](VertexState state, const char* words) {
    if (const std::size_t count = result.statistics.vertices_by_state[static_cast<std::size_t>(state)]; count > 0)
      text += fmt::format(", {} {}", count, words);
  };
  add(VertexState::Collision, "stopped by collision");
  add(VertexState::Limited, "held back to stay valid");
  add(VertexState::OutsideField, "outside the field");
  return text;
}

void add_miters(const OffsetStatistics& statistics, Remarks& remarks) {
  const auto in = [&](VertexState state) { return statistics.vertices_by_state[static_cast<std::size_t>(state)]; };
  if (in(VertexState::Mitered) + in(VertexState::Cut) > 0)
    remarks.add(Gravity::Detail,
                fmt::format("{} vertices on sharp edges are farther than the distance (miters), {} of them cut at "
                            "--miter-limit",
                            in(VertexState::Mitered) + in(VertexState::Cut), in(VertexState::Cut)));
}

/// Nothing where every vertex of the offset belongs to an edge.
void add_exactness(const ExactFacts& exact, Remarks& remarks) {
  if (exact.vertices > 0)
    remarks.add(Gravity::Detail, fmt::format("measured from the faces of the CAD model, {} vertices are off their "
                                             "distance by {:.2g} on average, {:.2g} at most",
                                             exact.vertices, exact.mean, exact.worst));
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

std::string shell_in_words(const ShellFacts& shell) {
  return fmt::format("shell {}{}{}, volume {:.6g}", shell.closed ? "closed" : "not closed",
                     shell.oriented ? "" : ", not oriented", shell.has_thickness ? "" : ", without any thickness",
                     shell.volume);
}

void add_shell(const ShellFacts& shell, Remarks& remarks) {
  if (shell.crossings > 0)
    remarks.add(Gravity::Wrong, fmt::format("the shell intersects itself at {} triangle pairs", shell.crossings));
  if (shell.border_edges_left > 0)
    remarks.add(Gravity::Wrong, fmt::format("the shell is open at {} edges", shell.border_edges_left));
  if (shell.non_manifold_edges > 0)
    remarks.add(Gravity::Off, fmt::format("the shell has {} edges of more than two faces", shell.non_manifold_edges));
  if (shell.pinched_vertices > 0)
    remarks.add(Gravity::Off, fmt::format("the shell has no thickness at {} vertices. Use a smaller distance there",
                                          shell.pinched_vertices));
  if (shell.short_junctions > 0)
    remarks.add(Gravity::Off, fmt::format("{} of {} vertices where sheets meet are held back", shell.short_junctions,
                                          shell.junction_vertices));
  if (shell.source_crossings + shell.crossings_near_source > 0)
    remarks.add(
        Gravity::Input,
        fmt::format("the input intersects itself at {} triangle pairs (not repaired); the shell has {} near them",
                    shell.source_crossings, shell.crossings_near_source));
  if (shell.rim_quads + shell.rim_triangles + shell.junction_vertices > 0)
    remarks.add(Gravity::Detail, fmt::format("rim of {} quads and {} triangles, {} vertices where sheets meet",
                                             shell.rim_quads, shell.rim_triangles, shell.junction_vertices));
}

/// Which parts of the mesh have an inside, and how that is known.
void add_solids(const IsoStatistics& found, Remarks& remarks) {
  const SolidFacts& solid = found.solid;
  if (!found.is_signed)
    remarks.add(Gravity::Wrong,
                "the input is not closed or inconsistently oriented: the surface goes around it, on all sides");
  else if (solid.open_parts > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("{} of {} parts of the input are open: the surface goes around them, on all "
                            "sides",
                            solid.open_parts, solid.parts));
  if (solid.holes > 0)
    remarks.add(Gravity::Input, fmt::format("{} hole{} of the input ({:.2g} % of its area) filled, so that it has an "
                                            "inside (--inside never: treat it as open)",
                                            solid.holes, plural(solid.holes), 100 * solid.hole_share));
  if (solid.buried + solid.cut > 0)
    remarks.add(Gravity::Detail, fmt::format("{} triangles of the input are buried inside it, {} of them in part; "
                                             "distances are measured to the others",
                                             solid.buried + solid.cut, solid.cut));
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

/// What became of sharp corners in layers.
void add_layers_corners(const Job& job, const MiterFacts& miters, Remarks& remarks) {
  if (job.corners() == Corners::Round || miters.on_creases == 0) return;
  const std::size_t round = miters.unproven + miters.taken_back;
  if (miters.cut + round > 0)
    remarks.add(Gravity::Off, fmt::format("layers are thinner at {} sharp corners: {} miters are cut at --miter-limit, "
                                          "{} have no room",
                                          miters.cut + round, miters.cut, round));
  remarks.add(Gravity::Detail, fmt::format("{} sharp corners have miters", miters.mitered));
}

/// The distance as it stands in a verdict.
std::string asked_in_words(const Distances& distances, const AchievedSummary& achieved) {
  const std::string least = fmt::format("{:.6g}", achieved.asked_least),
                    most = fmt::format("{:.6g}", achieved.asked_most);
  if (distances.uniform()) return fmt::format("{:.6g}", distances[0]);
  return least == most ? least : fmt::format("its distance ({} to {})", least, most);
}

}  // namespace

void print_dry_run(const Job& job, const OffsetStatistics& statistics, const Distances& farthest) {
  const Printout out;
  print_facts(out, statistics.facts, job.curves());
  print_plan(out, statistics, farthest);
  Remarks remarks;
  if (!job.curves()) add_orientation(statistics.facts, job.options.orient, remarks);
  add_seams(statistics.facts.seams, std::abs(farthest.farthest()), remarks);
  remarks.print(out, true);
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
  Remarks remarks;
  add_orientation(statistics.facts, job.options.orient, remarks);
  remarks.print(out, true);
}

void print_summary(const Job& job, const Outcome& outcome, const Products& made, double total_seconds) {
  const Printout out(output_is_taken(job));
  // Whose faces are not the mesh's.
  const bool is_cad_model = made.cad && made.cad->made != CadFileFacts::Made::Facets;
  const OffsetResult& result = outcome.result;
  const OffsetStatistics& statistics = result.statistics;
  const AchievedSummary achieved = summarise(result);
  const bool verbose = job.request.verbose, knows_faces = !is_cad_model && statistics.faces.samples > 0;
  if (verbose) print_details(out, statistics, result.distances, job.curves());
  const std::string asked = asked_in_words(result.distances, achieved);
  fmt::print(out, "{}: {}", outcome.to.mesh, is_cad_model ? "as a mesh, " : "");
  if (statistics.certified) fmt::print(out, "{}; ", certified_in_words(*statistics.certified));
  else if (knows_faces) fmt::print(out, "{}; ", faces_in_words(statistics.faces, asked, job.curves()));
  fmt::print(out, "{}",
             vertices_in_words(result, achieved, statistics.certified || !knows_faces ? asked : "it", job.curves()));
  if (statistics.fit) fmt::print(out, "; {}", fit_in_words(*statistics.fit));
  if (made.shell) fmt::print(out, "; {}", shell_in_words(*made.shell));
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  if (made.cad) print_cad(out, outcome.to.mesh, *made.cad);
  Remarks remarks;
  if (const auto obstacles = obstacles_of(statistics, made)) add_obstacles(*obstacles, job.options.clearance, remarks);
  if (statistics.fit) add_fit(*statistics.fit, remarks);
  if (made.shell) add_shell(*made.shell, remarks);
  if (statistics.certified) add_certified(*statistics.certified, faces_in(statistics.facts), remarks);
  if (!is_cad_model) add_faces(job, statistics, remarks);
  if (statistics.exact) add_exactness(*statistics.exact, remarks);
  add_miters(statistics, remarks);
  add_input(job, statistics, result.distances, remarks);
  remarks.print(out, verbose);
}

void print_iso_dry_run(const Job& job, const IsoStatistics& statistics, double distance) {
  const Printout out;
  print_iso_plan(out, statistics, distance);
  Remarks remarks;
  add_orientation(statistics.source, job.options.orient, remarks);
  add_seams(statistics.source.seams, std::abs(distance), remarks);
  remarks.print(out, true);
}

void print_hollow_summary(const Job& job, const std::string& path, double distance, const Hollow& hollow,
                          const IsoResult& iso, const IsoResult* inner, double total_seconds) {
  const ShellFacts& shell = hollow.facts;
  {
    const Printout out(output_is_taken(job));
    fmt::print(out, "{}: hollow solid, {}{}, volume {:.6g}\n", path, shell.closed ? "closed" : "not closed",
               shell.oriented ? "" : ", not oriented", shell.volume);
    Remarks remarks;
    add_shell(shell, remarks);
    remarks.print(out, job.request.verbose);
  }
  print_iso_summary(job, path, distance, iso, total_seconds);
  if (inner) print_iso_summary(job, path, inner->statistics.distance, *inner, total_seconds);
}

void print_iso_summary(const Job& job, const std::string& path, double distance, const IsoResult& result,
                       double total_seconds, const std::optional<LevelSetFacts>& level_set) {
  const Printout out(output_is_taken(job));
  const IsoStatistics& found = result.statistics;
  const MeshFaults& left = found.mending.left;
  const bool verbose = job.request.verbose;
  if (verbose) {
    print_iso_plan(out, found, distance);
    for (const Stage stage : kIsoStages)
      fmt::print(out, "{:<10} {:.3f} s\n", name(stage), found.seconds[static_cast<std::size_t>(stage)]);
  }
  if (level_set)
    fmt::print(out, "{}: level set of {} active voxels of {:.6g}, made of this surface\n", path,
               level_set->active_voxels, level_set->voxel_size);
  fmt::print(out, "{}: {} vertices and {} triangles at {:.6g}: {} component{}, {}, {}, {} crossing{}",
             level_set ? "surface" : path, found.vertices, found.triangles, distance, found.components,
             plural(found.components), found.closed() ? "closed" : "not closed",
             found.manifold() ? "manifold" : "not manifold", left.crossings, plural(left.crossings));
  if (found.faces.samples > 0) fmt::print(out, "; {}", faces_in_words(found.faces, "it", false));
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  Remarks remarks;
  add_iso_cause(found.faces, remarks);
  if (left.needles > 0) remarks.add(Gravity::Off, fmt::format("{} triangles have no area", left.needles));
  if (found.dropped_specks > 0)
    remarks.add(Gravity::Input, fmt::format("{} speck{} smaller than a voxel of {:.6g} dropped (--keep-specks: do not)",
                                            found.dropped_specks, plural(found.dropped_specks), found.plan.voxel_size));
  remarks.add(Gravity::Detail, fmt::format("vertices are off the distance by {:.2g} at most", found.worst_error));
  add_solids(found, remarks);
  add_orientation(found.source, job.options.orient, remarks);
  add_seams(found.source.seams, std::abs(distance), remarks);
  remarks.print(out, verbose);
}

void print_layers_summary(const Job& job, const LayersResult& result, const LayerReport& report, double total_seconds) {
  const Printout out(output_is_taken(job));
  const OffsetStatistics& statistics = result.statistics;
  const LayerFigures& all = report.all;
  const bool verbose = job.request.verbose;
  if (verbose) {
    print_details(out, statistics, result.heights.back(), job.curves());
    fmt::print(out, "{}{}", summary(report),
               layers_faces_in_words(statistics.faces, result.layer_statistics.first_faces, job.curves()));
  }
  fmt::print(out,
             "{}: {} layers full on {} % of the {}, {:.4g} of {:.4g} thick on average; {} cells, least scaled "
             "Jacobian {:.3g} ({:.2f} s)\n",
             job.request.output, report.layers, area_percent(all.coverage, 1), report.plane ? "length" : "area",
             all.reached.mean, all.asked.mean, all.cells, all.scaled_jacobian.least, total_seconds);
  Remarks remarks;
  if (report.inverted_block_cells > 0)
    remarks.add(Gravity::Wrong, fmt::format("{} cells of the block are collapsed or inverted, as where layers end",
                                            report.inverted_block_cells));
  if (report.unpaired_sides > 0)
    remarks.add(Gravity::Input,
                fmt::format("{} sides on edges of three faces, or of two of opposite orientation, are on "
                            "the boundary",
                            report.unpaired_sides));
  if (statistics.obstacles) add_obstacles(*statistics.obstacles, job.options.clearance, remarks);
  add_faces(job, statistics, remarks);
  add_layers_corners(job, statistics.miters, remarks);
  add_input(job, statistics, result.heights.back(), remarks);
  remarks.print(out, verbose);
}

}  // namespace vdb_offset::tool
