#include "check_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "args.h"
#include "inputs.h"
#include "messages.h"
#include "places.h"
#include "terminal.h"
#include "vdb_offset/check.h"
#include "vdb_offset/curve_check.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/triangle_positions.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kCheckAbout =
    "Measures OFFSET as an offset of SOURCE, whichever program made it: exact distances of all vertices, inverted\n"
    "and collapsed faces, and pairs of triangles that meet but do not in SOURCE, by exact predicates.\n"
    "Both must have the same vertices and faces in the same order, or OFFSET their triangles, as STL has them; or "
    "they\n"
    "are curves, with the same points. What an offset by vdb_offset was told of distances, parts, obstacles, welding\n"
    "and orientation has to be told here as well; then both find the same.";

constexpr const char* kCheckMore = R"(
Exit codes: 0 valid, 1 usage, 2 input, 3 not valid (or --strict and a vertex short), 4 output.)";

struct CheckArguments {
  std::string source, offset, distance, distance_from, distance_xy, distance_z, border = "slide", clearance;
  std::string weld = "auto", orient = "keep", report;
  std::vector<std::string> only, obstacles;
  std::string threads_text = "0";
  std::optional<std::string> digits_text;
  int threads = 0, digits = 0;
  bool json = false, strict = false, close = false;
};

void declare(CLI::App& app, CheckArguments& args) {
  app.add_option("SOURCE", args.source, "Mesh before (.obj .ply .stl .off), or curves (.dat .txt .xy .svg .obj)")
      ->required();
  app.add_option("OFFSET", args.offset, "Mesh or curves after")->required();
  app.add_option("-d,--distance", args.distance,
                 "Distance asked for: world units, or percent of SOURCE's diagonal; negative is inward; or an "
                 "expression [the median of what is found]")
      ->type_name("D");
  app.add_option("--distance-xy", args.distance_xy, "Instead, with --distance-z: as it was for the offset")
      ->type_name("A");
  app.add_option("--distance-z", args.distance_z, "The same along z")->type_name("B");
  app.add_option("--distance-from", args.distance_from,
                 "Instead: a number for each vertex, as text or .npy, or ply:NAME, a vertex property of SOURCE")
      ->type_name("FILE");
  app.add_option("--only", args.only, "The part that was offset: group=NAME, material=NAME or faces=FILE; repeatable")
      ->type_name("PART")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--border", args.border, "What the edge of that part did: 'slide', 'fixed' or 'free' [slide]")
      ->type_name("MODE");
  app.add_option("--obstacle", args.obstacles, "Another mesh that nothing may touch; repeatable")
      ->type_name("FILE")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--clearance", args.clearance, "How near to obstacles is too near [0]")->type_name("C");
  app.add_option("--precision", args.digits_text,
                 "Significant digits of OFFSET's coordinates in text, for what counts as being there [all]")
      ->type_name("N");
  app.add_option(
         "--weld", args.weld,
         "Vertices of SOURCE that count as one: 'auto', 'exact', 'none', or within TOL world units, as it was for the "
         "offset [auto]")
      ->type_name("MODE");
  app.add_option("--orient", args.orient,
                 "Which side of SOURCE is outward, as it was for the offset: 'keep' or 'fix-direction-only' [keep]")
      ->type_name("MODE");
  app.add_flag("--close", args.close,
               "SOURCE's curves were closed for the offset, where their ends are near each other");
  app.add_option("--threads", args.threads_text, "Threads; 0 takes all [0]")->type_name("N");
  app.add_option("--report", args.report, "Write what is found as JSON")->type_name("FILE");
  app.add_flag("--json", args.json, "Print JSON, not text");
  app.add_flag("--strict", args.strict, "Exit with 3 if a vertex in use is not at the distance");
}

/// The same, as the command that made the offset would have them.
Arguments as_of_offset(const CheckArguments& args) {
  Arguments all;
  all.input = args.source;
  all.output = args.offset;
  all.obstacles = args.obstacles;
  all.only = parse_only(args.only);
  all.border = parse_border(args.border);
  all.clearance = parse_clearance(args.clearance);
  all.options.weld = parse_weld(args.weld);
  all.options.orient = parse_orient(args.orient);
  all.write.digits = args.digits;
  std::vector<std::string> distances;
  if (!args.distance.empty()) distances.push_back(args.distance);
  all.distances = parse_distances(distances, args.distance_from, all);
  return all;
}

void settle_counts(CheckArguments& args) {
  args.threads = parse_count("--threads", args.threads_text, 0, kMostThreads);
  if (args.digits_text) args.digits = parse_count("--precision", *args.digits_text, 1, 17);
}

/// The report may not take the place of what is measured, nor be mixed with what is printed.
void require_report_apart(const CheckArguments& args) {
  if (args.report.empty()) return;
  Arguments made = as_of_offset(args);
  if (!args.distance_from.empty()) made.distance_option = "--distance-from";
  std::vector<Place> read = surroundings_of(made);
  read.push_back({"SOURCE", args.source});
  read.push_back({"OFFSET", args.offset});
  require_apart(read, std::vector<Place>{{"--report", args.report}});
  if (args.json && is_standard_output(args.report))
    throw UsageError("--report: expected a file of its own, got " + args.report +
                     ", which is that of --json (standard output)");
}

void require_usable(const CheckArguments& args) {
  if (!args.clearance.empty() && args.obstacles.empty()) throw UsageError("--clearance: expected it with --obstacle");
}

/// Of the source's vertices in the offset: of the same faces, or of the triangles that STL has of them.
std::vector<Vec3d> places_of(const CheckArguments& args, const Polygons& source, const Polygons& offset) {
  if (source.positions.size() == offset.positions.size() && source.face_begin == offset.face_begin &&
      source.corners == offset.corners)
    return offset.positions;
  if (auto places = io::places_in_triangles(source.view(), offset.view())) return std::move(*places);
  throw InvalidInput(
      fmt::format("{}: expected the vertices and faces of {} ({} and {}), found {} and {}{}", args.offset, args.source,
                  source.positions.size(), source.face_count(), offset.positions.size(), offset.face_count(),
                  source.positions.size() == offset.positions.size() && source.face_count() == offset.face_count()
                      ? " with other corners"
                      : ""));
}

std::optional<double> parse_distance(const std::string& text, PolygonView source) {
  if (text.empty()) return std::nullopt;
  try {
    const scene::Distance distance = scene::parse_distance(text);
    return distance.in_world_units(distance.percent ? used_diagonal(source) : 0);
  } catch (const InvalidInput& error) {
    throw UsageError(std::string("--") + error.what());
  }
}

/// The same points; a curve that was closed for one of the two may be open in the other.
void require_same_points(const CheckArguments& args, const Curves& source, const Curves& offset) {
  if (source.positions.size() != offset.positions.size())
    throw InvalidInput(fmt::format("{}: expected the points of {} ({}), found {}", args.offset, args.source,
                                   source.positions.size(), offset.positions.size()));
}

void print(std::FILE* out, const CheckResult& result, bool curves) {
  const AchievedSummary achieved = summarise(result.states, result.achieved, result.distances);
  const char* const vertices = curves ? "points" : "vertices";
  fmt::print(out, "distance    {:.9g}: {:.3f} % of {} {} there, {} beyond, {} on the wrong side\n", result.distance,
             100 * achieved.share_reached, achieved.vertices, vertices, result.beyond, result.wrong_side);
  fmt::print(out, "achieved    least {:.6g}, 1 % {:.6g}, 5 % {:.6g}, median {:.6g}, 95 % {:.6g}, most {:.6g}\n",
             achieved.least, achieved.quantile_01, achieved.quantile_05, achieved.median, achieved.quantile_95,
             achieved.most);
  fmt::print(out, "{}off by {:.3g} % on average, {:.3g} % at 99 of 100 samples, {:.3g} % at most\n",
             curves ? "at middles  " : "in faces    ", 100 * result.interior.mean, 100 * result.interior.quantile_99,
             100 * result.interior.worst);
  fmt::print(out, "{}{} inverted, {} collapsed{}\n", curves ? "segments    " : "faces       ", result.faults.inverted,
             result.faults.collapsed,
             result.faults.crowded ? fmt::format(", {} too near to an obstacle", result.faults.crowded) : "");
  fmt::print(out, "crossings   {} new pairs of {}; {}{} in the source, {}\n", result.faults.crossings,
             curves ? "segments" : "triangles", result.more_source_crossings ? "more than " : "",
             result.source_crossings,
             result.more_source_crossings ? "what is beside those is not looked at"
                                          : fmt::format("{} beside those", result.crossings_near_source));
  if (result.facts.seams.vertices > 0)
    fmt::print(out,
               "seams       {} vertices of the source are one with others but for rounding, {:.2g} apart at most\n",
               result.facts.seams.vertices, result.facts.seams.widest);
  if (result.obstacles)
    fmt::print(out, "obstacles   gap {:.6g}, {:.6g} at the start; {} triangles nearer than the clearance\n",
               result.obstacles->gap, result.obstacles->starting_gap, result.obstacles->near);
  if (result.torn)
    fmt::print(out, "torn        {} {} are apart from others that they stood with\n", result.torn, vertices);
  fmt::print(out, "{}\n", result.valid() ? "valid" : "not valid");
}

CheckResult measure_curves(const CheckArguments& args) {
  io::CurveFile source = io::read_curves(args.source);
  const io::CurveFile offset = io::read_curves(args.offset);
  for (const auto& [name, given] : {std::pair{"--weld", args.weld != "auto"},
                                    {"--orient", args.orient != "keep"},
                                    {"--only", !args.only.empty()},
                                    {"--obstacle", !args.obstacles.empty()},
                                    {"--distance-from", !args.distance_from.empty()}})
    if (given) throw UsageError(fmt::format("{}: expected meshes, as this is not for curves", name));
  if (args.close) close_curves(source.file.polygons);
  require_same_points(args, source.file.polygons, offset.file.polygons);
  CheckOptions options;
  options.threads = args.threads;
  if (const auto distance = parse_distance(args.distance, source.file.polygons.view())) options.distance = *distance;
  return check_curves(source.file.polygons.view(), offset.file.polygons.positions, options);
}

CheckResult measure_meshes(const CheckArguments& args, const std::optional<AxisDistances>& axes) {
  if (args.close) throw UsageError("--close: expected curves, as this is not for meshes");
  Arguments made = as_of_offset(args);
  Source source = read_source(made);
  if (!source.file) throw InvalidInput(args.source + ": expected a mesh, or a scene with a file, got a scene's shape");
  const io::MeshFile offset = io::read_mesh(args.offset);
  tell_remarks(offset);
  const std::vector<Vec3d> places = places_of(args, source.file->polygons, offset.polygons);
  const std::vector<Distances> distances = settle_options(source, made);
  const OffsetOptions& of_offset = made.options;
  CheckOptions options;
  options.only = of_offset.only;
  options.border = of_offset.border;
  options.obstacles = of_offset.obstacles;
  options.clearance = of_offset.clearance;
  options.weld = of_offset.weld;
  options.orient = of_offset.orient;
  options.precision = io::precision_of(args.offset, offset, made.write);
  options.precision.rounds_all = source.file->format != offset.format;
  options.threads = args.threads;
  if (!distances.empty()) options.distance = distances.front();
  if (axes) {
    const auto [metric, distance] = settle_axes(*axes, source.view());
    options.metric = metric;
    options.distance = distance;
  }
  return check_offset(source.view(), places, options);
}

}  // namespace

bool is_check(int argc, const char* const* argv) { return argc > 1 && std::string(argv[1]) == "check"; }

int run_check(int argc, const char* const* argv) {
  CLI::App app(kCheckAbout, "vdb_offset check");
  app.footer(kCheckMore);
  CheckArguments args;
  declare(app, args);
  try {
    app.parse(reversed_arguments(argc - 1, argv + 1));
  } catch (const CLI::Success& success) {
    print_as_asked(app, success);
    return 0;
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("{} (check --help lists the options)", error.what()));
  }
  require_values(app);
  settle_counts(args);
  require_usable(args);
  require_report_apart(args);
  tell_of_lost_input(args.source);
  const auto axes = parse_axes(args.distance_xy, args.distance_z);
  if (axes && !args.distance.empty()) throw UsageError("--distance: expected it without --distance-xy");
  if (axes && !args.obstacles.empty()) throw UsageError("--obstacle: expected it without --distance-xy");
  const bool curves = holds_curves(args.source);
  if (curves && axes) throw UsageError("--distance-xy: expected meshes, as this is not for checking curves");
  const CheckResult result = curves ? measure_curves(args) : measure_meshes(args, axes);
  const std::string json = check_json(result, args.source, args.offset);
  if (!args.report.empty()) write_file(args.report, json);
  const Printout out(is_standard_output(args.report));
  if (args.json) fmt::print(out, "{}", json);
  else print(out, result, curves);
  const bool all_there = summarise(result.states, result.achieved, result.distances).share_reached == 1;
  return result.valid() && (all_there || !args.strict) ? 0 : 3;
}

}  // namespace vdb_offset::tool
