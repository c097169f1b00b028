#include "summary.h"

#include <fmt/format.h>

#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

void print_facts(std::FILE* out, const MeshFacts& facts) {
  std::size_t faces = 0;
  for (const auto& [corners, count] : facts.faces_by_corners) faces += count;
  fmt::print(out, "mesh       {} vertices ({} positions, {} unused), {} faces, {} component{}, diagonal {:.6g}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, faces, facts.components,
             facts.components == 1 ? "" : "s", facts.diagonal);
  fmt::print(out,
             "           {} boundary edges, {} non-manifold edges, {} degenerate faces, {} orientation conflicts\n",
             facts.boundary_edges, facts.non_manifold_edges, facts.degenerate_faces, facts.orientation_conflicts);
  if (facts.repeated_faces + facts.folded_triangles > 0)
    fmt::print(
        out, "           {} repeated faces, {} folded triangles; without them {} boundary and {} non-manifold edges\n",
        facts.repeated_faces, facts.folded_triangles, facts.boundary_left, facts.non_manifold_left);
}

/// Where it is not clear which side is outward, and what to do about it.
void print_orientation(std::FILE* out, const MeshFacts& facts, Orient orient) {
  if (facts.inside_out_components > 0)
    fmt::print(out, "{} of {} closed components point inward as a whole: {}\n", facts.inside_out_components,
               facts.closed_components,
               orient == Orient::Keep
                   ? "a distance above 0 shrinks them (--orient fix-direction-only enlarges them)"
                   : "taken as turned, a distance above 0 enlarges them; the faces stay as they are");
  if (facts.orientation_conflicts > 0)
    fmt::print(out,
               "{} edges between faces that disagree about the outside: {} triangles taken as turned, {} edges left\n",
               facts.orientation_conflicts, facts.turned_triangles, facts.unsettled_conflicts);
}

std::string range_of(const Distances& distances) {
  if (distances.uniform()) return fmt::format("{:.9g}", distances[0]);
  return fmt::format("{:.9g} inward to {:.9g} outward", distances.inward(), distances.outward());
}

void print_plan(std::FILE* out, const OffsetStatistics& statistics, const Distances& distances) {
  const GridPlan& plan = statistics.plan;
  fmt::print(out, "distance   {}\n", range_of(distances));
  if (plan.voxel_size == 0) return;
  fmt::print(out, "voxel size {:.6g} ({})\n", plan.voxel_size, plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} voxels, {:.1f} MiB, {:.2g} s on {} thread{}\n", plan.leaf_nodes,
             plan.voxels, static_cast<double>(plan.bytes) / 1048576.0, plan.seconds, statistics.threads,
             statistics.threads == 1 ? "" : "s");
}

/// All that is known of the mesh and the grid, and the seconds of each stage.
void print_details(std::FILE* out, const OffsetStatistics& statistics, const Distances& distances) {
  print_facts(out, statistics.facts);
  print_plan(out, statistics, distances);
  for (std::size_t s = 0; s < kStageCount; ++s)
    fmt::print(out, "{:<10} {:.3f} s\n", name(static_cast<Stage>(s)), statistics.seconds[s]);
}

/// What of the mesh leaves a result in doubt.
void print_doubts(std::FILE* out, const OffsetStatistics& statistics, Orient orient) {
  print_orientation(out, statistics.facts, orient);
  const LimitStatistics& limit = statistics.limit;
  if (limit.source_crossings > 0)
    fmt::print(out, "the input crosses itself: {} pairs of triangles meet, left as they are; {} more beside them\n",
               limit.source_crossings, limit.crossings_near_source);
}

void print_states(std::FILE* out, const OffsetResult& result) {
  const auto in = [&](VertexState state) {
    return result.statistics.vertices_by_state[static_cast<std::size_t>(state)];
  };
  if (in(VertexState::Collision)) fmt::print(out, ", {} stopped by collision", in(VertexState::Collision));
  if (in(VertexState::Limited)) fmt::print(out, ", {} held back to stay valid", in(VertexState::Limited));
  if (in(VertexState::OutsideField)) fmt::print(out, ", {} outside the field", in(VertexState::OutsideField));
}

void print_shell(std::FILE* out, const std::string& path, const ShellFacts& shell) {
  fmt::print(out, "{}: shell {}, {}, volume {:.6g}, rim of {} quads and {} triangles", path,
             shell.closed ? "closed" : "not closed", shell.oriented ? "oriented" : "not oriented", shell.volume,
             shell.rim_quads, shell.rim_triangles);
  if (shell.border_edges_left) fmt::print(out, ", {} border edges left", shell.border_edges_left);
  if (shell.non_manifold_edges) fmt::print(out, ", {} non-manifold edges", shell.non_manifold_edges);
  if (shell.pinched_vertices) fmt::print(out, ", without thickness at {} vertices", shell.pinched_vertices);
  if (shell.crossings) fmt::print(out, ", {} pairs of triangles meet", shell.crossings);
  if (shell.source_crossings + shell.crossings_near_source)
    fmt::print(out, ", {} where the source crosses itself ({} of them its own)",
               shell.source_crossings + shell.crossings_near_source, shell.source_crossings);
  fmt::print(out, "\n");
}

void print_iso_plan(std::FILE* out, const CaptureStatistics& statistics, double distance) {
  const CapturePlan& plan = statistics.plan;
  print_facts(out, statistics.source);
  fmt::print(out, "distance   {:.9g}{}\n", distance,
             statistics.is_signed ? "" : ", on all sides of the surface, as it has no inside");
  fmt::print(out, "voxel size {:.6g} ({})\n", plan.voxel_size, plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} triangles, {:.1f} MiB\n", plan.leaf_nodes, plan.triangles,
             static_cast<double>(plan.bytes) / 1048576.0);
}

}  // namespace

void print_dry_run(const Arguments& args, const OffsetStatistics& statistics, const Distances& farthest) {
  print_facts(stdout, statistics.facts);
  print_plan(stdout, statistics, farthest);
  print_orientation(stdout, statistics.facts, args.options.orient);
}

void print_summary(const Arguments& args, const Outcome& outcome, const std::optional<ShellFacts>& shell,
                   double total_seconds) {
  std::FILE* const out = args.output == "-" ? stderr : stdout;  // standard output may be taken by the mesh
  const OffsetResult& result = outcome.result;
  const AchievedSummary achieved = summarise(result);
  if (args.verbose) print_details(out, result.statistics, result.distances);
  const std::string asked = result.distances.uniform()
                                ? fmt::format("{:.6g}", result.distances[0])
                                : fmt::format("{:.6g} to {:.6g}", achieved.asked_least, achieved.asked_most);
  fmt::print(out, "{}: {} vertices at {}: {:.3f} % reached", outcome.to.mesh, achieved.vertices, asked,
             100 * achieved.share_reached);
  print_states(out, result);
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  if (shell) print_shell(out, outcome.to.mesh, *shell);
  if (result.statistics.disagreeing_distances > 0)
    fmt::print(out, "{} vertices stand with one of which another distance was asked; they go the mean\n",
               result.statistics.disagreeing_distances);
  print_doubts(out, result.statistics, args.options.orient);
}

void print_iso_dry_run(const Arguments& args, const CaptureStatistics& statistics, double distance) {
  print_iso_plan(stdout, statistics, distance);
  print_orientation(stdout, statistics.source, args.options.orient);
}

void print_iso_summary(const Arguments& args, const std::string& path, double distance, const CaptureResult& result,
                       double total_seconds) {
  std::FILE* const out = args.output == "-" ? stderr : stdout;
  const CaptureStatistics& found = result.statistics;
  const MeshFaults& left = found.mending.left;
  if (args.verbose) {
    print_iso_plan(out, found, distance);
    for (const Stage stage : kCaptureStages)
      fmt::print(out, "{:<10} {:.3f} s\n", name(stage), found.seconds[static_cast<std::size_t>(stage)]);
  }
  fmt::print(out, "{}: {} vertices and {} triangles at {:.6g}: {}, {}, {} crossing{}", path, found.vertices,
             found.triangles, distance, found.closed() ? "closed" : "not closed",
             found.manifold() ? "manifold" : "not manifold", left.crossings, left.crossings == 1 ? "" : "s");
  if (left.needles > 0) fmt::print(out, ", {} triangles without area", left.needles);
  fmt::print(out, ", distance off by {:.2g} at most ({:.2f} s)\n", found.worst_error, total_seconds);
  if (!found.is_signed)
    fmt::print(out,
               "the input is not closed, or its faces do not agree about the outside: the surface is on all its "
               "sides\n");
  print_orientation(out, found.source, args.options.orient);
}

void print_layers_summary(const Arguments& args, const LayersResult& result, const LayerReport& report,
                          double total_seconds) {
  if (args.verbose) print_details(stdout, result.statistics, result.heights.back());
  fmt::print("{}: {}", args.output, summary(report));
  fmt::print("{:.2f} s\n", total_seconds);
  print_doubts(stdout, result.statistics, args.options.orient);
}

}  // namespace vdb_offset::tool
