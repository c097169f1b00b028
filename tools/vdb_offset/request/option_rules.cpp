// SPDX-License-Identifier: Apache-2.0
// Rules about which options of an offset, and which names of files, go together.
#include "request/option_rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "request/option_values.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {
namespace {

/// The first of some options that is given; null: none is.
const char* first_given(const Request& request, std::initializer_list<const char*> options) {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const char* option) { return request.given.contains(option); });
  return found == options.end() ? nullptr : *found;
}

constexpr const char* kMeshEndings =
    ".obj, .ply, .stl, .off, .3mf, .glb, .gltf, .vtp, .vtk or .vtu (or these and .gz or .zst)";

void require_structured(const Request& request) {
  require(!request.layers || request.layers->structured == io::structured_format_of(request.output).has_value(),
          request.output + ": expected .vts or .xyz with --structured, and nothing else");
}

/// Rules for an input of curves: outputs hold curves, and options about faces are refused.
void require_for_curves(const Request& request) {
  const auto volume = io::volume_format_of(request.output);
  const bool cells = volume || io::structured_format_of(request.output);
  require(io::curve_format_of(request.output).has_value() || (request.layers && cells),
          request.output +
              ": expected an output that ends in .dat, .txt, .xy, .svg, .dxf or .obj, or with --layers in "
              ".vtu, .su2, .msh, .cgns, .vts, .xyz or a folder named polyMesh, as the input holds curves");
  require(!request.fill || volume,
          request.output + ": expected .vtu, .su2, .msh, .cgns or a folder named polyMesh with --fill");
  require(!request.fill || request.fill->farfield_file.empty(),
          "--farfield: expected 'sphere:20L' or 'box:10L' for curves, got a file");
  require_structured(request);
  require(!request.layers || request.layers->fan_angle.value_or(0) == 0 || volume,
          request.output + ": expected a file of cells with --fan-angle for curves, whose files have no room for fans");
  require(!request.axes || request.write.digits == 0, "--precision and --distance-xy exclude each other for curves");
}

/// Rules about options and what files are, which are named in words.
void require_with_files(const Request& request) {
  constexpr const char *kModel = "an output that ends in .step, .stp or .brep",
                       *kHollowModel = "--shell of a CAD model",
                       *kLevelSet = "an input, an obstacle or a --fit that ends in .vdb";
  using enum OptionRule::Relation;
  GivenNames given = request.given;
  if (is_cad_output(request.output, request)) given.insert({kModel, request.shell ? kHollowModel : kModel});
  const auto is_vdb = [&](const std::string& path) { return format_of(path, request) == io::Format::Vdb; };
  if (is_vdb(request.input) || is_vdb(request.fit) || std::ranges::any_of(request.obstacles, is_vdb))
    given.insert(kLevelSet);
  require_rules(given, {{{"--exact", "--fit-tolerance", "--collision cut"}, NeedsAnyOf, {kModel}},
                        {{"--inner", "--layers", "--heights", "--mode iso", "--tolerance", "--distance-xy", "--fit",
                          "--side-of", "--symmetry", "--miter-limit", "--taper", "--collision merge", "--corners arc"},
                         Excludes,
                         {kModel}},
                        {{"--distance-of"}, Excludes, {kHollowModel}},
                        {{"--grid", "--isovalue"}, NeedsAnyOf, {kLevelSet}}});
}

void require_for_mesh(const Request& request) {
  require(
      scene::is_scene(request.input) || format_of(request.input, request),
      request.input +
          ": expected an input that ends in .obj, .ply, .stl, .off, .3mf, .glb, .gltf, .vtp, .vtk, .vtu, .fbx, .dae, "
          ".3ds, .step, .stp, .iges, .igs, .brep, .vdb (or these and .gz or .zst) or .json, or --format");
  const bool volume =
      io::volume_format_of(request.output).has_value() || io::structured_format_of(request.output).has_value();
  // A .vtu is a mesh of cells with --layers, and one of faces without.
  require(!request.fill || io::volume_format_of(request.output),
          request.output + ": expected .vtu, .msh, .cgns, .su2 or a folder named polyMesh with --fill");
  require(!request.fill || request.fill->farfield_file.empty() || format_of(request.fill->farfield_file, request),
          fmt::format("--farfield: expected 'sphere:20L', 'box:10L' or a mesh that ends in {}, got '{}'", kMeshEndings,
                      request.fill ? request.fill->farfield_file : ""));
  require(!volume || request.layers || format_of(request.output, request),
          request.output + ": not a mesh format. Use .obj, .ply, .stl ..., or --layers for cells");
  require_structured(request);
  require_with_files(request);
  const bool is_vdb = is_level_set_output(request.output, request);
  require(!is_vdb || io::format_of(request.output + ".gz") == io::Format::Vdb,
          request.output + ": expected .vdb alone, as OpenVDB packs its grids itself");
  require(!is_vdb || (request.iso && !request.shell),
          request.output + ": expected --mode iso, without --shell, as a level set is written of that surface alone");
  require(volume || format_of(request.output, request).has_value(),
          fmt::format("{}: expected an output that ends in {}, or --format", request.output, kMeshEndings));
}

void require_case(const Request& request) {
  const std::string& folder = request.solver_case.folder;
  if (folder.empty()) return;
  if (request.solver_case.of_su2) {
    const auto beside = std::filesystem::path(request.output).lexically_normal().parent_path(),
               wanted = (std::filesystem::path(folder) / "").lexically_normal().parent_path();
    require(
        io::volume_format_of(request.output) == io::VolumeFormat::Su2 && beside == wanted,
        fmt::format("{}: expected a .su2 file in {} as the OUTPUT of --case su2:{}", request.output, folder, folder));
    return;
  }
  const auto mesh = std::filesystem::path(request.output).lexically_normal(),
             expected = (std::filesystem::path(folder) / "constant" / "polyMesh").lexically_normal();
  require(mesh == expected || mesh == expected / "", fmt::format("{}: expected {} as the OUTPUT of --case openfoam:{}",
                                                                 request.output, expected.string(), folder));
}

void require_endings(const Request& request) {
  require_case(request);
  require(request.patches.empty() || io::volume_format_of(request.output),
          request.output + ": expected .vtu, .msh, .cgns, .su2 or a folder named polyMesh with --patch");
  require_states_file(request);
  require(request.paths.empty() || io::is_lines_file(request.paths) ||
              (io::curve_format_of(request.paths) && io::curve_format_of(request.paths) != io::CurveFormat::Svg &&
               io::curve_format_of(request.paths) != io::CurveFormat::Dxf),
          request.paths + ": expected a file of paths that ends in .obj, .txt or .vtp");
  require_page(request);
  require(request.vdb != "-", "--save-vdb: expected a file, got '-'");
  for (const std::string& path : request.obstacles)
    require(format_of(path, request).has_value(),
            fmt::format("{}: expected an obstacle that ends in {}", path, kMeshEndings));
  require(request.fit.empty() || format_of(request.fit, request),
          fmt::format("{}: expected a mesh that ends in {}", request.fit, kMeshEndings));
}

/// Requires one distance, and names for files that can hold what is to be written.
void require_sound_tolerance(const Request& request) {
  if (!request.tolerance) return;
  require(request.distances.size() < 2,
          fmt::format("--distance: expected one with --tolerance, got {}", request.distances.size()));
  const std::string& refined = request.tolerance->refined_source;
  require(refined.empty() || format_of(refined, request),
          fmt::format("{}: expected a refined source that ends in {}", refined, kMeshEndings));
}

/// Rules for iso-surfaces: distances are the same for all vertices, and not 0.
void require_even(const Request& request) {
  if (!request.iso) return;
  for (const DistanceRequest& each : request.distances) {
    require(!each.distance.expression && each.from.empty(),
            fmt::format("--distance: expected a number with --mode iso, got '{}'", each.text));
    require(each.distance.value != 0, "--distance: expected one other than 0 with --mode iso");
  }
}

}  // namespace

void require_rules(const GivenNames& given, const std::vector<OptionRule>& rules) {
  const auto is_given = [&](const std::string& name) { return given.contains(name); };
  for (const auto& [options, relation, others] : rules)
    for (const std::string& option : options) {
      if (!is_given(option)) continue;
      const auto count = std::count_if(others.begin(), others.end(), is_given);
      if (relation == OptionRule::Relation::Excludes && count > 0)
        throw UsageError(
            fmt::format("{} and {} exclude each other", option, *std::find_if(others.begin(), others.end(), is_given)));
      require(relation != OptionRule::Relation::NeedsAnyOf || count > 0,
              fmt::format("{} needs {}", option, fmt::join(others, " or ")));
      require(relation != OptionRule::Relation::NeedsOneOf || count == 1,
              fmt::format("{} needs {} {}", option, count == 0 ? "one of" : "only one of", fmt::join(others, ", ")));
    }
}

void require_together(const GivenNames& given) {
  using enum OptionRule::Relation;
  const std::vector<OptionRule> rules = {
      {{"--adaptivity", "--inside", "--keep-specks", "--transport"}, NeedsAnyOf, {"--mode iso"}},
      {{"--only",         "--open",    "--border",  "--symmetry", "--obstacle",  "--distance-from", "--collision",
        "--taper",        "--corners", "--solver",  "--states",   "--paths",     "--html",          "--save-vdb",
        "--normals keep", "--layers",  "--heights", "--fit",      "--tolerance", "--distance-of",   "--blend"},
       Excludes,
       {"--mode iso"}},
      {{"--first-height", "--y-plus", "--total-thickness", "--last-height", "--growth", "--layers-of"},
       Excludes,
       {"--heights"}},
      {{"--first-height", "--y-plus", "--total-thickness", "--last-height", "--growth", "--layers-of"},
       NeedsAnyOf,
       {"--layers"}},
      {{"--y-plus"}, Excludes, {"--first-height"}},
      {{"--structured", "--fan-angle", "--periodic"}, NeedsAnyOf, {"--layers", "--heights"}},
      {{"--structured"}, Excludes, {"--fan-angle", "--fill"}},
      {{"--periodic"}, Excludes, {"--fan-angle", "--structured"}},
      {{"--fill", "--patch"}, NeedsAnyOf, {"--layers", "--heights"}},
      {{"--case"}, NeedsAnyOf, {"--fill"}},
      {{"--case", "--y-plus"}, NeedsOneOf, {"--viscosity", "--reynolds"}},
      {{"--speed", "--viscosity", "--reynolds", "--length"}, NeedsAnyOf, {"--case", "--y-plus"}},
      {{"--direction"}, NeedsAnyOf, {"--case"}},
      {{"--density"}, NeedsAnyOf, {"--viscosity"}},
      {{"--farfield", "--fill-with", "--caps", "--fill-growth", "--fill-max", "--fill-quads", "--fill-seconds",
        "--layers-anyway"},
       NeedsAnyOf,
       {"--fill"}},
      {{"--layers"}, NeedsAnyOf, {"--first-height", "--y-plus", "--total-thickness", "--last-height", "--heights"}},
      {{"--max-faces", "--refined-source", "--map", "--strict-certified"},
       NeedsAnyOf,
       {"--tolerance", "--corners arc"}},
      {{"--distance-xy", "--distance-z", "--distance-of", "--blend", "--fit", "--shell", "--layers", "--heights",
        "--paths", "--save-vdb", "--dry-run"},
       Excludes,
       {"--tolerance", "--corners arc"}},
      {{"--distance", "--distance-from", "--shell", "--save-vdb", "--distance-of"},
       Excludes,
       {"--layers", "--heights", "--distance-xy", "--distance-z", "--fit"}},
      {{"--blend"}, Excludes, {"--heights", "--distance-xy", "--distance-z", "--fit"}},
      {{"--distance-xy", "--distance-z", "--fit"}, Excludes, {"--layers", "--heights"}},
      {{"--distance-xy"}, NeedsAnyOf, {"--distance-z"}},
      {{"--distance-z"}, NeedsAnyOf, {"--distance-xy"}},
      {{"--obstacle"}, Excludes, {"--distance-xy", "--fit", "--collision cut"}},
      {{"--collision", "--taper", "--paths"}, Excludes, {"--layers", "--heights"}},
      {{"--collision", "--taper", "--corners", "--distance-xy"}, Excludes, {"--fit"}},
      {{"--fit"}, NeedsAnyOf, {"--clearance"}},
      {{"--clearance"}, NeedsAnyOf, {"--obstacle", "--fit"}},
      {{"--side-of"}, Excludes, {"--distance-xy", "--distance-z", "--fit", "--inner", "--mode iso"}},
      {{"--inner", "--open"}, NeedsAnyOf, {"--shell"}},
      {{"--distance-from"}, Excludes, {"--distance"}},
      {{"--voxel-size"}, Excludes, {"--voxels-per-distance"}},
      {{"--quiet"}, Excludes, {"--verbose"}},
  };
  require_rules(given, rules);
}

void require_states_file(const Request& request) {
  require(request.states.empty() || io::is_states_file(request.states),
          request.states + ": expected a file of states that ends in .csv, .ply or .vtp");
}

void require_page(const Request& request) {
  require(request.html.empty() || request.html == "-" || request.html.ends_with(".html"),
          request.html + ": expected a page that ends in .html");
  if (!request.html.empty()) io::require_pages(request.html);
}

void require_miters(const Request& request) {
  const bool are_mitered = request.corners ? request.corners == Corners::Miter : !request.layers;
  require(!request.miter_limit || are_mitered, "--miter-limit needs --corners miter");
}

void require_options_for(const Request& request, bool curves, const char* meshes) {
  if (const char* const of_curves = first_given(request, {"--close", "--flatten"}); of_curves && !curves)
    throw UsageError(fmt::format("{}: expected curves, as this is not for meshes", of_curves));
  if (const char* const of_cad = first_given(request, {"--deflection", "--bodies"}); of_cad && curves)
    throw UsageError(fmt::format("{}: expected a CAD model, as this is not for curves", of_cad));
  const char* of_meshes =
      first_given(request, {"--only", "--border", "--distance-of", "--symmetry", "--periodic", "--obstacle", "--shell",
                            "--open", "--mode iso", "--tolerance", "--corners arc", "--orient fix-direction-only",
                            "--orient fix-cavities", "--fit", "--taper", "--fill-with", "--fill-quads", "--caps"});
  if (request.weld_text != "auto" && request.weld_text != "exact") of_meshes = "--weld";
  if (of_meshes && curves)
    throw UsageError(fmt::format("{}: expected {}, as this is not for curves", of_meshes, meshes));
}

void require_sound(const Request& request) {
  require_miters(request);
  require_endings(request);
  require(request.layers || !request.distances.empty() || scene::is_scene(request.input),
          "missing --distance, as -d 0.2 (in the units of the file) or -d 1% (of the diagonal)");
  require(request.output != "-" || !request.layers, "OUTPUT: expected a file for layers, got '-'");
  require(request.output != "-" || request.distances.size() < 2, "OUTPUT: expected a file for each distance, got '-'");
  require_even(request);
  require_sound_tolerance(request);
  require((request.only.empty() && request.distances_of.empty()) || !scene::is_scene(request.input),
          "--only and --distance-of: expected a mesh, as a scene names its own part");
  require(request.fit.empty() || request.clearance.value > 0,
          fmt::format("--clearance: expected one above 0 with --fit, got '{}'", request.clearance_text));
}

void require_for_input(const Request& request, bool curves) {
  require_options_for(request, curves, "a mesh");
  if (curves) require_for_curves(request);
  else require_for_mesh(request);
}

std::optional<io::Format> format_of(const std::string& path, const Request& request) {
  const auto format = io::format_of(path);
  return format ? format : request.format;
}

bool is_level_set_output(const std::string& path, const Request& request) {
  return format_of(path, request) == io::Format::Vdb;
}

bool is_cad_output(const std::string& path, const Request& request) {
  const auto format = format_of(path, request);
  return format && io::is_cad_output(*format);
}

io::WriteOptions write_options(const Request& request, const std::string& path) {
  io::WriteOptions options = request.write;
  options.format = format_of(path, request);
  return options;
}

}  // namespace vdb_offset::tool
