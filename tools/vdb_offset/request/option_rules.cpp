// SPDX-License-Identifier: Apache-2.0
// Rules about which options of an offset, and which names of files, go together.
#include "request/option_rules.h"

#include <fmt/format.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "request/option_values.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/io/volume_file.h"

namespace vdb_offset::tool {
namespace {

using Names = std::initializer_list<const char*>;

/// Requires that none of `options` is given without the option that they need, which `by` names.
void require_with(const CommandLine& line, bool is_given, const char* by, Names options) {
  for (const char* const option : options)
    require(is_given || !line.has(option), fmt::format("{} needs {}", option, by));
}

/// Requires that none of `options` is given beside the option that excludes them, which `by` names.
void require_without(const CommandLine& line, bool is_given, const char* by, Names options) {
  for (const char* const option : options)
    require(!is_given || !line.has(option), fmt::format("{} and {} exclude each other", option, by));
}

void require_one(const CommandLine& line, const char* option, const char* other) {
  require(!line.has(option) || !line.has(other), fmt::format("{} and {} exclude each other", option, other));
}

/// Requires that nothing of this is given; `as` says in words what is expected instead.
void require_none(const char* as, std::initializer_list<std::pair<const char*, bool>> given) {
  for (const auto& [name, is_given] : given)
    require(!is_given, fmt::format("{}: expected {}, as this is not for {}", name, as,
                                   std::string(as) == "a mesh" ? "curves" : "meshes"));
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
  const bool cells =
      volume == io::VolumeFormat::Vtu || volume == io::VolumeFormat::Su2 || io::structured_format_of(request.output);
  require(io::curve_format_of(request.output).has_value() || (request.layers && cells),
          request.output +
              ": expected an output that ends in .dat, .txt, .xy, .svg, .dxf or .obj, or with --layers in "
              ".vtu, .su2, .vts or .xyz, as the input holds curves");
  require_structured(request);
  require_none("a mesh", {{"--only", !request.only.empty()},
                          {"--border", request.border.has_value()},
                          {"--distance-of", !request.distances_of.empty()},
                          {"--symmetry", !request.symmetry_texts.empty()},
                          {"--obstacle", !request.obstacles.empty()},
                          {"--shell", request.shell},
                          {"--mode iso", request.iso.has_value()},
                          {"--tolerance", request.tolerance.has_value()},
                          {"--weld", request.weld_text != "auto" && request.weld_text != "exact"},
                          {"--orient", request.orient_text != "keep"},
                          {"--deflection", request.deflection.has_value()},
                          {"--fit", !request.fit.empty()}});
  require(!request.axes || request.write.digits == 0, "--precision and --distance-xy exclude each other for curves");
}

void require_for_mesh(const Request& request) {
  require_none("curves", {{"--close", request.close}, {"--flatten", request.flatten.has_value()}});
  require(
      scene::is_scene(request.input) || format_of(request.input, request),
      request.input +
          ": expected an input that ends in .obj, .ply, .stl, .off, .3mf, .glb, .gltf, .vtp, .vtk, .vtu, .fbx, .dae, "
          ".3ds, .step, .stp, .iges, .igs, .brep, .vdb (or these and .gz or .zst) or .json, or --format");
  const bool volume =
      io::volume_format_of(request.output).has_value() || io::structured_format_of(request.output).has_value();
  // A .vtu is a mesh of cells with --layers, and one of faces without.
  require(!volume || request.layers || format_of(request.output, request),
          request.output + ": not a mesh format. Use .obj, .ply, .stl ..., or --layers for cells");
  require_structured(request);
  const bool is_model = is_cad_output(request.output, request);
  require(is_model || (!request.faceted && request.fit_tolerance == 0),
          "--faceted and --fit-tolerance: expected an output that ends in .step, .stp or .brep");
  require(!is_model || !request.shell || (request.distances_of.empty() && request.only.empty() && !request.faceted),
          request.output + ": --shell excludes --distance-of, --only and --faceted for a CAD model");
  require(!is_model || !(request.inner || request.layers || request.iso || request.tolerance || request.axes ||
                         !request.fit.empty() || !request.symmetry_texts.empty() || request.miter_limit),
          request.output +
              ": expected a mesh, as a CAD model has no place for --inner, --layers, --mode iso, "
              "--tolerance, --distance-xy, --fit, --symmetry and --miter-limit");
  require(is_model || !request.cuts, "--collision cut: expected an output that ends in .step, .stp or .brep");
  require(!is_model || request.collision != Collision::Merge,
          request.output + ": expected --collision limit or cut for a CAD model, got merge");
  require(!request.cuts || request.obstacles.empty(), "--collision cut excludes --obstacle");
  const bool is_vdb = is_level_set_output(request.output, request);
  require(!is_vdb || io::format_of(request.output + ".gz") == io::Format::Vdb,
          request.output + ": expected .vdb alone, as OpenVDB packs its grids itself");
  require(!is_vdb || (request.iso && !request.shell),
          request.output + ": expected --mode iso, without --shell, as a level set is written of that surface alone");
  const auto is_from_vdb = [&](const std::string& path) { return format_of(path, request) == io::Format::Vdb; };
  require(is_from_vdb(request.input) || is_from_vdb(request.fit) ||
              std::ranges::any_of(request.obstacles, is_from_vdb) ||
              (request.level_set.grid.empty() && !request.level_set.isovalue),
          "--grid and --isovalue: expected an input, an obstacle or a --fit that ends in .vdb");
  require(volume || format_of(request.output, request).has_value(),
          fmt::format("{}: expected an output that ends in {}, or --format", request.output, kMeshEndings));
}

void require_endings(const Request& request) {
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

/// Rules for --tolerance: one offset of a mesh, in which each vertex of the source is one of the result.
void require_together_with_tolerance(const CommandLine& line, bool is_iso) {
  const bool is_given = line.has("--tolerance");
  require_with(line, is_given, "--tolerance", {"--max-faces", "--refined-source", "--map", "--strict-certified"});
  require(!is_given || !is_iso, "--tolerance and --mode iso exclude each other");
  require_without(line, is_given, "--tolerance",
                  {"--distance-xy", "--distance-z", "--distance-of", "--blend", "--fit", "--shell", "--layers",
                   "--heights", "--paths", "--save-vdb", "--dry-run"});
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

void require_together(const CommandLine& line, bool is_iso) {
  const bool layers = line.has("--layers") || line.has("--heights"), fit = line.has("--fit"),
             axes = line.has("--distance-xy") || line.has("--distance-z");
  require_with(line, is_iso, "--mode iso", {"--adaptivity", "--inside", "--keep-specks", "--transport"});
  if (is_iso) require(!layers, "--layers and --mode iso exclude each other");
  require_without(line, is_iso, "--mode iso",
                  {"--only", "--border", "--symmetry", "--obstacle", "--distance-from", "--collision", "--corners",
                   "--solver", "--states", "--paths", "--html", "--save-vdb"});
  require_with(line, layers, "--layers", {"--first-height", "--total-thickness", "--growth", "--structured"});
  if (layers) {
    require(line.has("--heights") + line.has("--first-height") + line.has("--total-thickness") == 1,
            "--layers needs one of --first-height, --total-thickness and --heights");
    require(!line.has("--heights") || !line.has("--growth"), "--growth needs --first-height or --total-thickness");
  }
  require_without(line, layers, "--layers",
                  {"--distance", "--distance-from", "--shell", "--collision", "--paths", "--save-vdb"});
  const auto instead_of_distance = [&](bool is_given, const char* by) {
    require_without(line, is_given, by, {"--distance", "--distance-from"});
    require(!is_given || !layers, fmt::format("--layers and {} exclude each other", by));
    require_without(line, is_given, by, {"--shell", "--obstacle", "--save-vdb"});
  };
  require_without(line, is_iso || layers || axes || fit, "--mode iso, --layers, --distance-xy or --fit",
                  {"--distance-of", "--blend"});
  instead_of_distance(axes, "--distance-xy");
  require_without(line, axes, "--distance-xy", {"--fit"});
  instead_of_distance(fit, "--fit");
  require(!fit || !is_iso, "--mode iso and --fit exclude each other");
  require_without(line, fit, "--fit", {"--collision", "--corners"});
  require_with(line, line.has("--clearance"), "--clearance", {"--fit"});
  require_with(line, fit || line.has("--obstacle"), "--obstacle or --fit", {"--clearance"});
  require_with(line, line.has("--shell"), "--shell", {"--inner"});
  require_together_with_tolerance(line, is_iso);
  require_one(line, "--distance-from", "--distance");
  require_one(line, "--voxel-size", "--voxels-per-distance");
  require_one(line, "--quiet", "--verbose");
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
  const bool are_round = request.corners ? request.corners == Corners::Round : request.layers.has_value();
  require(!request.miter_limit || !are_round, "--miter-limit needs --corners miter");
}

void require_sound(const Request& request) {
  require_miters(request);
  require(!request.iso || request.write.normals == io::Normals::Recompute,
          "--normals keep and --mode iso exclude each other");
  require_endings(request);
  require(request.layers || !request.distances.empty() || scene::is_scene(request.input),
          "--distance: expected a distance (a scene alone brings its own)");
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
