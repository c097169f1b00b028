// SPDX-License-Identifier: Apache-2.0
// `vdb_offset check`: its command line, what it measures, and what it prints.
#include "check_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "file_plan.h"
#include "job.h"
#include "messages.h"
#include "page/run_pages.h"
#include "request/command_line.h"
#include "request/help.h"
#include "request/offset_options.h"
#include "request/option_rules.h"
#include "request/option_values.h"
#include "source.h"
#include "summary/summary.h"
#include "terminal.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kCheckAbout =
    "Measures OFFSET as an offset of SOURCE, whichever program made it: exact distances of all vertices, inverted\n"
    "and collapsed faces, and pairs of triangles that meet but do not in SOURCE, by exact predicates.\n"
    "Both must have the same vertices and faces in the same order, or OFFSET their triangles, as STL has them; or "
    "they\n"
    "are curves, with the same points. Give distances, parts, planes, obstacles, welding and orientation as they were\n"
    "for an offset by vdb_offset: then both find the same.";

constexpr const char* kCheckMore = R"(
Exit codes: 0 valid, 1 usage, 2 input, 3 not valid (or --strict and a vertex short), 4 output.)";

/// Declares the options that say how far the offset was to go.
void declare_how_far(CommandLine& line, CheckRequest& request) {
  Request& made = request.made;
  line.add_unit(made.unit, made.input, made.lengths);
  line.option("-d,--distance", "D",
              "Distance asked for: world units, or percent of SOURCE's diagonal; negative is inward; or an "
              "expression [that of most of the faces' area]",
              request.distance);
  line.option("--distance-xy", "A", "Instead, with --distance-z: as it was for the offset", request.distance_xy);
  line.option("--distance-z", "B", "The distance along z, with --distance-xy", request.distance_z);
  line.option("--distance-from", "FILE",
              "Instead: a number for each vertex, as text or .npy, 'ply:NAME', a vertex "
              "property of SOURCE, or 'vtk:NAME', an array of its points",
              request.distance_from);
}

}  // namespace

void declare_measuring(CommandLine& line, CheckRequest& request) {
  Request& made = request.made;
  made.border = Border::Slide;
  declare_how_far(line, request);
  line.repeated(
      "--only", "PART",
      "The part that was offset: 'group=NAME', 'material=NAME', 'faces=FILE', 'holes' ('holes<8', 'holes>8'), "
      "'concave', 'convex', 'up', 'down', 'planar:AXIS', 'face=N', 'name=NAME', 'color=RRGGBB', or 'not:PART'; may be "
      "repeated",
      [&made](const std::string& text) { made.only.push_back(parse_part("--only", text)); });
  line.option("--border", "MODE", "What the edge of that part did: 'slide', 'fixed' or 'free' [slide]", made.border,
              parse_border);
  line.repeated("--symmetry", "PLANE",
                "A plane that what lay on it was to stay in, as it was for the offset: 'x=0' (or y, z), 'A,B,C,D', or "
                "'none'; may be repeated",
                [&made](const std::string& text) { take_plane(text, made); });
  line.repeated("--obstacle", "FILE", "Another mesh that nothing may touch; repeatable",
                [&made](const std::string& text) { made.obstacles.push_back(text); });
  line.option("--clearance", "C", "How near to obstacles is too near [0]", made.clearance, parse_clearance);
  line.option("--corners", "KIND", "What became of sharp corners: 'miter', 'round' or 'arc' [miter]", made.corners,
              parse_corners);
  line.option(
      "--tolerance", "T",
      "Prove that every point of the faces is within T of the distance: world units, or percent of the distance",
      [&made](const std::string& text) {
        made.tolerance = ToleranceRequest{parse_tolerance(text), text, {}, {}};
      });
  line.option("--miter-limit", "L", "With --corners miter: how many distances vertices went at most [4]",
              made.miter_limit, parse_miter_limit);
  line.option("--precision", "N",
              "Significant digits of OFFSET's coordinates in text, for what counts as being there [all]",
              made.write.digits, count_between("--precision", 1, kMostDigits));
  line.option("--weld", "MODE",
              "Vertices of SOURCE that count as one: 'auto', 'exact', 'none', or within TOL world units, as it was for "
              "the offset [auto]",
              made.weld, parse_weld, made.weld_text);
  line.option(
      "--orient", "MODE",
      "Which side of SOURCE is outward, as it was for the offset: 'keep', 'fix-direction-only' or 'fix-cavities' "
      "[keep]",
      made.orient, parse_orient, made.orient_text);
  line.option("--flatten", "TOL",
              "How far straight segments were from the curved ones of a drawing, as it was for the offset [0.001%]",
              made.flatten, parse_flatten);
  declare_part_distances(line, made);
  declare_level_set(line, made);
  declare_cad(line, made);
  line.flag("--close", "SOURCE's curves were closed for the offset, where their ends are near each other", made.close);
}

void require_measuring(const CommandLine& line, CheckRequest& request) {
  Request& made = request.made;
  made.given = line.given();
  require_miters(made);
  require_page(made);
  using enum OptionRule::Relation;
  require_rules(made.given, {{{"--clearance"}, NeedsAnyOf, {"--obstacle"}},
                             {{"--distance-from"}, Excludes, {"--distance"}},
                             {{"--distance-xy"}, NeedsAnyOf, {"--distance-z"}},
                             {{"--distance-z"}, NeedsAnyOf, {"--distance-xy"}},
                             {{"--distance", "--obstacle", "--tolerance"}, Excludes, {"--distance-xy"}}});
  request.axes = parse_axes(request.distance_xy, request.distance_z);
}

namespace {

/// Reads the command line. None if it asked only for help, which is then printed.
std::optional<CheckRequest> parse_check(int argc, const char* const* argv) {
  CheckRequest request;
  Request& made = request.made;
  CommandLine line("vdb_offset check", kCheckAbout, kCheckMore, "vdb_offset check --help all");
  line.file(
      "SOURCE",
      "Mesh before (.obj .ply .stl .off .3mf .glb .gltf .vtp .vtk .vtu), CAD model (.step .iges .brep) or curves (.dat "
      ".txt .xy .svg .dxf .obj)",
      made.input);
  line.file("OFFSET", "Mesh or curves after", made.output);
  declare_measuring(line, request);
  line.option("--threads", "N", "Threads; 0 takes all [0]", made.threads, count_between("--threads", 0, kMostThreads));
  line.option("--report", "FILE", "Write what is found as JSON", made.report);
  line.option("--states", "FILE",
              "Write state, target and achieved distance of every vertex, as found: .csv, or .vtp or .ply to colour by "
              "in a viewer",
              made.states);
  line.option("--html", "FILE", "Write one page (.html) that shows SOURCE and OFFSET in a browser, faults marked",
              made.html);
  line.flag("--json", "Print JSON, not text", request.json);
  line.flag("--strict",
            "Exit with 3 if a vertex in use is not at the distance, or not all of the area proven to be within "
            "--tolerance",
            made.strict);
  line.option("--strict-faces", "P", "Exit with 3 unless 99 % of the faces' area is within P percent of the distance",
              made.strict_faces, parse_strict_faces);
  line.option("--strict-certified", "P", "With --tolerance: exit with 3 unless P percent of the area is certified",
              made.strict_certified, parse_strict_certified);
  line.arrange_help(help_topics(),
                    {"distance", "corners", "tolerance", "strict", "strict-faces", "report", "states", "html"},
                    kCheckMore);
  if (!line.parse(argc, argv)) return std::nullopt;
  require_measuring(line, request);
  require_states_file(made);
  return request;
}

/// Reads the distances, which may be expressions or files.
void take_distances(CheckRequest& request) {
  Request& made = request.made;
  if (!request.distance.empty()) made.distances.push_back(parse_distance_of("--distance", request.distance, made));
  if (!request.distance_from.empty()) made.distances.push_back(parse_distance_from(request.distance_from, made));
  complete_part_distances(made);
  made.distance_option = "--distance-from";
}

/// Refuses files to write that would replace one of those that are measured, or be mixed with the printed summary.
/// \param files_named those that files which were read name
void require_outputs_apart(const CheckRequest& request, std::span<const std::string> files_named = {}) {
  const Request& made = request.made;
  std::vector<RunFile> read = surroundings_of(made), written;
  for (const std::string& path : files_named) read.push_back({"the input's own files", path});
  read.push_back({"SOURCE", made.input});
  read.push_back({"OFFSET", made.output});
  if (!made.report.empty()) written.push_back({"--report", made.report});
  if (!made.states.empty()) written.push_back({"--states", made.states});
  if (!made.html.empty()) written.push_back({"--html", made.html});
  require_apart(read, written);
  for (const RunFile& file : written)
    if (request.json && is_standard_output(file.path))
      throw UsageError(fmt::format("{}: expected a file of its own, got {}, which is that of --json (standard output)",
                                   file.option, file.path));
}

/// The positions of the source's vertices in the offset, which has the same faces or, in another format, as STL and
/// glTF, their triangles; these then are what is judged. None if it has others.
std::optional<io::InTriangles> find_in_offset(const io::MeshFile& source_file, const io::MeshFile& offset_file) {
  const Polygons &source = source_file.polygons, &offset = offset_file.polygons;
  if (source.positions.size() == offset.positions.size() && source.face_begin == offset.face_begin &&
      source.corners == offset.corners)
    return io::InTriangles{offset.positions, {}};
  const bool may_be_triangles = offset_file.format != source_file.format || offset_file.format == io::Format::Stl;
  if (may_be_triangles) return io::find_in_triangles(source.view(), offset.view());
  return {};
}

[[noreturn]] void refuse_other_faces(const Request& made, PolygonView source, PolygonView offset) {
  throw InvalidInput(fmt::format(
      "{}: expected the vertices and faces of {} ({} and {}), found {} and {}{}{}", made.output, made.input,
      source.positions.size(), source.face_count(), offset.positions.size(), offset.face_count(),
      source.positions.size() == offset.positions.size() && source.face_count() == offset.face_count()
          ? " with other corners"
          : "",
      source.face_count() < offset.face_count()
          ? " (if that was made with --tolerance or --corners arc, its source is the file of --refined-source)"
          : ""));
}

/// \throw InvalidInput unless both have the same points. A curve that is closed in one of them may be open in the
/// other.
void require_same_points(const Request& made, CurvesView source, CurvesView offset) {
  if (source.positions.size() != offset.positions.size())
    throw InvalidInput(fmt::format("{}: expected the points of {} ({}), found {}", made.output, made.input,
                                   source.positions.size(), offset.positions.size()));
}

/// Writes what was found of each vertex and face, as far as that is asked for.
void write_findings(const Request& made, const Source& source, std::span<const Vec3d> positions,
                    const CheckResult& result, const io::ResultFaces& faces) {
  const PolygonView mesh = source.view();
  if (!made.states.empty())
    io::write_states(made.states, {positions, mesh.corners, mesh.face_begin},
                     {result.states, result.achieved, result.distances}, faces);
  if (!made.html.empty()) write_page(made, source, positions, result, faces);
}

/// Shows a result of which nothing can be measured.
void show_unmeasured(const Request& made, const Source& source, PolygonView result) {
  constexpr const char* kRemark = "has other vertices or faces than the source, so nothing is measured of it";
  report_problem(fmt::format("{}: {}", made.output, kRemark));
  write_page(made, source, result, std::string("The result ") + kRemark + ".");
}

std::optional<CheckResult> measure_curves(const CheckRequest& request, ProgressBar& bar) {
  const Request& made = request.made;
  const Source source = read_source(made, true);
  io::CurveReading how = curve_reading(made);
  // Shapes that did not move are curved in the offset as well, and get the same points.
  if (source.curves->flattened_shapes > 0) how = {0, source.curves->flattened_to};
  const io::CurveFile offset = io::read_curves(made.output, how);
  const CurvesView curves = source.view();
  if (request.may_differ && curves.positions.size() != offset.file.polygons.positions.size()) {
    show_unmeasured(made, source, offset.file.polygons.view());
    return {};
  }
  require_same_points(made, curves, offset.file.polygons.view());
  const Job job = resolve_options(made, source);
  CheckOptions options;
  options.threads = made.threads;
  options.progress = bar.callback();
  options.corners = job.corners();
  options.miter_limit = job.options.miter_limit;
  options.precision = io::precision_of_curves(made.output, *source.curves, made.write);
  if (!job.distances.empty()) options.distance = job.distances.front();
  CheckResult result = check_curves(curves, offset.file.polygons.positions, options);
  write_findings(made, source, offset.file.polygons.positions, result, {{}, nullptr, true});
  return result;
}

std::optional<CheckResult> measure_meshes(const CheckRequest& request, ProgressBar& bar) {
  const Request& made = request.made;
  const Source source = read_source(made, false, bar.callback());
  if (!source.file && !request.may_differ)
    throw InvalidInput(made.input + ": expected a mesh, or a scene with a file, got a scene's shape");
  const io::MeshFile offset = io::read_mesh(made.output);
  report_remarks(offset);
  std::vector<std::string> named = source.files_named;
  for (const auto* const files : {&offset.files_beside, &offset.files_named})
    named.insert(named.end(), files->begin(), files->end());
  require_outputs_apart(request, named);
  const auto found = source.file ? find_in_offset(*source.file, offset) : std::nullopt;
  if (!found) {
    if (!request.may_differ) refuse_other_faces(made, source.view(), offset.polygons.view());
    show_unmeasured(made, source, offset.polygons.view());
    return {};
  }
  const Job job = resolve_options(made, source);
  CheckOptions options;
  options.only = job.options.only;
  options.border = job.options.border;
  options.symmetry = job.options.symmetry;
  options.obstacles = job.options.obstacles;
  options.clearance = job.options.clearance;
  options.corners = job.corners();
  options.miter_limit = job.options.miter_limit;
  options.exact = job.options.exact;
  options.weld = job.options.weld;
  options.orient = job.options.orient;
  if (io::is_written(offset.format)) options.precision = io::target_of(made.output, offset, made.write).precision;
  options.precision.rounds_all = source.file->format != offset.format;
  options.threads = made.threads;
  options.progress = bar.callback();
  if (made.tolerance) {
    options.tolerance_share = made.tolerance->tolerance.share;
    options.tolerance_length = made.tolerance->tolerance.length;
  }
  if (!job.distances.empty()) options.distance = job.distances.front();
  if (request.axes) {
    const auto [metric, distance] = settle_axes(*request.axes, source.view());
    options.metric = metric;
    options.distance = distance;
  }
  options.keep_face_errors = made.states.ends_with(".vtp") || !made.html.empty();
  PolygonView judged = source.view();
  judged.triangles = found->triangles;
  CheckResult result = check_offset(judged, found->positions, options);
  const WallNames groups = io::wall_names(*source.file);
  write_findings(made, source, found->positions, result, {result.face_errors, &groups, false, result.face_faults});
  return result;
}

}  // namespace

std::optional<CheckResult> measure(CheckRequest& request) {
  const Request& made = request.made;
  report_lost_input(made.input);
  request.are_curves = holds_curves(made.input);
  if (request.are_curves && request.axes)
    throw UsageError("--distance-xy: expected meshes, as this is not for checking curves");
  require_options_for(made, request.are_curves, "meshes");
  take_distances(request);
  require_outputs_apart(request);
  for (const std::string& path : {made.report, made.states, made.html})
    if (!path.empty()) require_writable(path);
  ProgressBar bar(!made.quiet);
  bar.expect_writing(0);
  bar.show(Stage::Read, 0);
  std::optional<CheckResult> result = request.are_curves ? measure_curves(request, bar) : measure_meshes(request, bar);
  bar.show(Stage::Measure, 1);
  return result;
}

bool is_check(int argc, const char* const* argv) { return argc > 1 && std::string(argv[1]) == "check"; }

int run_check(int argc, const char* const* argv) {
  auto request = parse_check(argc - 1, argv + 1);
  if (!request) return kDone;
  request->made.command = as_typed(argc, argv);
  const Request& made = request->made;
  OutputFiles outputs(made.sync);
  const CheckResult result = measure(*request).value();
  const std::string json =
      check_json(result, made.input, made.output, summary_of(made, result, request->are_curves).for_report());
  if (!made.report.empty()) write_file(made.report, json);
  outputs.commit(ignore_interrupts);
  const Printout out(is_standard_output(made.report) || is_standard_output(made.states) ||
                     is_standard_output(made.html));
  if (request->json) fmt::print(out, "{}", json);
  else print_check(out, made, result, request->are_curves);
  const bool all_there = summarise(result.states, result.achieved, result.distances).share_reached == 1;
  if (made.strict_faces && !are_within(result.faces, *made.strict_faces, made.output)) return kProcessing;
  if (result.certified && !is_certified(*result.certified, made.certified_asked(), made.output, made.lengths))
    return kProcessing;
  return result.valid() && (all_there || !made.strict) ? kDone : kProcessing;
}

}  // namespace vdb_offset::tool
