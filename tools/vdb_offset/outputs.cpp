// SPDX-License-Identifier: Apache-2.0
#include "outputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "body_meshes.h"
#include "distances/part_distances.h"
#include "messages.h"
#include "page/run_pages.h"
#include "summary/summary.h"
#include "vdb_offset/api.h"
#include "vdb_offset/field.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

std::string numbers(const std::optional<Vec3d>& vector) {
  return vector ? fmt::format("{} {} {}", (*vector)[0], (*vector)[1], (*vector)[2]) : "";
}

/// The parts that have distances, or layers, of their own.
std::string parts_of(const Request& request, bool are_layers) {
  return request.layers.has_value() == are_layers ? fmt::format("{}", fmt::join(request.distance_of_texts, " ")) : "";
}

/// The names and values of all options that are in force.
std::vector<std::pair<std::string, std::string>> options_in_force(const Job& job, const Destination& to) {
  const Request& request = job.request;
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string("automatic");
  };
  const OffsetOptions& options = job.options;
  constexpr const char* kCorners[] = {"round", "miter", "arc"};
  const char* const border = options.border == Border::Slide   ? "slide"
                             : options.border == Border::Fixed ? "fixed"
                                                               : "free";
  const auto text_of = [](const std::optional<DistanceRequest>& distance) { return distance ? distance->text : ""; };
  const LayersRequest layers = request.layers.value_or(LayersRequest{});
  const IsoRequest iso = request.iso.value_or(IsoRequest{});
  const ToleranceRequest tolerance = request.tolerance.value_or(ToleranceRequest{});
  return {{"unit", request.unit},
          {"distance", to.distance},
          {"side-of", numbers(request.side_of)},
          {"distance-of", parts_of(request, false)},
          {"blend", request.blend_text},
          {"metric", numbers(options.metric.scale)},
          {"mode", request.iso ? "iso" : "topology"},
          {"adaptivity", iso.adaptivity ? fmt::format("{}", *iso.adaptivity) : "flat"},
          {"inside", iso.use_winding ? "winding" : "never"},
          {"tolerance", tolerance.text},
          {"max-faces",
           tolerance.tolerance.most_faces > 0 ? fmt::format("{}", tolerance.tolerance.most_faces) : "automatic"},
          {"refined-source", tolerance.refined_source},
          {"map", tolerance.map},
          {"keep-specks", iso.keep_specks ? "true" : "false"},
          {"transport", iso.transport_text.empty() ? "all" : iso.transport_text},
          {"layers", fmt::format("{}", layers.count)},
          {"first-height", text_of(layers.first)},
          {"total-thickness", text_of(layers.total)},
          {"last-height", text_of(layers.last)},
          {"y-plus", layers.y_plus ? fmt::format("{}", *layers.y_plus) : ""},
          {"layers-of", parts_of(request, true)},
          {"growth", layers.growth ? fmt::format("{}", *layers.growth) : ""},
          {"heights", layers.heights},
          {"fan-angle", request.layers ? fmt::format("{}", fan_angle_of(request)) : ""},
          {"periodic", request.periodic_text},
          {"structured", layers.structured ? "true" : "false"},
          {"only", fmt::format("{}", fmt::join(request.only_texts, " "))},
          {"border", border},
          {"obstacle", fmt::format("{}", fmt::join(request.obstacles, " "))},
          {"clearance", fmt::format("{}", options.clearance)},
          {"fit", request.fit},
          {"shell", job.shell ? "true" : "false"},
          {"inner", request.inner ? request.inner->text : ""},
          {"voxel-size", number(options.grid.voxel_size)},
          {"voxels-per-distance", number(options.grid.voxels_per_distance)},
          {"collision", options.collision == Collision::Merge ? "merge" : "limit"},
          {"corners", kCorners[static_cast<std::size_t>(job.corners())]},
          {"miter-limit", job.corners() == Corners::Miter ? fmt::format("{}", options.miter_limit) : ""},
          {"taper", fmt::format("{}", options.taper)},
          {"solver", options.solver == Solver::Eikonal ? "eikonal" : "closest"},
          {"weld", request.weld_text},
          {"orient", request.orient_text},
          {"symmetry", fmt::format("{}", fmt::join(request.symmetry_texts, " "))},
          {"normals", request.write.normals == io::Normals::Keep ? "keep" : "recompute"},
          {"precision", request.write.digits > 0 ? fmt::format("{}", request.write.digits) : "automatic"},
          {"threads", fmt::format("{}", options.threads)},
          {"max-memory", fmt::format("{}", options.max_memory)},
          {"deflection",
           job.source.file && job.source.file->exact ? fmt::format("{}", job.source.file->exact->deflection()) : ""},
          {"bodies", request.fuses_bodies ? "fuse" : "each"},
          {"flatten", job.source.curves && job.source.curves->flattened_shapes > 0
                          ? fmt::format("{}", job.source.curves->flattened_to)
                          : ""},
          {"strict", request.strict ? "true" : "false"}};
}

RunFacts facts_of(const Job& job, const Destination& to, Clock::time_point start) {
  RunFacts facts;
  facts.input = job.request.input;
  facts.output = to.mesh;
  facts.distance_text = to.distance;
  facts.total_seconds = seconds_since(start);
  facts.options = options_in_force(job, to);
  return facts;
}

/// The report, and the page that has it in it.
void write_report_and_page(const Job& job, const Outcome& outcome, const Products& made, Clock::time_point start) {
  const Destination& to = outcome.to;
  if (to.report.empty() && to.html.empty()) return;
  RunFacts facts = facts_of(job, to, start);
  facts.shell = made.shell;
  facts.cad = made.cad;
  facts.summary = summary_of(job, outcome, made).for_report();
  const std::string report = report_json(outcome.result, facts);
  if (!to.report.empty()) write_file(to.report, report);
  if (!to.html.empty()) write_page(job, outcome, report);
}

io::WriteResult write_mesh_or_shell(const Job& job, const Outcome& outcome, const std::optional<Shell>& shell) {
  const Source& source = job.source;
  const std::string& path = outcome.to.mesh;
  if (source.curves) {
    write_curves(path, source, outcome.result.positions, write_options(job.request, path));
    return {};
  }
  const io::Target target = job.target->at(path);
  if (shell) return source.file ? io::write_shell(target, *source.file, *shell) : io::write_shell(target, *shell);
  if (source.file) return io::write_mesh(target, *source.file, outcome.result.positions);
  io::write_mesh(target, source.view(), outcome.result.positions);
  return {};
}

io::CadWriting cad_writing(const Job& job) {
  const Request& request = job.request;
  io::CadWriting how;
  how.progress = OutputFiles::progress_of_next();
  how.format = request.format;
  how.fit_tolerance = request.fit_tolerance;
  how.only = job.options.only;
  how.thick = job.shell;
  how.exact = request.exact;
  how.obstacles = job.options.obstacles;
  how.clearance = job.options.clearance;
  how.holds_back = request.collision == Collision::Limit || how.obstacles.face_count() > 0;
  return how;
}

/// The distances of an output that is a CAD model.
io::CadDistances distances_of_model(const Job& job, const Destination& to) {
  const auto number = static_cast<std::size_t>(&to - job.files.outputs.data());
  return cad_distances(job, job.asked[number], job.distances[number]);
}

/// Writes each path as a curve.
void write_paths(const std::string& path, const std::vector<std::vector<Vec3d>>& paths) {
  Curves lines;
  for (const std::vector<Vec3d>& line : paths) {
    if (line.size() < 2) continue;  // a vertex that stays has no path
    for (const Vec3d& position : line) {
      lines.corners.push_back(static_cast<std::uint32_t>(lines.positions.size()));
      lines.positions.push_back(position);
    }
    lines.close_face();
  }
  io::write_curves(path, lines.view());
}

}  // namespace

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void report_losses(const Request& request, const std::string& path, const io::WriteResult& written) {
  if (request.quiet) return;
  if (!written.lost.empty()) report_problem(fmt::format("{}: not carried over: {}", path, written.lost));
  if (written.disagreeing_normals > 0)
    report_problem(
        fmt::format("{}: {} normals (vn) are shared by vertices that ask for different ones now; they got the mean "
                    "(--normals keep leaves all as they were)",
                    path, written.disagreeing_normals));
}

void write_refinement(const Request& request, const RefinedSource& refined) {
  report_losses(request, request.output, {fmt::format("{}", fmt::join(refined.lost, ", ")), 0});
  const auto& [tolerance, text, path, map] = *request.tolerance;
  if (!path.empty()) {
    const PolygonView mesh = refined.source.view();
    io::WriteOptions options;  // all digits: in the source's own format it is the source, with more vertices
    options.format = format_of(path, request);
    io::WriteResult written;
    if (refined.source.file) written = io::write_mesh(path, *refined.source.file, mesh.positions, options);
    else io::write_mesh(path, mesh, options);
    report_losses(request, path, written);
  }
  if (!map.empty()) io::write_vertex_map(map, refined.refinement, refined.vertex);
}

double fan_angle_of(const Request& request) {
  constexpr double kDefault = 60;
  const bool by_default =
      io::volume_format_of(request.output) && request.corners != Corners::Miter && !request.periodic;
  return request.layers->fan_angle.value_or(by_default ? kDefault : 0);
}

std::string layers_report(const Job& job, const LayersResult& result, const LayerReport& report,
                          Clock::time_point start) {
  RunFacts facts = facts_of(job, job.files.outputs.front(), start);
  facts.layers = report;
  facts.summary = summary_of(job, result, report).for_report();
  return report_json(result, facts);
}

void write_iso_report(const Job& job, const Destination& to, const IsoResult& result, Clock::time_point start,
                      const IsoProducts& made) {
  RunFacts facts = facts_of(job, to, start);
  facts.summary =
      summary_of(job, to.mesh, job.distances[static_cast<std::size_t>(&to - job.files.outputs.data())][0], result, made)
          .for_report();
  if (made.hollow) facts.shell = made.hollow->facts;
  if (made.inner) facts.inner_surface = made.inner->statistics;
  facts.level_set = made.level_set;
  write_file(to.report, report_json(result.statistics, facts));
}

std::vector<std::pair<std::string, std::string>> run_metadata(const Job& job, const Destination& to) {
  return {{"source", job.request.input},
          {"offset_distance", to.distance},
          {"made_by", std::string("vdb_offset ") + version()}};
}

Products write_outputs(const Job& job, const Outcome& outcome, Clock::time_point start) {
  const Request& request = job.request;
  const Destination& to = outcome.to;
  const OffsetResult& result = outcome.result;
  if (result.field) save_vdb(*result.field, request.vdb, run_metadata(job, to));
  const PolygonView mesh = job.source.view();
  const auto writing = Clock::now();
  std::optional<Shell> shell;
  Products made;
  if (job.shell && !is_cad_output(to.mesh, request)) {
    shell = shell_of(mesh, outcome.result, job.options, outcome.inner);
    report_states(*shell, outcome.result);
    made.shell = shell->facts;
  }
  const io::VertexStates states{result.states, result.achieved, result.distances};
  if (!to.states.empty()) {
    const WallNames groups = job.source.file ? io::wall_names(*job.source.file) : WallNames{};
    io::write_states(to.states, {result.positions, mesh.corners, mesh.face_begin}, states,
                     {result.face_errors, &groups, job.curves(), result.face_faults});
  }
  if (io::is_lines_file(to.paths)) io::write_path_lines(to.paths, result.paths, states);
  else if (!to.paths.empty()) write_paths(to.paths, result.paths);
  io::WriteResult written;
  if (is_cad_output(to.mesh, request)) {
    const io::CadWriting how = cad_writing(job);
    const Distances& distances = job.distances[static_cast<std::size_t>(&to - job.files.outputs.data())];
    const bool are_apart = !how.exact && !how.holds_back;
    made.cad = io::write_cad(to.mesh, *job.source.file, distances_of_model(job, to),
                             are_apart ? offset_bodies(job, distances, result) : result.positions, how);
    written.lost = fmt::format("{}", fmt::join(job.source.file->extras, ", "));
  } else written = write_mesh_or_shell(job, outcome, shell);
  outcome.result.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  write_report_and_page(job, outcome, made, start);
  report_losses(request, to.mesh, written);
  return made;
}

}  // namespace vdb_offset::tool
