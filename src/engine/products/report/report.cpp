// SPDX-License-Identifier: Apache-2.0
// Puts the figures of a run into the JSON text of its report: of an offset or layers, of an iso-surface, or of a check.
// Each kind of figures has a function that makes an object of it; the functions at the end put these together, in an
// order that is always the one written here. What a run does not have, such as obstacles, a fit or a certificate, has
// no key. Bytes of names that are no UTF-8 are replaced, so that the text is JSON whatever files are called. Nothing is
// measured here but the process's peak of memory; states and distances of vertices are summed up by achieved.cpp. The
// figures of shells and CAD files come from product_reports.cpp, and what the keys mean is in docs/report.md.
#include "vdb_offset/report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "ground/system/memory.h"
#include "products/report/product_reports.h"
#include "vdb_offset/api.h"

namespace vdb_offset {
namespace {

using Json = nlohmann::ordered_json;

std::size_t faces_in(const MeshFacts& facts) {
  std::size_t faces = 0;
  for (const auto& [corners, count] : facts.faces_by_corners) faces += count;
  return faces;
}

/// The largest piece that is inside out; null if there is none.
Json piece_json(const MeshFacts& facts) {
  if (facts.inside_out_components == 0) return nullptr;
  const auto& [vertices, lower, upper, face] = facts.largest_inside_out;
  return {{"vertices", vertices},
          {"lower", {lower[0], lower[1], lower[2]}},
          {"upper", {upper[0], upper[1], upper[2]}},
          {"face", face}};
}

Json facts_json(const MeshFacts& facts) {
  Json by_corners = Json::object();
  for (const auto& [corners, count] : facts.faces_by_corners) by_corners[std::to_string(corners)] = count;
  return {{"vertices", facts.vertices},
          {"vertices_unused", facts.unused_vertices},
          {"vertices_welded", facts.welded_vertices},
          {"faces", faces_in(facts)},
          {"faces_by_corners", by_corners},
          {"components", facts.components},
          {"closed_components", facts.closed_components},
          {"inside_out_components", facts.inside_out_components},
          {"largest_inside_out", piece_json(facts)},
          {"enclosed_components", facts.enclosed_components},
          {"boundary_edges", facts.boundary_edges},
          {"non_manifold_edges", facts.non_manifold_edges},
          {"repeated_faces", facts.repeated_faces},
          {"folded_triangles", facts.folded_triangles},
          {"boundary_edges_left", facts.boundary_left},
          {"non_manifold_edges_left", facts.non_manifold_left},
          {"degenerate_faces", facts.degenerate_faces},
          {"orientation_conflicts", facts.orientation_conflicts},
          {"turned_triangles", facts.turned_triangles},
          {"unsettled_conflicts", facts.unsettled_conflicts},
          {"closed", facts.closed()},
          {"lower", {facts.lower[0], facts.lower[1], facts.lower[2]}},
          {"upper", {facts.upper[0], facts.upper[1], facts.upper[2]}},
          {"diagonal", facts.diagonal},
          {"area", facts.area},
          {"median_edge", facts.median_edge},
          {"seams",
           {{"welded_vertices", facts.seams.vertices},
            {"widest", facts.seams.widest},
            {"near_vertices", facts.seams.near_vertices},
            {"widest_near", facts.seams.widest_near},
            {"hanging_vertices", facts.seams.hanging},
            {"widest_hanging", facts.seams.widest_hanging},
            {"sliver_vertices", facts.seams.slivers},
            {"widest_sliver", facts.seams.widest_sliver}}},
          {"sliver_edges", facts.sliver_edges},
          {"longest_sliver", facts.longest_sliver}};
}

/// A report as text; bytes of names that are no UTF-8, and so not allowed in JSON, are replaced.
std::string as_text(const Json& report) { return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

/// Puts the verdict, the warnings and the notes of a run into its report.
void add_summary(Json& report, const RunSummary& summary) {
  if (summary.verdict.empty()) return;
  report["verdict"] = summary.verdict;
  Json warnings = Json::array();
  for (const auto& [kind, text] : summary.warnings) warnings.push_back({{"kind", kind}, {"text", text}});
  report["warnings"] = warnings;
  report["notes"] = summary.notes;
}

Json faults_json(const FaultCounts& counts) {
  return {{"inverted_faces", counts.inverted},
          {"collapsed_faces", counts.collapsed},
          {"crowded_faces", counts.crowded},
          {"crossings", counts.crossings}};
}

Json room_json(const SideRoom& room) {
  return room.known ? Json{{"here", room.here}, {"other_side", room.there}} : Json();
}

Json borders_json(const BorderFacts& borders) {
  Json planes = Json::array();
  for (const auto& [normal, offset] : borders.planes)
    planes.push_back({{"normal", {normal[0], normal[1], normal[2]}}, {"offset", offset}});
  Json left = Json::array();
  for (const auto& [plane, farthest] : borders.left)
    left.push_back({{"normal", {plane.normal[0], plane.normal[1], plane.normal[2]}},
                    {"offset", plane.offset},
                    {"farthest", farthest}});
  return {{"planes", planes},
          {"left", left},
          {"held", borders.held_vertices},
          {"beyond", borders.beyond},
          {"across", borders.across_vertices},
          {"strayed", borders.strayed_vertices},
          {"worst_angle", borders.worst_angle}};
}

Json limit_json(const LimitStatistics& limit) {
  return {{"before", faults_json(limit.before)},
          {"left", faults_json(limit.left)},
          {"source_crossings", limit.source_crossings},
          {"more_source_crossings", limit.more_source_crossings},
          {"crossings_near_source", limit.crossings_near_source},
          {"followed", limit.followed_vertices},
          {"untanglings", limit.untanglings},
          {"rounds", limit.rounds},
          {"vertices", limit.limited_vertices},
          {"faded", limit.faded_vertices},
          {"mean_thickness_lost", limit.thickness_lost}};
}

Json obstacles_json(const ObstacleFacts& obstacles) {
  return {{"gap", obstacles.gap},
          {"gap_at_start", obstacles.starting_gap},
          {"triangles_too_near", obstacles.near},
          {"touching_at_start", obstacles.touching},
          {"crossing_at_start", obstacles.crossing}};
}

Json fit_json(const FitFacts& fit) {
  return {{"clearance", fit.clearance},
          {"gap", fit.gap},
          {"gap_at_start", fit.starting_gap},
          {"triangles_too_near", fit.near},
          {"triangles_too_near_at_start", fit.near_at_start},
          {"vertices_moved", fit.moved},
          {"deepest", fit.deepest},
          {"rounds", fit.rounds},
          {"solid", fit.is_signed},
          {"components_enclosed", fit.enclosed}};
}

Json achieved_json(const AchievedSummary& achieved) {
  return {{"vertices", achieved.vertices},
          {"asked", {{"least", achieved.asked_least}, {"mean", achieved.asked_mean}, {"most", achieved.asked_most}}},
          {"share_reached", achieved.share_reached},
          {"least", achieved.least},
          {"quantile_01", achieved.quantile_01},
          {"quantile_05", achieved.quantile_05},
          {"median", achieved.median},
          {"quantile_95", achieved.quantile_95},
          {"mean", achieved.mean},
          {"most", achieved.most},
          {"worst_reached_error", achieved.worst_reached_error}};
}

Json faces_json(const FaceError& error) {
  return {{"samples", error.samples},
          {"mean_error", error.mean},
          {"error_quantile_99", error.quantile_99},
          {"worst_error", error.worst},
          {"share_within_1_percent", error.at_distance},
          {"share_beyond_at_corners", error.beyond},
          {"worst_beyond_at_corners", error.most_beyond},
          {"mean_farther", error.farther},
          {"causes",
           {{"held_back", error.held_back},
            {"stuck", error.stuck},
            {"no_room", error.no_room},
            {"sharp_corners", error.corners},
            {"coarse_faces", error.coarse}}}};
}

/// `facts` are of the mesh whose faces were judged.
Json certified_json(const CertifiedFaces& certified, const MeshFacts& facts) {
  Json report =
      certified.share > 0 ? Json{{"tolerance_share", certified.share}} : Json{{"tolerance_length", certified.length}};
  report["certified"] = certified.certified;
  report["there"] = certified.there;
  report["worst_left"] = certified.worst_left;
  report["worst"] = certified.worst;
  if (certified.source_faces > 0) {
    report["source_faces"] = certified.source_faces;
    report["source_vertices"] = certified.source_vertices;
    report["source_crossings"] = certified.source_crossings;
    report["faces"] = faces_in(facts);
    report["out_of_faces"] = certified.out_of_faces;
  }
  return report;
}

Json miters_json(const MiterFacts& miters) {
  return {{"on_creases", miters.on_creases}, {"mitered", miters.mitered},       {"cut", miters.cut},
          {"unproven", miters.unproven},     {"taken_back", miters.taken_back}, {"worst_excess", miters.excess}};
}

Json figures_json(const LayerFigures& figures) {
  Json faces = Json::object(), cells = Json::object();
  for (std::size_t r = 0; r < kFaceRoleCount; ++r) faces[name(static_cast<FaceRole>(r))] = figures.faces_by_role[r];
  for (std::size_t t = 0; t < kCellTypeCount; ++t) cells[name(static_cast<CellType>(t))] = figures.cells_by_type[t];
  return {{"name", figures.name},
          {"faces", faces},
          {"cells", figures.cells},
          {"cells_by_type", cells},
          {"transition_cells", figures.transition_cells},
          {"area", figures.area},
          {"fan_cells", figures.fan_cells},
          {"layers_reached", figures.layers_reached},
          {"coverage", figures.coverage},
          {"thickness_asked", spread_json(figures.asked)},
          {"thickness_reached", spread_json(figures.reached)},
          {"first_height",
           {{"vertices", figures.full_vertices},
            {"worst_error", figures.first_error},
            {"error_quantile_99", figures.first_error_99}}},
          {"scaled_jacobian", spread_json(figures.scaled_jacobian)},
          {"inverted_cells", figures.inverted_cells},
          {"poor_cells", figures.poor_cells},
          {"needles", figures.needles},
          {"aspect_ratio", spread_json(figures.aspect_ratio)},
          {"wall_angle", spread_json(figures.wall_angle)}};
}

Json layers_json(const LayerReport& layers) {
  Json report = figures_json(layers.all), patches = Json::array();
  for (const LayerFigures& patch : layers.patches) patches.push_back(figures_json(patch));
  report.erase("name");
  report["count"] = layers.layers;
  report["growth"] = {{"least", layers.growth.least}, {"largest", layers.growth.largest}};
  report["volume"] = layers.volume;
  if (layers.plane) report["least_segment"] = layers.least_segment;
  report["points"] = layers.points;
  report["growing"] = {{"wrong_columns", layers.growing.wrong_columns},
                       {"straightened", layers.growing.straightened},
                       {"rounds", layers.growing.rounds},
                       {"crowded_vertices", layers.growing.crowded_vertices},
                       {"least_edge", layers.growing.least_edge},
                       {"thinned_vertices", layers.growing.thinned_vertices},
                       {"flat_vertices", layers.growing.flat_vertices}};
  report["sides"] = {{"border", layers.border_sides},
                     {"unpaired", layers.unpaired_sides},
                     {"coincident", layers.coincident_sides},
                     {"split_points", layers.split_points},
                     {"turned_faces", layers.turned_faces}};
  report["inverted_block_cells"] = layers.inverted_block_cells;
  if (const auto& periodic = layers.periodic)
    report["periodic"] = {{"pairs", periodic->pairs}, {"copies", periodic->copies}, {"apart", periodic->apart}};
  if (layers.fill) report["fill"] = fill_json(*layers.fill);
  if (layers.foam)
    report["openfoam"] = {{"wrong_faces", layers.foam->wrong_faces},
                          {"non_orthogonality", layers.foam->non_orthogonality},
                          {"mean_non_orthogonality", layers.foam->mean_non_orthogonality},
                          {"non_orthogonal_faces", layers.foam->non_orthogonal_faces},
                          {"skewness", layers.foam->skewness},
                          {"skew_faces", layers.foam->skew_faces}};
  report["patches"] = patches;
  if (!layers.boundary.empty()) report["boundary"] = boundary_json(layers.boundary);
  return report;
}

Json grids_json(const OffsetStatistics& statistics) {
  return {{"active_voxels", statistics.active_voxels},
          {"leaf_nodes", statistics.leaf_nodes},
          {"bytes",
           {{"phi", statistics.phi_bytes},
            {"closest_primitive", statistics.closest_bytes},
            {"gradient", statistics.gradient_bytes}}},
          {"estimated_leaf_nodes", statistics.plan.leaf_nodes},
          {"estimated_bytes", statistics.plan.bytes}};
}

Json options_json(const RunFacts& run) {
  Json options = Json::object();
  for (const auto& [key, value] : run.options) options[key] = value;
  return options;
}

Json surface_json(const IsoStatistics& found) {
  const MendStatistics& mending = found.mending;
  const auto faults = [](const MeshFaults& counts) {
    return Json{{"crossings", counts.crossings}, {"without_area", counts.needles}};
  };
  const SolidFacts& solid = found.solid;
  return {{"signed", found.is_signed},
          {"source",
           {{"parts", solid.parts},
            {"open_parts", solid.open_parts},
            {"holes_filled", solid.holes},
            {"hole_share", solid.hole_share},
            {"buried_triangles", solid.buried},
            {"cut_triangles", solid.cut}}},
          {"vertices", found.vertices},
          {"triangles", found.triangles},
          {"components", found.components},
          {"dropped_specks", found.dropped_specks},
          {"merged_vertices", found.merged_vertices},
          {"attempts", found.attempts},
          {"valid", found.valid()},
          {"closed", found.closed()},
          {"manifold", found.manifold()},
          {"border_edges", found.border_edges},
          {"non_manifold_edges", found.non_manifold_edges},
          {"pinched_vertices", found.pinched_vertices},
          {"turned_edges", found.turned_edges},
          {"crossings", mending.left.crossings},
          {"without_area", mending.left.needles},
          {"mended",
           {{"before", faults(mending.before)},
            {"rounds", mending.rounds},
            {"moved_vertices", mending.moved_vertices},
            {"flipped_edges", mending.flipped_edges},
            {"split_edges", mending.split_edges}}},
          {"distance_error", {{"worst", found.worst_error}, {"rms", found.rms_error}}},
          {"faces", faces_json(found.faces)}};
}

/// The report of an offset. `achieved` sums up what became of the vertices; `distance` is the farthest one asked for.
std::string report_of(const OffsetStatistics& statistics, double distance, const AchievedSummary& achieved,
                      const RunFacts& run, const FaceError* first_faces = nullptr) {
  Json seconds = Json::object(), states = Json::object();
  for (std::size_t s = 0; s < kStageCount; ++s) seconds[name(static_cast<Stage>(s))] = statistics.seconds[s];
  seconds["total"] = run.total_seconds;
  for (std::size_t s = 0; s < kVertexStateCount; ++s)
    states[name(static_cast<VertexState>(s))] = statistics.vertices_by_state[s];
  Json report = {{"version", version()},
                 {"input", run.input},
                 {"output", run.output},
                 {"options", options_json(run)},
                 {"distance", distance},
                 {"distance_as_given", run.distance_text},
                 {"voxel_size", statistics.plan.voxel_size},
                 {"voxel_size_reason", statistics.plan.reason},
                 {"threads", statistics.threads},
                 {"mesh", facts_json(statistics.facts)},
                 {"grid", grids_json(statistics)},
                 {"seconds", seconds},
                 {"peak_memory_bytes", peak_memory()},
                 {"vertices_by_state", states},
                 {"vertices_straight", statistics.straight_vertices},
                 {"limit", limit_json(statistics.limit)},
                 {"borders", borders_json(statistics.borders)},
                 {"miters", miters_json(statistics.miters)},
                 {"room", room_json(statistics.room)},
                 {"achieved", achieved_json(achieved)}};
  if (statistics.faces.samples > 0) report["faces"] = faces_json(statistics.faces);
  if (const auto& e = statistics.exact) report["cad_faces"] = {{"mean_error", e->mean}, {"worst_error", e->worst}};
  if (statistics.certified) report["certified"] = certified_json(*statistics.certified, statistics.facts);
  if (first_faces && first_faces->samples > 0) report["faces_at_first_height"] = faces_json(*first_faces);
  if (statistics.obstacles) report["obstacles"] = obstacles_json(*statistics.obstacles);
  if (statistics.fit) report["fit"] = fit_json(*statistics.fit);
  if (run.shell) report["shell"] = shell_json(*run.shell);
  if (run.cad) report["cad_file"] = cad_json(*run.cad);
  if (run.layers) report["layers"] = layers_json(*run.layers);
  add_summary(report, run.summary);
  return as_text(report);
}

}  // namespace

std::string report_json(const OffsetResult& result, const RunFacts& run) {
  return report_of(result.statistics, result.distances.farthest(), summarise(result), run);
}

std::string report_json(const LayersResult& result, const RunFacts& run) {
  if (result.heights.empty()) return report_of(result.statistics, 0, {}, run);
  const Distances& thickness = result.heights.back();
  return report_of(result.statistics, thickness.farthest(), summarise(result.states, result.achieved, thickness), run,
                   &result.layer_statistics.first_faces);
}

std::string report_json(const IsoStatistics& statistics, const RunFacts& run) {
  Json seconds = Json::object();
  for (const Stage stage : kIsoStages) seconds[name(stage)] = statistics.seconds[static_cast<std::size_t>(stage)];
  seconds["total"] = run.total_seconds;
  Json report = {{"version", version()},
                 {"input", run.input},
                 {"output", run.output},
                 {"options", options_json(run)},
                 {"distance", statistics.distance},
                 {"distance_as_given", run.distance_text},
                 {"voxel_size", statistics.plan.voxel_size},
                 {"voxel_size_reason", statistics.plan.reason},
                 {"threads", statistics.threads},
                 {"mesh", facts_json(statistics.source)},
                 {"grid",
                  {{"leaf_nodes", statistics.leaf_nodes},
                   {"estimated_leaf_nodes", statistics.plan.leaf_nodes},
                   {"estimated_bytes", statistics.plan.bytes}}},
                 {"seconds", seconds},
                 {"peak_memory_bytes", peak_memory()},
                 {"surface", surface_json(statistics)}};
  if (run.shell) report["shell"] = shell_json(*run.shell);
  if (run.inner_surface) report["inner_surface"] = surface_json(*run.inner_surface);
  if (run.level_set)
    report["level_set"] = {{"active_voxels", run.level_set->active_voxels}, {"voxel_size", run.level_set->voxel_size}};
  add_summary(report, run.summary);
  return as_text(report);
}

std::string check_json(const CheckResult& result, const std::string& source, const std::string& offset,
                       const RunSummary& summary) {
  Json report = {{"version", version()},
                 {"source", source},
                 {"offset", offset},
                 {"valid", result.valid()},
                 {"distance", result.distance},
                 {"mesh", facts_json(result.facts)},
                 {"faults", faults_json(result.faults)},
                 {"source_crossings", result.source_crossings},
                 {"more_source_crossings", result.more_source_crossings},
                 {"crossings_near_source", result.crossings_near_source},
                 {"vertices_beyond", result.beyond},
                 {"vertices_on_wrong_side", result.wrong_side},
                 {"vertices_torn", result.torn},
                 {"achieved", achieved_json(summarise(result.states, result.achieved, result.distances))},
                 {"faces", faces_json(result.faces)}};
  if (result.certified) report["certified"] = certified_json(*result.certified, result.facts);
  if (result.obstacles) report["obstacles"] = obstacles_json(*result.obstacles);
  add_summary(report, summary);
  return as_text(report);
}

AchievedSummary summarise(const OffsetResult& result) {
  return summarise(result.states, result.achieved, result.distances);
}

}  // namespace vdb_offset
