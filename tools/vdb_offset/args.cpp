#include "args.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "messages.h"
#include "vdb_offset/decimal.h"
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

constexpr const char* kAbout =
    "Offsets a mesh by a distance and keeps its topology: the same vertices in the same order, the same faces,\n"
    "texture coordinates, groups and materials; only positions (and normals) change.";

constexpr const char* kMore = R"(
INPUT and OUTPUT end in .obj, .ply, .stl or .off, compressed with .gz or .zst behind it, or are '-' (standard input and
output, with --format); INPUT may also be a scene (.json), which brings its distance. The same format in and out keeps
every byte but coordinates and normals of what moved. Plane curves are files that end in .dat, .txt, .xy or .svg, or an
.obj with line elements and no face.
D is in the file's own units, or a percentage of the diagonal of the bounding box of the vertices in use;
below zero it is inward. Write --distance=-1% or --distance -1%. Or it is an expression, which tells each vertex its
own: in x y z (place), nx ny nz (normal) and u v (texture coordinates), with numbers, pi, e, + - * / ^, ?: and
functions (sin, sqrt, min ...); a % behind it makes it percent. Several distances give several outputs: NAME_001.obj,
NAME_002.obj ..., or OUTPUT holds {i} (their number) or {d} (the distance as given).

Examples:
  vdb_offset bunny.obj bigger.obj --distance 1%         enlarge by 1 % of the diagonal
  vdb_offset part.stl clearance.stl --distance -0.2     shrink by 0.2 units
  vdb_offset wing.ply out.ply --distance 0.5% --report out.json --strict
  vdb_offset big.obj out.obj --distance 2 --dry-run     what would it take?
  vdb_offset wing.obj skin.obj --distance '0.02*(1 - u)'       thicker towards u = 0
  vdb_offset car.obj out.obj --distance 5 --only group=roof    one part; the rest stays
  vdb_offset vase.stl shell.stl --distance -2 --shell          a closed solid, 2 units thick
  vdb_offset part.ply 'part_{d}.ply' --distance 1% --distance 2% --distance 3%
  vdb_offset wing.obj wing.vtu --layers 10 --first-height 0.02% --growth 1.2     cells for a solver
  vdb_offset part.stl out.stl --distance-xy -0.1 --distance-z -0.05      less across than up
  vdb_offset peg.stl out.stl --fit socket.stl --clearance 0.1           makes room where there is less
  vdb_offset scan.obj clean.obj --distance 1% --mode iso       a clean surface of its own, textures and all
  vdb_offset scenes/torus.json torus.obj                a procedural scene
  vdb_offset check bunny.obj bigger.obj                 measure an offset (vdb_offset check --help)

Exit codes: 0 done, 1 usage, 2 input, 3 processing (or --strict and a vertex short, or a scene's expectation not
met), 4 output. Ctrl-C and the like end the process at once, by that signal, and every output is as it was before;
once they are put in place, all together, a signal changes nothing more.
Report keys, library and guarantees: see the guides in docs/.)";

// What is above this is 0 or more.
constexpr double kBelowZero = -std::numeric_limits<double>::denorm_min();

/// Bytes with an optional suffix K, M, G or T (binary), as in "4G" or "1.5 GiB".
std::size_t parse_size(const std::string& text) {
  double value = 0;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  std::string suffix;
  for (const char* c = end; c != text.data() + text.size(); ++c)
    if (*c != ' ') suffix += static_cast<char>(std::toupper(static_cast<unsigned char>(*c)));
  static const std::map<std::string, double> kUnits = {
      {"", 1},         {"B", 1},       {"K", 0x1p10},   {"KB", 0x1p10}, {"KIB", 0x1p10},
      {"M", 0x1p20},   {"MB", 0x1p20}, {"MIB", 0x1p20}, {"G", 0x1p30},  {"GB", 0x1p30},
      {"GIB", 0x1p30}, {"T", 0x1p40},  {"TB", 0x1p40},  {"TIB", 0x1p40}};
  const auto unit = kUnits.find(suffix);
  if (error != std::errc() || unit == kUnits.end() || !(value > 0) || value * unit->second > 0x1p60)
    throw UsageError(fmt::format("--max-memory: expected a size such as 4G or 512M, got '{}'", text));
  return std::max<std::size_t>(1, static_cast<std::size_t>(value * unit->second));
}

/// What CLI11 fills in before it is checked.
struct Raw {
  std::vector<std::string> distances, only, symmetry;
  std::optional<std::string> layers, growth, adaptivity;
  std::string distance_from, distance_xy, distance_z, first_height, total_thickness, heights;
  bool structured = false, keep_specks = false;
  std::string max_memory, clearance, inner, weld = "auto", orient = "keep";
  std::optional<std::string> solver, collision, border, format, transport;
  std::string mode = "topology";
  std::optional<std::string> inside;
  std::string normals = "recompute";
  std::optional<std::string> voxel_size, voxels_per_distance;
  std::optional<std::string> precision;
  std::string threads = "0";
};

void declare(CLI::App& app, Arguments& args, Raw& raw) {
  app.add_option("INPUT", args.input,
                 "Mesh to offset (.obj .ply .stl .off, also .gz .zst; '-'), curves (see below), or a scene (.json)")
      ->required();
  app.add_option("OUTPUT", args.output, "Mesh to write, by extension; may be the input; '-' is standard output")
      ->required();
  app.add_option(
         "-d,--distance", raw.distances,
         "Distance: world units, percent of the diagonal as in 1.5%, or an expression; negative is inward; given "
         "several times: one output each")
      ->type_name("D")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--mode", raw.mode,
                 "'topology' moves the mesh's own vertices; 'iso' captures the surface at the distance as a new mesh, "
                 "closed and manifold, for which INPUT may be anything [topology]")
      ->type_name("MODE");
  app.add_option(
         "--adaptivity", raw.adaptivity,
         "With --mode iso: how readily cells are merged where the surface is nearly flat, 0 (none) to 1 [triangles are "
         "merged where that changes nothing: where it is flat and nothing comes along]")
      ->type_name("X");
  app.add_option("--inside", raw.inside,
                 "With --mode iso: 'winding' tells what is inside of a mesh that is closed but for small holes, or has "
                 "edges of four faces and more; 'never' takes such a mesh as open, with a surface on all its sides "
                 "[winding]")
      ->type_name("MODE");
  app.add_flag("--keep-specks", raw.keep_specks,
               "With --mode iso: keep pieces that enclose less than a voxel, as knife edges leave them");
  app.add_option(
         "--transport", raw.transport,
         "With --mode iso: what comes along from INPUT, of 'uv', 'color' and 'material', separated by commas, or "
         "'none' [all that INPUT has and OUTPUT can hold]")
      ->type_name("LIST");
  app.add_option("--distance-from", raw.distance_from,
                 "Each vertex's distance, world units: a file of numbers (text or .npy), or 'ply:NAME', a vertex "
                 "property of INPUT; elsewhere '@FILE' and 'ply:NAME' say the same")
      ->type_name("FILE");
  app.add_option(
         "--distance-xy", raw.distance_xy,
         "Instead of --distance, with --distance-z: how far within the plane of x and y, world units or percent")
      ->type_name("A");
  app.add_option("--distance-z", raw.distance_z,
                 "With --distance-xy, of its sign: how far along z; 0 is a thousandth of A")
      ->type_name("B");
  app.add_option("--only", raw.only,
                 "Offset this part alone; the rest stays and is in the way: 'group=NAME', 'material=NAME' or "
                 "'faces=FILE' (indices from 0, or a 0 or 1 for each face); may be repeated")
      ->type_name("PART")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--border", raw.border,
                 "What the edge of that part does: 'slide' along the surface that stays, 'fixed' or 'free' [slide]")
      ->type_name("MODE");
  app.add_option(
         "--symmetry", raw.symmetry,
         "A plane that what lies on it stays in: 'x=0', 'y=1.5', or 'A,B,C,D' for A x + B y + C z = D; may be "
         "repeated; 'none': not even borders stay in the planes that they lie in, as they do without being told")
      ->type_name("PLANE")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--obstacle", args.obstacles, "A mesh that nothing may touch; may be repeated")
      ->type_name("FILE")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--clearance", raw.clearance,
                 "Come no nearer to obstacles than this: world units, or percent of INPUT's diagonal [0]")
      ->type_name("C");
  app.add_option("--fit", args.fit,
                 "Instead of --distance, with --clearance: what is nearer to this mesh gives way, inward, until it is "
                 "that far from it; all else stays")
      ->type_name("FILE");
  app.add_flag("--shell", args.shell,
               "Write the source and its offset as one closed solid, joined by a rim where the surface is open; with "
               "--mode iso: a hollow solid, the source's own faces and one clean cavity, or skin");
  app.add_option("--inner", raw.inner,
                 "With --shell: the inner skin lies this far inward, not on the source; with --mode iso both are clean")
      ->type_name("E");
  app.add_option(
         "--layers", raw.layers,
         "Grow N layers of cells: with --first-height or --total-thickness, and --growth; OUTPUT is .vtu, .msh, "
         ".cgns, .su2, a folder called polyMesh, or a mesh for each layer")
      ->type_name("N");
  app.add_option("--first-height", raw.first_height, "Height of the first layer, as --distance")->type_name("A");
  app.add_option("--total-thickness", raw.total_thickness, "Height of all layers together, as --distance")
      ->type_name("T");
  app.add_option("--growth", raw.growth, "Each layer's height by that of the one below [1.2]")->type_name("R");
  app.add_option("--heights", raw.heights, "A file of heights above the wall, one a line, each as --distance")
      ->type_name("FILE");
  app.add_flag("--structured", raw.structured,
               "With --layers: the mesh is a grid of quads, and OUTPUT a block of hexahedra: .vts, or Plot3D's .xyz");
  app.add_flag("--close", args.close,
               "Of curves: close those whose ends are near each other, by a straight segment, as over the base of a "
               "blunt trailing edge");
  app.add_option("--voxel-size", raw.voxel_size, "Voxel size of the direction field, world units [automatic: about D]")
      ->type_name("H");
  app.add_option("--voxels-per-distance", raw.voxels_per_distance, "The same as D / N")->type_name("N");
  app.add_option(
         "--collision", raw.collision,
         "Where faces would fold or cross: 'limit' holds vertices back so that none does, 'merge' lets them go as "
         "far as the distance grows [limit]")
      ->type_name("MODE");
  app.add_option("--solver", raw.solver,
                 "How the field is extended: 'closest' (exact) or 'eikonal' (first order) [closest]")
      ->type_name("NAME");
  app.add_option(
         "--weld", raw.weld,
         "Vertices that move as one: 'auto' (equal positions, and borders that are one but for the file's rounding), "
         "'exact' (equal positions), 'none', or within TOL world units [auto]")
      ->type_name("MODE");
  app.add_option("--orient", raw.orient,
                 "Outward is where the faces point ('keep'), or out of what a closed component encloses even where it "
                 "is inside out ('fix-direction-only'; the faces stay as they are) [keep]")
      ->type_name("MODE");
  app.add_option("--format", raw.format, "Format of '-' and of files with another ending: 'obj', 'ply', 'stl' or 'off'")
      ->type_name("NAME");
  app.add_option("--normals", raw.normals,
                 "Normals of the file where faces moved: 'recompute' or 'keep' them as they are [recompute]")
      ->type_name("MODE");
  app.add_option("--precision", raw.precision,
                 "Significant digits of moved coordinates in text, 1 to 17 [as many as read back to the same number]")
      ->type_name("N");
  app.add_option("--threads", raw.threads, "Threads; 0 takes all; the result is the same for any number [0]")
      ->type_name("N");
  app.add_option("--max-memory", raw.max_memory, "Refuse work that would need more, as in 4G [80 % of what is free]")
      ->type_name("SIZE");
  app.add_option("--report", args.report, "Write what happened as JSON")->type_name("FILE");
  app.add_option("--states", args.states,
                 "Write state, target and achieved distance of every vertex: .csv, or .ply to colour by in a viewer")
      ->type_name("FILE");
  app.add_option("--paths", args.paths, "Write the path of every vertex as a line: .obj (or .txt)")->type_name("FILE");
  app.add_option("--save-vdb", args.vdb, "Write phi and the closest triangles as OpenVDB grids")->type_name("FILE");
  app.add_flag_callback(
      "--no-sync", [&args] { args.sync = OutputFiles::Sync::No; },
      "Do not wait until outputs are on the disk before they get their names");
  app.add_flag("--strict", args.strict, "Exit with 3 if a vertex in use falls short of the distance");
  app.add_flag("--dry-run", args.dry_run, "Read the input, print what would be done, write nothing");
  app.add_flag("-q,--quiet", args.quiet, "Print nothing but errors");
  app.add_flag("-v,--verbose", args.verbose, "Print the mesh's facts and the seconds of each stage");
}

void require(bool holds, const std::string& message) {
  if (!holds) throw UsageError(message);
}

/// Of an option that may be left out. `expected` says which numbers it takes.
std::optional<double> parse_number(const char* option, const std::optional<std::string>& text, const char* expected,
                                   double above, double most) {
  if (!text) return std::nullopt;
  const auto value = decimal<double>(*text);
  require(value && *value > above && *value <= most, fmt::format("{}: expected {}, got '{}'", option, expected, *text));
  return value;
}

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

io::TransportRequest parse_transport(const std::string& text) {
  io::TransportRequest request{false, false, false, true};
  if (text == "none") return request;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    bool* const wanted = word == "uv"         ? &request.texture
                         : word == "color"    ? &request.colours
                         : word == "material" ? &request.materials
                                              : nullptr;
    require(wanted != nullptr,
            fmt::format("--transport: expected 'uv', 'color' and 'material', separated by commas, or 'none', got '{}'",
                        text));
    *wanted = true;
    begin = end + 1;
  }
  return request;
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

int parse_count(const char* option, const std::string& text, int least, int most) {
  const auto value = decimal<int>(text);
  require(value && *value >= least && *value <= most,
          fmt::format("{}: expected {} to {}, got '{}'", option, least, most, text));
  return *value;
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

DistanceRequest parse_request(const std::string& text) {
  if (text.starts_with("ply:")) return {text, {}, text};
  if (text.starts_with('@')) {
    if (text.size() == 1) throw InvalidOption("expected a file's name behind the '@'");
    return {text.substr(1), {}, text.substr(1)};
  }
  return {text, scene::parse_distance_or_expression(text), {}};
}

std::vector<io::Selector> parse_only(const std::vector<std::string>& texts) {
  std::vector<io::Selector> only;
  for (const std::string& text : texts) {
    try {
      only.push_back(io::parse_selector(text));
    } catch (const InvalidOption& error) {
      throw UsageError(std::string("--only: ") + error.what());
    }
  }
  return only;
}

Border parse_border(const std::string& text) {
  require(text == "slide" || text == "fixed" || text == "free",
          fmt::format("--border: expected 'slide', 'fixed' or 'free', got '{}'", text));
  return text == "slide" ? Border::Slide : text == "fixed" ? Border::Fixed : Border::Free;
}

scene::Distance parse_clearance(const std::string& text) {
  scene::Distance clearance;
  if (text.empty()) return clearance;
  try {
    clearance = scene::parse_distance(text);
  } catch (const InvalidInput&) {
    clearance.value = -1;
  }
  require(clearance.value >= 0,
          fmt::format("--clearance: expected a number of world units or percent, 0 or more, got '{}'", text));
  return clearance;
}

WeldOptions parse_weld(const std::string& text) {
  WeldOptions weld;
  if (text == "auto") return WeldOptions::automatic();
  if (text == "exact") return weld;
  if (text == "none") {
    weld.enabled = false;
    return weld;
  }
  const auto tolerance = decimal<double>(text);
  require(tolerance && *tolerance >= 0,
          fmt::format("--weld: expected 'auto', 'exact', 'none' or a tolerance >= 0 in world units, got '{}'", text));
  weld.tolerance = *tolerance;
  return weld;
}

Orient parse_orient(const std::string& text) {
  if (text == "keep") return Orient::Keep;
  if (text == "fix-direction-only") return Orient::FixDirectionOnly;
  throw UsageError(fmt::format("--orient: expected 'keep' or 'fix-direction-only', got '{}'", text));
}

SymmetryPlane parse_plane(const std::string& text) {
  const auto number = [&](std::string_view word) {
    const auto value = decimal<double>(word);
    require(value.has_value(),
            fmt::format("--symmetry: expected 'x=0' (or y, z), 'A,B,C,D' for A x + B y + C z = D, or 'none', got '{}'",
                        text));
    return *value;
  };
  SymmetryPlane plane;
  const std::string_view given = text;
  if (given.size() > 2 && given[1] == '=' && given[0] >= 'x' && given[0] <= 'z') {
    plane.normal[given[0] - 'x'] = 1;
    plane.offset = number(given.substr(2));
    return plane;
  }
  std::vector<double> factors;
  for (std::size_t begin = 0; begin <= given.size();) {
    const std::size_t end = std::min(given.find(',', begin), given.size());
    factors.push_back(number(given.substr(begin, end - begin)));
    begin = end + 1;
  }
  factors.resize(factors.size() == 4 ? 4 : 0);
  const double length = factors.empty() ? 0 : std::hypot(factors[0], factors[1], factors[2]);
  if (!(length > 0)) number("");
  for (int k = 0; k < 3; ++k) plane.normal[k] = factors[static_cast<std::size_t>(k)] / length;
  plane.offset = factors[3] / length;
  return plane;
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
