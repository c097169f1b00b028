// Whether the options of a command line go together.
#include "args.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <sstream>

#include "declare_options.h"
#include "messages.h"
#include "option_values.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/iso_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/selection.h"
#include "vdb_offset/io/states_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/memory_limit.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"
#include "vdb_offset/scene.h"
#include "vdb_offset/version.h"

namespace vdb_offset::tool {
namespace {

// What is above this is 0 or more.
constexpr double kBelowZero = -std::numeric_limits<double>::denorm_min();

void check_obstacles(const Arguments& args) {
  for (const std::string& path : args.obstacles)
    require(format_of(path, args).has_value(),
            path + ": expected an obstacle that ends in .obj, .ply, .stl or .off (or these and .gz or .zst)");
}

void require_structured(const Arguments& args) {
  require(!args.layers || args.layers->structured == io::structured_format_of(args.output).has_value(),
          args.output + ": expected .vts or .xyz with --structured, and nothing else");
}

/// Curves stay curves, and know nothing of faces.
void check_curves(const Raw& raw, const Arguments& args) {
  const auto volume = io::volume_format_of(args.output);
  const auto structured = io::structured_format_of(args.output);
  const bool cells = volume == io::VolumeFormat::Vtu || volume == io::VolumeFormat::Su2 || structured;
  require(io::curve_format_of(args.output).has_value() || (args.layers && cells),
          args.output +
              ": expected an output that ends in .dat, .txt, .xy, .svg or .obj, or with --layers in .vtu, .su2, .vts "
              "or .xyz, "
              "as the input holds curves");
  require_structured(args);
  for (const auto& [name, given] : {std::pair{"--only", !raw.only.empty()},
                                    {"--border", raw.border.has_value()},
                                    {"--symmetry", !raw.symmetry.empty()},
                                    {"--obstacle", !args.obstacles.empty()},
                                    {"--shell", args.shell},
                                    {"--mode iso", args.iso.has_value()},
                                    {"--weld", raw.weld != "auto" && raw.weld != "exact"},
                                    {"--orient", raw.orient != "keep"}})
    require(!given, fmt::format("{}: expected a mesh, as this is not for curves", name));
}

void check_names(const Arguments& args) {
  require(!args.close, "--close: expected curves, as this is not for meshes");
  require(scene::is_scene(args.input) || format_of(args.input, args),
          args.input +
              ": expected an input that ends in .obj, .ply, .stl, .off (or these and .gz or .zst) or .json, or "
              "--format");
  const bool volume =
      io::volume_format_of(args.output).has_value() || io::structured_format_of(args.output).has_value();
  require(!volume || args.layers, args.output + ": expected a mesh, as this is for --layers");
  require_structured(args);
  require(volume || format_of(args.output, args).has_value(),
          args.output +
              ": expected an output that ends in .obj, .ply, .stl or .off (or these and .gz or .zst), or "
              "--format");
}

void check_file_options(const Raw& raw, Arguments& args) {
  require(args.states.empty() || io::is_states_file(args.states),
          args.states + ": expected a file of states that ends in .csv or .ply");
  require(args.paths.empty() ||
              (io::curve_format_of(args.paths) && io::curve_format_of(args.paths) != io::CurveFormat::Svg),
          args.paths + ": expected a file of paths that ends in .obj or .txt");
  require(args.vdb != "-", "--save-vdb: expected a file, got '-'");
  if (raw.format) {
    args.format = io::format_of("." + *raw.format);
    require(args.format && raw.format->find('.') == std::string::npos,
            fmt::format("--format: expected 'obj', 'ply', 'stl' or 'off', got '{}'", *raw.format));
  }
  require(raw.normals == "recompute" || raw.normals == "keep",
          fmt::format("--normals: expected 'recompute' or 'keep', got '{}'", raw.normals));
  args.write.normals = raw.normals == "keep" ? io::Normals::Keep : io::Normals::Recompute;
  if (raw.precision) args.write.digits = parse_count("--precision", *raw.precision, 1, 17);
}

DistanceRequest parse_request(const std::string& option, const std::string& text, const Arguments& args) {
  try {
    DistanceRequest request = tool::parse_request(text);
    require(!request.from.starts_with("ply:") || !scene::is_scene(args.input),
            option + ": expected a file, as a scene has no properties");
    return request;
  } catch (const InvalidOption& error) {
    throw UsageError(option + ": " + error.what());
  }
}

/// What asks for another distance, or for what goes with --distance alone.
void check_instead_of_distance(const Raw& raw, Arguments& args, const char* option, bool curves_too) {
  for (const auto& [name, given] : {std::pair{"--distance", !raw.distances.empty()},
                                    {"--distance-from", !raw.distance_from.empty()},
                                    {"--layers", raw.layers || !raw.heights.empty()},
                                    {"--shell", args.shell},
                                    {"--obstacle", !args.obstacles.empty()},
                                    {"--save-vdb", !args.vdb.empty()}})
    require(!given, fmt::format("{}: expected it without {}", name, option));
  require(curves_too || !args.curves, fmt::format("{}: expected a mesh, as this is not for curves", option));
}

void check_axes(const Raw& raw, Arguments& args) {
  args.axes = parse_axes(raw.distance_xy, raw.distance_z);
  if (!args.axes) return;
  check_instead_of_distance(raw, args, "--distance-xy", true);
  require(args.fit.empty(), "--fit: expected it without --distance-xy");
  require(!args.curves || args.write.digits == 0,
          "--precision: expected it without --distance-xy where there are curves");
  args.distances.push_back({fmt::format("{} xy {} z", raw.distance_xy, raw.distance_z), args.axes->xy, {}});
}

void check_fit(const Raw& raw, Arguments& args) {
  if (args.fit.empty()) return;
  check_instead_of_distance(raw, args, "--fit", false);
  for (const auto& [name, given] : {std::pair{"--mode iso", args.iso.has_value()},
                                    {"--dry-run", args.dry_run},
                                    {"--collision", raw.collision.has_value()}})
    require(!given, fmt::format("{}: expected it without --fit", name));
  require(!raw.clearance.empty(), "--fit: expected it with --clearance");
  require(format_of(args.fit, args).has_value(),
          args.fit + ": expected a mesh that ends in .obj, .ply, .stl or .off (or these and .gz or .zst)");
  args.distances.push_back({"fit", {}, {}});
}

void check_distances(const Raw& raw, Arguments& args) {
  if (args.axes || !args.fit.empty()) return;
  if (!raw.distance_from.empty()) args.distance_option = "--distance-from";
  args.distances = parse_distances(raw.distances, raw.distance_from, args);
  require(!args.distances.empty() || scene::is_scene(args.input),
          "--distance: expected a distance (a scene alone brings its own)");
  require(args.distances.size() < 2 || args.output != "-", "OUTPUT: expected a file for each distance, got '-'");
  require(raw.inner.empty() || args.shell, "--inner: expected it with --shell");
  if (raw.inner.empty()) return;
  args.inner = parse_request("--inner", raw.inner, args);
  const auto& inner = args.inner->distance;
  require(inner.expression || !args.inner->from.empty() || inner.value > 0,
          fmt::format("--inner: expected a distance above 0, got '{}'", raw.inner));
}

void check_layers(const Raw& raw, Arguments& args) {
  const bool asked = raw.layers || !raw.heights.empty();
  for (const auto& [name, given] : {std::pair{"--first-height", !raw.first_height.empty()},
                                    {"--total-thickness", !raw.total_thickness.empty()},
                                    {"--growth", raw.growth.has_value()},
                                    {"--structured", raw.structured}})
    require(asked || !given, fmt::format("{}: expected it with --layers", name));
  if (!asked) return;
  constexpr int kMostLayers = 1000;
  LayersRequest& layers = args.layers.emplace();
  if (raw.layers) layers.count = static_cast<std::size_t>(parse_count("--layers", *raw.layers, 1, kMostLayers));
  layers.heights = raw.heights;
  layers.structured = raw.structured;
  require(raw.heights.empty() + raw.first_height.empty() + raw.total_thickness.empty() == 2,
          "--layers: expected one of --first-height, --total-thickness and --heights");
  require(raw.heights.empty() || !raw.growth, "--growth: expected it with --first-height or --total-thickness");
  layers.growth = parse_number("--growth", raw.growth, "a number above 0, up to 10", 0, 10).value_or(layers.growth);
  if (!raw.first_height.empty()) layers.first = parse_request("--first-height", raw.first_height, args);
  if (!raw.total_thickness.empty()) layers.total = parse_request("--total-thickness", raw.total_thickness, args);
  for (const auto& [name, given] : {std::pair{"--distance", !raw.distances.empty()},
                                    {"--distance-from", !raw.distance_from.empty()},
                                    {"--shell", args.shell},
                                    {"--collision", raw.collision.has_value()},
                                    {"--paths", !args.paths.empty()},
                                    {"--save-vdb", !args.vdb.empty()}})
    require(!given, fmt::format("{}: expected it without --layers", name));
  require(args.output != "-", "OUTPUT: expected a file for layers, got '-'");
}

void check_iso(const Raw& raw, Arguments& args) {
  require(raw.mode == "topology" || raw.mode == "iso",
          fmt::format("--mode: expected 'topology' or 'iso', got '{}'", raw.mode));
  const bool asked = raw.mode == "iso";
  for (const auto& [name, given] : {std::pair{"--adaptivity", raw.adaptivity.has_value()},
                                    {"--inside", raw.inside.has_value()},
                                    {"--keep-specks", raw.keep_specks},
                                    {"--transport", raw.transport.has_value()}})
    require(asked || !given, fmt::format("{}: expected it with --mode iso", name));
  if (!asked) return;
  for (const auto& [name, given] : {std::pair{"--layers", raw.layers || !raw.heights.empty()},
                                    {"--only", !raw.only.empty()},
                                    {"--border", raw.border.has_value()},
                                    {"--symmetry", !raw.symmetry.empty()},
                                    {"--obstacle", !args.obstacles.empty()},
                                    {"--distance-from", !raw.distance_from.empty()},
                                    {"--collision", raw.collision.has_value()},
                                    {"--solver", raw.solver.has_value()},
                                    {"--normals", raw.normals != "recompute"},
                                    {"--states", !args.states.empty()},
                                    {"--paths", !args.paths.empty()},
                                    {"--save-vdb", !args.vdb.empty()}})
    require(!given, fmt::format("{}: expected it without --mode iso", name));
  IsoRequest& iso = args.iso.emplace();
  iso.adaptivity = parse_number("--adaptivity", raw.adaptivity, "a number from 0 to 1", kBelowZero, 1);
  iso.keep_specks = raw.keep_specks;
  const std::string inside = raw.inside.value_or("winding");
  require(inside == "winding" || inside == "never",
          fmt::format("--inside: expected 'winding' or 'never', got '{}'", inside));
  iso.use_winding = inside == "winding";
  if (!raw.transport) return;
  iso.transport_text = *raw.transport;
  iso.transport = parse_transport(*raw.transport);
}

/// Those of an iso-surface are even, and not 0.
void check_even(const Arguments& args) {
  if (!args.iso) return;
  for (const DistanceRequest& request : args.distances) {
    require(!request.distance.expression && request.from.empty(),
            fmt::format("--distance: expected a number with --mode iso, got '{}'", request.text));
    require(request.distance.value != 0, "--distance: expected one other than 0 with --mode iso");
  }
}

void check_surroundings(const Raw& raw, Arguments& args) {
  args.only_texts = raw.only;
  args.only = parse_only(raw.only);
  require(raw.only.empty() || !scene::is_scene(args.input), "--only: expected a mesh, as a scene names its own part");
  if (raw.border) args.border = parse_border(*raw.border);
  args.symmetry_texts = raw.symmetry;
  for (const std::string& text : raw.symmetry) {
    args.options.symmetry.find = args.options.symmetry.find && text != "none";
    if (text != "none") args.options.symmetry.planes.push_back(parse_plane(text));
  }
  args.clearance = parse_clearance(raw.clearance);
  if (raw.clearance.empty()) return;
  require(!args.obstacles.empty() || !args.fit.empty(), "--clearance: expected it with --obstacle or --fit");
  require(args.fit.empty() || args.clearance.value > 0,
          fmt::format("--clearance: expected one above 0 with --fit, got '{}'", raw.clearance));
}

void check(const Raw& raw, Arguments& args) {
  check_iso(raw, args);
  check_layers(raw, args);
  check_file_options(raw, args);
  args.curves = holds_curves(args.input);
  if (args.curves) check_curves(raw, args);
  else check_names(args);
  check_obstacles(args);
  check_axes(raw, args);
  check_fit(raw, args);
  if (!args.layers) check_distances(raw, args);
  check_even(args);
  check_surroundings(raw, args);
  require(!(raw.voxel_size && raw.voxels_per_distance), "--voxel-size: expected it or --voxels-per-distance, got both");
  constexpr double kAny = std::numeric_limits<double>::max();
  args.options.grid = {parse_number("--voxel-size", raw.voxel_size, "a number above 0", 0, kAny),
                       parse_number("--voxels-per-distance", raw.voxels_per_distance, "a number above 0", 0, kAny)};
  if (raw.collision) {
    require(*raw.collision == "limit" || *raw.collision == "merge",
            fmt::format("--collision: expected 'limit' or 'merge', got '{}'", *raw.collision));
    args.collision = *raw.collision == "merge" ? Collision::Merge : Collision::Limit;
  }
  if (raw.solver) {
    require(*raw.solver == "closest" || *raw.solver == "eikonal",
            fmt::format("--solver: expected 'closest' or 'eikonal', got '{}'", *raw.solver));
    args.solver = *raw.solver == "eikonal" ? Solver::Eikonal : Solver::Closest;
  }
  args.options.weld = parse_weld(raw.weld);
  args.options.orient = parse_orient(raw.orient);
  args.options.threads = parse_count("--threads", raw.threads, 0, kMostThreads);
  require(!(args.quiet && args.verbose), "--quiet: expected it or --verbose, got both");
  args.options.max_memory =
      raw.max_memory.empty() ? std::max<std::size_t>(1, available_memory() / 5 * 4) : parse_size(raw.max_memory);
}

}  // namespace

std::vector<DistanceRequest> parse_distances(const std::vector<std::string>& texts, const std::string& from,
                                             const Arguments& args) {
  require(texts.empty() || from.empty(), "--distance-from: expected it or --distance, got both");
  std::vector<DistanceRequest> requests;
  for (const std::string& text : texts) requests.push_back(parse_request("--distance", text, args));
  if (!from.empty())
    requests.push_back(parse_request("--distance-from", from.starts_with("ply:") ? from : "@" + from, args));
  return requests;
}

std::optional<io::Format> format_of(const std::string& path, const Arguments& args) {
  const auto format = io::format_of(path);
  return format ? format : args.format;
}

bool holds_curves(const std::string& path) {
  try {
    return io::holds_curves(path);
  } catch (const Error&) {
    return false;
  }
}

std::vector<std::string> reversed_arguments(int argc, const char* const* argv) {
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const auto mark = std::find(arguments.begin(), arguments.end(), "--");
  if (mark != arguments.end()) {
    // CLI11 takes the mark for the end of what an option before it lists. As ./NAME a name looks like no option.
    for (auto name = mark + 1; name != arguments.end(); ++name)
      if (name->starts_with('-') && *name != "-") name->insert(0, "./");
    arguments.erase(mark);
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

void require_values(const CLI::App& app) {
  for (const CLI::Option* const option : app.get_options())
    for (const std::string& value : option->results())
      require(!value.empty(), option->get_name() + ": expected a value, got ''");
}

void print_as_asked(const CLI::App& app, const CLI::Success& asked) {
  std::ostringstream text;
  app.exit(asked, text, text);
  fmt::print(Printout(), "{}", text.str());
}

std::optional<Arguments> parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kAbout, "vdb_offset");
  app.footer(kMore);
  app.set_version_flag("-V,--version", std::string("vdb_offset ") + version());
  Arguments args;
  Raw raw;
  declare(app, args, raw);
  try {
    app.parse(reversed_arguments(argc, argv));
  } catch (const CLI::Success& success) {
    print_as_asked(app, success);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("{} (--help lists the options)", error.what()));
  }
  require_values(app);
  check(raw, args);
  args.weld_text = raw.weld;
  args.orient_text = raw.orient;
  return args;
}

}  // namespace vdb_offset::tool
