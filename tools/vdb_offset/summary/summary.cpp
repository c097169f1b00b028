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

void print_curve_facts(std::FILE* out, const MeshFacts& facts, const Lengths& lengths) {
  fmt::print(out, "curves     {} points ({} positions, {} unused), {} segments, {} curve{} ({} closed), diagonal {}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, facts.faces_by_corners.at(2),
             facts.components, plural(facts.components), facts.closed_components, lengths(facts.diagonal));
  fmt::print(out, "           {} ends, {} points where curves branch\n", facts.boundary_edges,
             facts.non_manifold_edges);
}

std::string range_of(const Distances& distances, const Lengths& lengths) {
  if (distances.uniform()) return lengths(distances[0], 9);
  return fmt::format("{} inward to {} outward", lengths(distances.inward(), 9), lengths(distances.outward(), 9));
}

void print_grid(std::FILE* out, const OffsetStatistics& statistics, const Lengths& lengths) {
  const GridPlan& plan = statistics.plan;
  if (plan.voxel_size == 0) return;
  fmt::print(out, "voxel size {} ({})\n", lengths(plan.voxel_size), plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} voxels, {:.1f} MiB, {:.2g} s on {} thread{}\n", plan.leaf_nodes,
             plan.voxels, static_cast<double>(plan.bytes) / 1048576.0, plan.seconds, statistics.threads,
             statistics.threads == 1 ? "" : "s");
}

void print_plan(std::FILE* out, const OffsetStatistics& statistics, const Distances& distances,
                const Lengths& lengths) {
  fmt::print(out, "distance   {}\n", range_of(distances, lengths));
  print_grid(out, statistics, lengths);
}

void print_planes(std::FILE* out, const BorderFacts& borders) {
  if (borders.planes.empty()) return;
  fmt::print(out, "planes     {} vertices stay in {}\n", borders.held_vertices, planes_in_words(borders.planes));
}

/// Prints all facts about the mesh and the grid, and the seconds of each stage.
void print_details(std::FILE* out, const Job& job, const OffsetStatistics& statistics, const Distances& distances) {
  print_facts(out, statistics.facts, job.request.lengths, job.curves());
  print_planes(out, statistics.borders);
  print_plan(out, statistics, distances, job.request.lengths);
  for (std::size_t s = 0; s < kStageCount; ++s)
    fmt::print(out, "{:<10} {:.3f} s\n", name(static_cast<Stage>(s)), statistics.seconds[s]);
}

/// The gap between a result and its obstacles, and that of the source.
void add_obstacles(const ObstacleFacts& obstacles, double clearance, const Lengths& lengths, Remarks& remarks) {
  const std::string gap =
      fmt::format("gap to obstacles {}, {} at the start", lengths(obstacles.gap), lengths(obstacles.starting_gap));
  if (obstacles.near > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("{}: {} triangles {} one", gap, obstacles.near,
                            clearance > 0 ? fmt::format("are nearer than {} to", lengths(clearance)) : "touch"));
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

std::string fit_in_words(const FitFacts& fit, const Lengths& lengths) {
  std::string text = fmt::format("gap {}, {} at the start; {} vertices gave way, by {} at most", lengths(fit.gap, 9),
                                 lengths(fit.starting_gap), fit.moved, lengths(fit.deepest));
  if (fit.near > 0)
    text += fmt::format("; {} of {} triangles are still nearer than {}", fit.near, fit.near_at_start,
                        lengths(fit.clearance));
  return text;
}

void add_fit(const FitFacts& fit, Remarks& remarks) {
  if (!fit.is_signed)
    remarks.add(Gravity::Input,
                "the mesh to fit is not closed or inconsistently oriented: both sides of it keep clear");
  if (fit.near > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("it does not fit: {} of {} triangles are still too near. Offset the other mesh "
                            "instead, or use a smaller --clearance",
                            fit.near, fit.near_at_start));
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
void add_exactness(const ExactFacts& exact, const Lengths& lengths, Remarks& remarks) {
  if (exact.vertices > 0)
    remarks.add(Gravity::Detail, fmt::format("measured from the faces of the CAD model, {} vertices are off their "
                                             "distance by {} on average, {} at most",
                                             exact.vertices, lengths(exact.mean, 2), lengths(exact.worst, 2)));
}

/// Where points of a CAD model that was read again are, by the least and the most share of the distance.
std::string shares_in_words(double least, double most) {
  constexpr double kAtDistance = 0.01, kNothing = 1e-6;  // shares of the distance
  const double off = std::max(std::abs(1 - least), std::abs(most - 1));
  if (off < kNothing) return "at the distance";
  if (off < kAtDistance) return fmt::format("off the distance by {:.1g} % at most", 100 * off);
  if (least > 1 - kAtDistance) return fmt::format("at the distance, at sharp edges up to {:.3g} times it", most);
  return fmt::format("at {:.3g} to {:.3g} % of the distance", 100 * least, 100 * most);
}

/// What was made of a CAD model.
std::string cad_in_words(const CadFileFacts& cad, const Lengths& lengths) {
  constexpr const char* kMade[] = {"a valid solid", "valid shells", "valid, in part of triangles",
                                   "in part of triangles, and doubtful"};
  std::string text =
      fmt::format("{}: {} faces kept, {} fitted", kMade[static_cast<int>(cad.made)], cad.kept, cad.fitted);
  if (cad.fitted > 0) text += " to " + lengths(cad.fit_error, 2);
  if (cad.swallowed > 0) text += fmt::format(", {} swallowed", cad.swallowed);
  if (cad.triangles > 0)
    text += fmt::format(", {} in part or wholly of {} triangles: {:.4g} % of the area is exact", cad.faceted,
                        cad.triangles, 100 * cad.exact_share);
  if (cad.vanished > 0) text += fmt::format(", {} solid{} gone", cad.vanished, cad.vanished == 1 ? "" : "s");
  if (cad.missing > 0) text += fmt::format(", {} missing", cad.missing);
  if (cad.held > 0) text += fmt::format(", {} held back to {:.3g} of the distance", cad.held, cad.least_held);
  if (cad.samples > 0)
    text += fmt::format("; read again, {} points are {}", cad.samples, shares_in_words(cad.least, cad.most));
  if (cad.volume > 0) text += ", volume " + lengths.volume(cad.volume);
  return text;
}

std::string shell_in_words(const ShellFacts& shell, const Lengths& lengths) {
  return fmt::format("shell {}{}{}, volume {}", shell.closed ? "closed" : "not closed",
                     shell.oriented ? "" : ", not oriented", shell.has_thickness ? "" : ", without any thickness",
                     lengths.volume(shell.volume));
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
std::string asked_in_words(const Distances& distances, const AchievedSummary& achieved, const Lengths& lengths) {
  if (distances.uniform()) return lengths(distances[0]);
  const std::string least = lengths(achieved.asked_least), most = lengths(achieved.asked_most);
  return least == most ? least : fmt::format("its distance ({} to {})", least, most);
}

std::string in_words(const LayerGrowth& growth) {
  const std::string from = fmt::format("{:.3g}", growth.least), to = fmt::format("{:.3g}", growth.largest);
  return from == to ? from : from + " to " + to;
}

/// The patches that are written, and the planes that they lie in.
void print_boundary(std::FILE* out, const LayerReport& report) {
  for (const auto& [patch, kind, faces, plane] : report.boundary) {
    const std::string in_plane = plane ? " in " + planes_in_words({&*plane, 1}) : "";
    fmt::print(out, "patch      {}: {}, {} faces{}\n", patch, name(kind), faces, in_plane);
  }
}

/// What layers are planned to be.
void print_layers(std::FILE* out, const Job& job) {
  const Distances& first = job.distances.front();
  fmt::print(out, "layers     {}, the first {}{} high", job.distances.size(), first.uniform() ? "" : "up to ",
             job.request.lengths(first.farthest(), 4));
  if (job.distances.size() > 1) fmt::print(out, ", growth {}", in_words(growth_of(job.distances)));
  fmt::print(out, "\n");
}

}  // namespace

bool output_is_taken(const Job& job) {
  return std::ranges::any_of(job.files.written, [](const RunFile& file) { return is_standard_output(file.path); });
}

void print_facts(std::FILE* out, const MeshFacts& facts, const Lengths& lengths, bool curves) {
  if (curves) return print_curve_facts(out, facts, lengths);
  fmt::print(out, "mesh       {} vertices ({} positions, {} unused), {} faces, {} component{}, diagonal {}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, faces_in(facts), facts.components,
             plural(facts.components), lengths(facts.diagonal));
  fmt::print(out,
             "           {} boundary edges, {} non-manifold edges, {} degenerate faces, {} orientation conflicts\n",
             facts.boundary_edges, facts.non_manifold_edges, facts.degenerate_faces, facts.orientation_conflicts);
  if (facts.repeated_faces + facts.folded_triangles > 0)
    fmt::print(
        out, "           {} repeated faces, {} folded triangles; without them {} boundary and {} non-manifold edges\n",
        facts.repeated_faces, facts.folded_triangles, facts.boundary_left, facts.non_manifold_left);
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

void print_dry_run(const Job& job, const OffsetStatistics& statistics, const Distances& farthest) {
  const Printout out;
  print_facts(out, statistics.facts, job.request.lengths, job.curves());
  if (job.request.layers) print_layers(out, job);
  print_plan(out, statistics, farthest, job.request.lengths);
  Remarks remarks;
  if (!job.curves()) add_orientation(job, statistics.facts, remarks);
  add_seams(statistics.facts.seams, std::abs(farthest.farthest()), job.request.lengths, remarks);
  remarks.print(out, true);
}

void print_fit_dry_run(const Job& job, const OffsetStatistics& statistics) {
  const Printout out;
  const FitFacts& fit = *statistics.fit;
  const Lengths& lengths = job.request.lengths;
  print_facts(out, statistics.facts, lengths);
  fmt::print(out, "fit        the least gap is {}; {} triangles are nearer than {}", lengths(fit.starting_gap),
             fit.near_at_start, lengths(fit.clearance));
  if (fit.deepest > 0) fmt::print(out, ": the first round goes up to {} inward", lengths(fit.deepest));
  fmt::print(out, "\n");
  if (statistics.plan.voxel_size > 0) print_grid(out, statistics, lengths);
  else fmt::print(out, "estimate   {:.1f} MiB\n", static_cast<double>(statistics.plan.bytes) / 1048576.0);
  Remarks remarks;
  add_orientation(job, statistics.facts, remarks);
  remarks.print(out, true);
}

Summary summary_of(const Job& job, const Outcome& outcome, const Products& made) {
  // Whose faces are not the mesh's.
  const bool is_cad_model = made.cad.has_value();
  const Lengths& lengths = job.request.lengths;
  const OffsetResult& result = outcome.result;
  const OffsetStatistics& statistics = result.statistics;
  const AchievedSummary achieved = summarise(result);
  const bool knows_faces = !is_cad_model && statistics.faces.samples > 0;
  const std::string asked = asked_in_words(result.distances, achieved, lengths);
  Summary all;
  std::string& verdict = all.verdict;
  verdict = fmt::format("{}: {}", outcome.to.mesh, made.cad ? cad_in_words(*made.cad, lengths) + "; " : "");
  if (is_cad_model) verdict += "as a mesh, ";
  if (statistics.certified) verdict += certified_in_words(*statistics.certified, lengths) + "; ";
  else if (knows_faces) verdict += faces_in_words(statistics.faces, asked, job.curves()) + "; ";
  verdict += vertices_in_words(result, achieved, statistics.certified || !knows_faces ? asked : "it", job.curves());
  if (statistics.fit) verdict += "; " + fit_in_words(*statistics.fit, lengths);
  if (made.shell) verdict += "; " + shell_in_words(*made.shell, lengths);
  Remarks& remarks = all.remarks;
  if (const auto obstacles = obstacles_of(statistics, made))
    add_obstacles(*obstacles, job.options.clearance, lengths, remarks);
  if (statistics.fit) add_fit(*statistics.fit, remarks);
  if (made.shell) add_shell(*made.shell, remarks);
  if (statistics.certified) add_certified(*statistics.certified, faces_in(statistics.facts), remarks);
  if (!is_cad_model) add_faces(job, statistics, remarks);
  if (statistics.exact) add_exactness(*statistics.exact, lengths, remarks);
  add_miters(statistics, remarks);
  add_input(job, statistics, result.distances, remarks);
  return all;
}

void print_summary(const Job& job, const Outcome& outcome, const Products& made, double total_seconds) {
  const Printout out(output_is_taken(job));
  const OffsetResult& result = outcome.result;
  if (job.request.verbose) print_details(out, job, result.statistics, result.distances);
  summary_of(job, outcome, made).print(out, total_seconds, job.request.verbose);
}

namespace {

void add_fill(const FillReport& fill, Summary& made) {
  made.verdict += fmt::format("; the rest filled with {} {}{}; their scaled Jacobian: least {:.3g}, 1 % below {:.3g}",
                              fill.triangles > 0 ? fill.triangles : fill.tetrahedra,
                              fill.triangles > 0 ? "triangles" : "tetrahedra",
                              fill.pyramids > 0 ? fmt::format(" and {} pyramids", fill.pyramids) : "",
                              fill.scaled_jacobian.least, fill.scaled_jacobian.quantile_01);
  if (!fill.guessed_planes.empty())
    made.remarks.add(
        Gravity::Off,
        fmt::format(
            "straight borders lie in many planes: what is filled ends at {}, at right angles to the faces beside "
            "them. To name another plane: --symmetry A,B,C,D",
            planes_in_words(fill.guessed_planes)));
  // OpenFOAM warns of interpolation weights below 0.05, which a jump of about 20 makes.
  constexpr double kMostJump = 20;
  if (fill.jump.quantile_95 > kMostJump)
    made.remarks.add(
        Gravity::Off,
        fmt::format("from the last layer to the cells on it, volumes change {:.3g} times on average, and {:.3g} "
                    "times at 5 % of the faces. Use --last-height edge, and leave out --layers or --growth",
                    fill.jump.median, fill.jump.quantile_95));
}

/// How layers grow, where that follows from lengths.
std::string growth_in_words(const Job& job, const LayerReport& report) {
  const LayersRequest& layers = *job.request.layers;
  if (layers.lengths().size() + (layers.y_plus ? 1 : 0) < 2) return "";
  return fmt::format(" (growth {})", in_words(report.growth));
}

/// Whether a mesh may be one period of a shape that has not been called so.
void add_periods(const Job& job, const LayersResult& result, Remarks& remarks) {
  if (result.periodic || job.curves()) return;
  const auto turn = likely_turn(job.source.view());
  if (!turn) return;
  const char axis = "xyz"[turn->axis[0] == 1 ? 0 : turn->axis[1] == 1 ? 1 : 2];
  remarks.add(Gravity::Input,
              fmt::format("one border is the other one, turned by {:.6g} degrees about {}. If the mesh is "
                          "one period of a shape: --periodic rotate:{},{:.10g}",
                          turn->angle, axis, axis, turn->angle));
}

}  // namespace

Summary summary_of(const Job& job, const LayersResult& result, const LayerReport& report) {
  const OffsetStatistics& statistics = result.statistics;
  const LayerFigures& all = report.all;
  const Lengths& lengths = job.request.lengths;
  Summary made;
  made.verdict = fmt::format(
      "{}: {} layers{} full on {} % of the {}, {} of {} thick on average; {} cells{}; scaled Jacobian: "
      "least {:.3g}, median {:.3g}",
      job.request.output, report.layers, growth_in_words(job, report), area_percent(all.coverage, 1),
      report.plane ? "length" : "area", lengths(all.reached.mean, 4), lengths(all.asked.mean, 4), all.cells,
      all.fan_cells > 0 ? fmt::format(", {} of them in fans over sharp edges", all.fan_cells) : "",
      all.scaled_jacobian.least, all.scaled_jacobian.median);
  Remarks& remarks = made.remarks;
  if (report.fill) add_fill(*report.fill, made);
  if (report.inverted_block_cells > 0)
    remarks.add(Gravity::Wrong, fmt::format("{} cells of the block are collapsed or inverted, as where layers end",
                                            report.inverted_block_cells));
  if (all.poor_cells > 0)
    remarks.add(Gravity::Off,
                fmt::format("{} of {} cells have a scaled Jacobian below {}. {}", all.poor_cells, all.cells,
                            LayerFigures::kPoorJacobian,
                            all.needles > 0 ? fmt::format("{} faces of the wall are needles: remesh it", all.needles)
                                            : "Thinner layers have more room"));
  if (report.growing.crowded_vertices > 0)
    remarks.add(
        Gravity::Off,
        fmt::format("{} vertices of the last layer are nearer to others than a fifth of the wall's edges (least "
                    "{:.2g}), at concave edges without room. Use thinner layers, or a coarser wall there",
                    report.growing.crowded_vertices, report.growing.least_edge));
  if (report.unpaired_sides > 0)
    remarks.add(Gravity::Input,
                fmt::format("{} sides on edges of three faces, or of two of opposite orientation, are on "
                            "the boundary",
                            report.unpaired_sides));
  if (statistics.obstacles) add_obstacles(*statistics.obstacles, job.options.clearance, lengths, remarks);
  add_faces(job, statistics, remarks);
  add_layers_corners(job, statistics.miters, remarks);
  add_periods(job, result, remarks);
  add_input(job, statistics, result.heights.back(), remarks);
  return made;
}

void print_layers_summary(const Job& job, const LayersResult& result, const LayerReport& report, double total_seconds) {
  const Printout out(output_is_taken(job));
  const OffsetStatistics& statistics = result.statistics;
  const bool verbose = job.request.verbose;
  if (verbose) {
    print_details(out, job, statistics, result.heights.back());
    print_boundary(out, report);
    fmt::print(out, "{}{}", summary(report),
               layers_faces_in_words(statistics.faces, result.layer_statistics.first_faces, job.curves()));
  }
  summary_of(job, result, report).print(out, total_seconds, verbose);
}

}  // namespace vdb_offset::tool
