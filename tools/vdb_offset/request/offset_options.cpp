// SPDX-License-Identifier: Apache-2.0
// The options of an offset: their texts in --help, and what each of them sets.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>

#include "page/run_pages.h"
#include "request/command_line.h"
#include "request/help.h"
#include "request/offset_options.h"
#include "request/option_rules.h"
#include "request/option_values.h"
#include "request/request.h"
#include "vdb_offset/api.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr double kAny = std::numeric_limits<double>::max();
// Numbers above this are 0 or more.
constexpr double kBelowZero = -std::numeric_limits<double>::denorm_min();

/// Declares the options that say how far the offset goes, and what kind of offset it is.
void declare_distances(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  line.add_unit(request.unit, request.input, request.lengths);
  line.repeated(
      "-d,--distance", "D",
      "Distance: world units, percent of the diagonal as in 1.5%, or an expression; negative is inward; given "
      "several times: one output each",
      [&request](const std::string& text) {
        request.distances.push_back(parse_distance_of("--distance", text, request));
      });
  line.option(
      "--side-of", "X,Y,Z",
      "Go to the side of INPUT that this point is on, in place of signs: inside of a closed surface, for one in it",
      [&request](const std::string& text) { request.side_of = parse_vector("--side-of", text); });
  declare_part_distances(line, request);
  line.option("--mode", "MODE",
              "'topology' moves the mesh's own vertices; 'iso' captures the surface at the distance as a new mesh, "
              "closed and manifold, for which INPUT may be anything [topology]",
              [](const std::string& text) {
                parse_word("--mode", text, {"topology", "iso"});
              });
  line.option(
      "--corners", "KIND",
      "At sharp corners, 'miter' puts faces at the distance (vertices on sharp edges are farther), 'round' puts "
      "vertices at the distance (faces at sharp edges are nearer), 'arc' adds faces over sharp edges, round to within "
      "--tolerance [miter; with --layers round]",
      request.corners, parse_corners);
  line.option("--miter-limit", "L", "A vertex on a sharp edge goes no farther than this many distances, at least 1 [4]",
              request.miter_limit, parse_miter_limit);
  line.option(
      "--adaptivity", "X",
      "With --mode iso: how readily cells are merged where the surface is nearly flat, 0 (none) to 1 [only where that "
      "changes nothing: in flat parts, if no attribute is transported]",
      draft.iso.adaptivity, number_between("--adaptivity", "a number from 0 to 1", kBelowZero, 1));
  line.option(
      "--inside", "MODE",
      "With --mode iso, of meshes with small holes or edges of four and more faces: 'winding' finds their inside, "
      "'never' treats them as open, with a surface on all sides [winding]",
      draft.iso.use_winding, [](const std::string& text) {
        return parse_word("--inside", text, {"winding", "never"}) == 0;
      });
  line.flag("--keep-specks",
            "With --mode iso: keep pieces that enclose less than a voxel, such as remains of knife edges",
            draft.iso.keep_specks);
  line.option("--transport", "LIST",
              "With --mode iso: attributes to transport from INPUT: 'uv', 'color', 'material', separated by commas, or "
              "'none' [all that INPUT has and OUTPUT can hold]",
              draft.iso.transport, parse_transport, draft.iso.transport_text);
  line.option("--distance-from", "FILE",
              "Each vertex's distance, world units: a file of numbers (text or .npy), 'ply:NAME', a vertex "
              "property of INPUT, or 'vtk:NAME', a point array of INPUT; other options take these as '@FILE', "
              "'ply:NAME' and 'vtk:NAME'",
              [&request](const std::string& text) {
                request.distances.push_back(parse_distance_from(text, request));
                request.distance_option = "--distance-from";
              });
  line.option("--distance-xy", "A",
              "Instead of --distance, with --distance-z: how far within the plane of x and y, world units or percent",
              draft.distance_xy);
  line.option("--distance-z", "B", "With --distance-xy, of its sign: how far along z; 0 is a thousandth of A",
              draft.distance_z);
}

/// Declares the options for a distance that holds at every point.
void declare_tolerance(CommandLine& line, Draft& draft) {
  ToleranceRequest& request = draft.tolerance;
  line.option(
      "--tolerance", "T",
      "Split faces until every point of them is proven to be within T of the distance, wherever vertices reach "
      "it: world units, or percent of the distance; vertices of INPUT come first, and the pieces of a face "
      "take its place. With --corners arc, faces over sharp edges are within T as well; without --tolerance, these are "
      "within 1%, and no faces are split",
      request.tolerance, parse_tolerance, request.text);
  line.option(
      "--max-faces", "N",
      "With --tolerance or --corners arc: make no more faces than this [20 times as many as INPUT has, at least a "
      "million]",
      request.tolerance.most_faces, count_between("--max-faces", 1, std::numeric_limits<int>::max()));
  line.option("--refined-source", "FILE",
              "With --tolerance or --corners arc: write INPUT with the faces that OUTPUT has", request.refined_source);
  line.option("--map", "FILE",
              "With --tolerance or --corners arc: write where in INPUT each added vertex lies, as text", request.map);
}

/// Declares the options that say which faces move, and what is around them.
void declare_parts(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  line.repeated(
      "--only", "PART",
      "Offset only this part; the rest stays, as an obstacle: 'group=NAME', 'material=NAME', "
      "'faces=FILE' (indices from 0, or a 0 or 1 for each face), 'holes' (round ones; 'holes<8' or 'holes>8' "
      "by diameter), 'concave', 'convex', 'up', 'down', 'planar:AXIS' (the flat end, as planar:+z), or of a CAD model "
      "'face=N' (from 1), 'name=NAME' or 'color=RRGGBB'; 'not:PART' is all but that; may be repeated",
      [&request](const std::string& text) {
        request.only_texts.push_back(text);
        request.only.push_back(parse_part("--only", text));
      });
  line.option("--border", "MODE",
              "The edge of that part: 'slide' along the surface that stays, 'fixed' or 'free' [slide]", request.border,
              parse_border);
  line.repeated("--symmetry", "PLANE",
                "Keep what lies on this plane in it: 'x=0', 'y=1.5', 'z=-2', or 'A,B,C,D' for A x + B y + C z = D; may "
                "be repeated; 'none' also switches off the automatic planes of borders",
                [&request](const std::string& text) { take_plane(text, request); });
  line.repeated("--obstacle", "FILE",
                "A mesh that the offset must not touch; distances are not measured from it; may be repeated",
                [&request](const std::string& text) { request.obstacles.push_back(text); });
  line.option("--clearance", "C",
              "Come no nearer to obstacles than this: world units, or percent of INPUT's diagonal [0]",
              request.clearance, parse_clearance, request.clearance_text);
  line.option("--fit", "FILE",
              "Instead of --distance, with --clearance: what is nearer to this mesh moves inward until it is that far "
              "away; all else stays",
              request.fit);
}

/// Declares the options that say what is made of the offset.
void declare_products(CommandLine& line, Request& request) {
  line.flag("--shell",
            "Write the source and its offset as one closed solid, joined by a rim where the surface is open; with "
            "--mode iso: a hollow solid, the source's own faces and one clean cavity, or skin",
            request.shell);
  line.repeated("--open", "PART",
                "With --shell: no wall over this part, the rim lies in its surface: 'group=NAME', 'material=NAME', "
                "'faces=FILE', 'holes', 'concave', 'convex', 'up', 'down', 'planar:AXIS' (as planar:+z), or of a CAD "
                "model 'face=N', 'name=NAME' or 'color=RRGGBB'; 'not:PART' is all but that; may be repeated",
                [&request](const std::string& text) {
                  const bool is_negated = text.starts_with("not:");
                  request.only_texts.push_back(is_negated ? text.substr(4) : "not:" + text);
                  request.only.push_back(parse_part("--open", text));
                  request.only.back().is_negated = !is_negated;
                });
  line.option("--inner", "E",
              "With --shell: put the inner skin this far inward, not on the source; with --mode iso both skins are new",
              [&request](const std::string& text) { request.inner = parse_inner(text, request); });
  line.flag("--close", "Curves: join ends that nearly meet, as at a blunt trailing edge", request.close);
  line.option(
      "--flatten", "TOL",
      "SVG and DXF: replace curved segments by straight ones at most this far off: world units, or percent of the "
      "drawing's diagonal [0.001%]",
      request.flatten, parse_flatten);
}

}  // namespace

void take_plane(const std::string& text, Request& request) {
  request.symmetry_texts.push_back(text);
  if (text == "none") request.symmetry.find = false;
  else request.symmetry.planes.push_back(parse_plane(text));
}

void declare_part_distances(CommandLine& line, Request& request) {
  line.repeated(
      "--distance-of", "PART:D",
      "A different distance for one part: PART as for --only, as in face=3:0.4; may be repeated, the last for a "
      "face counts",
      [&request](const std::string& text) {
        request.distance_of_texts.push_back(text);
        request.distances_of.push_back(parse_distance_of_part("--distance-of", text, request));
      });
  line.option(
      "--blend", "L",
      "With --distance-of, or distances in u and v on a CAD model: blend the distances of parts over this length "
      "on both sides of their edges: world units, or percent of the diagonal [off]",
      request.blend, parse_blend, request.blend_text);
}

void complete_part_distances(Request& request) {
  if (request.distances.empty() && !request.distances_of.empty() && !request.layers)
    request.distances.push_back({"0", {}, {}});
}

void declare_level_set(CommandLine& line, Request& request) {
  line.option("--grid", "NAME", ".vdb files: the grid whose surface is the mesh [the only level set]",
              request.level_set.grid);
  line.option("--isovalue", "V", ".vdb files: the value on that surface; needed if the grid is not a level set [0]",
              request.level_set.isovalue, number_between("--isovalue", "a number", -kAny, kAny));
}

void declare_cad(CommandLine& line, Request& request) {
  line.option(
      "--deflection", "TOL",
      "CAD models: triangles are at most this far from the model's face: world units, or percent of the diagonal [a "
      "hundredth of the distance; a twentieth for a CAD model as OUTPUT]",
      request.deflection, parse_deflection);
  line.option("--angle", "A",
              "CAD models: most degrees between a face's normals at neighbouring vertices, up to 90 [15]",
              request.angle, number_between("--angle", "a number above 0, up to 90", 0, 90));
  line.option("--bodies", "HOW",
              "CAD models: offset solids that touch 'each' by itself, or 'fuse' them to one before [each]",
              [&request](const std::string& text) {
                request.fuses_bodies = parse_word("--bodies", text, {"each", "fuse"}) == 1;
              });
  line.option("--cad-seconds", "S",
              "CAD models: how long OpenCASCADE may take for one model in all [300; in a batch 60]",
              request.cad_seconds, number_between("--cad-seconds", "a number above 0", 0, kAny));
}

namespace {

/// Declares the options that say how CAD models are written.
void declare_cad_output(CommandLine& line, Request& request) {
  line.option(
      "--fit-tolerance", "TOL",
      "With an OUTPUT that is a CAD model (.step .stp .brep): how far fitted faces may be from the offset, world "
      "units [a ten-thousandth of the distance]",
      request.fit_tolerance, number_between("--fit-tolerance", "a number above 0", 0, kAny));
  line.flag("--exact",
            "With an OUTPUT that is a CAD model: write none if faces of it would be triangles, where exact ones fail",
            request.exact);
}

/// Declares the options that say how the offset is computed.
void declare_method(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  line.option("--voxel-size", "H", "Voxel size of the direction field, world units [automatic: about D]",
              request.grid.voxel_size, number_between("--voxel-size", "a number above 0", 0, kAny));
  line.option("--voxels-per-distance", "N", "Voxel size of the direction field as D / N",
              request.grid.voxels_per_distance, number_between("--voxels-per-distance", "a number above 0", 0, kAny));
  line.option(
      "--collision", "MODE",
      "Where faces would fold or cross: 'limit' holds vertices back to prevent it, 'merge' lets them go as far as "
      "the distance grows; for a CAD model as OUTPUT, 'limit' holds faces back where fronts meet, and 'cut' cuts "
      "them where they cross [limit; for a CAD model cut, or limit with --obstacle]",
      [&request](const std::string& text) {
        const std::size_t word = parse_word("--collision", text, {"limit", "merge", "cut"});
        request.cuts = word == 2;
        request.collision.reset();
        if (!request.cuts) request.collision = word == 1 ? Collision::Merge : Collision::Limit;
      });
  line.option("--taper", "S",
              "What falls short fades into its surroundings: along the surface, thickness rises from there by no more "
              "than S times the way; 0: it may rise at once [1]",
              request.taper, parse_taper);
  line.option("--solver", "NAME", "How the field is extended: 'closest' (exact) or 'eikonal' (first order) [closest]",
              request.solver, [](const std::string& text) {
                return parse_word("--solver", text, {"closest", "eikonal"}) == 1 ? Solver::Eikonal : Solver::Closest;
              });
  line.option(
      "--weld", "MODE",
      "Vertices that move as one: 'auto' (equal positions, and borders that are one but for the file's rounding), "
      "'exact' (equal positions), 'none', or within TOL world units [auto]",
      request.weld, parse_weld, request.weld_text);
  line.option(
      "--orient", "MODE",
      "Outward is where the faces point ('keep'), or out of what a closed piece encloses even if it is inside "
      "out ('fix-direction-only'; the faces stay as they are), also if it is a cavity whose faces point outward "
      "('fix-cavities') [keep]",
      request.orient, parse_orient, request.orient_text);
}

/// Declares the options for the files that are written, and for threads and memory.
void declare_files(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  line.option("--format", "NAME",
              "Format of '-' and of files with another ending: 'obj', 'ply', 'stl', 'off', "
              "'3mf', 'glb', 'gltf', 'vtp', 'vtk', 'vtu', 'step', 'iges' or 'brep'",
              request.format, parse_format);
  line.option(
      "--normals", "MODE", "Normals of the file where faces moved: 'recompute' or 'keep' them as they are [recompute]",
      request.write.normals, [](const std::string& text) {
        return parse_word("--normals", text, {"recompute", "keep"}) == 1 ? io::Normals::Keep : io::Normals::Recompute;
      });
  line.option("--precision", "N",
              "Significant digits of moved coordinates in text, 1 to 17 [as many as read back to the same number]",
              request.write.digits, count_between("--precision", 1, kMostDigits));
  line.option("--threads", "N", "Threads; 0 takes all; the result is the same for any number [0]", request.threads,
              count_between("--threads", 0, kMostThreads));
  line.option("--max-memory", "SIZE", "Refuse work that would need more, as in 4G [80 % of what is free]",
              request.max_memory, parse_size);
  line.option("--report", "FILE", "Write what happened as JSON", request.report);
  line.option(
      "--states", "FILE",
      "Write state, target and achieved distance of every vertex: .csv, or .vtp or .ply to colour by in a viewer",
      request.states);
  line.option("--paths", "FILE", "Write the path of every vertex as a line: .vtp, .obj (or .txt)", request.paths);
  line.option("--html", "FILE", "Write one page (.html) that shows source and result in a browser, without a network",
              request.html);
  line.option("--save-vdb", "FILE", "Write phi and the closest triangles as OpenVDB grids", request.vdb);
}

/// Declares the options for the run as a whole.
void declare_run(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  line.flag("--no-sync", "Skip fsync before renaming outputs", draft.no_sync);
  line.flag("--strict",
            "Exit with 3 if a vertex in use falls short of its distance, a cell of layers is not valid, an obstacle or "
            "the mesh to fit is nearer than asked, or not all of the area is proven to be within --tolerance",
            request.strict);
  line.option("--strict-faces", "P",
              "Exit with 3 unless 99 % of the faces' area is within P percent of the distance; of layers, at the first "
              "height and outermost",
              request.strict_faces, parse_strict_faces);
  line.option("--strict-certified", "P",
              "With --tolerance: exit with 3 unless P percent of the area is certified to be within it",
              request.strict_certified, parse_strict_certified);
  line.flag("--dry-run", "Read the input, print what would be done, write nothing", request.dry_run);
  line.flag("-q,--quiet", "Print nothing but errors", request.quiet);
  line.flag("-v,--verbose", "Print the mesh's facts and the seconds of each stage", request.verbose);
}

/// \throw UsageError where the first word is no file, and nearly the name of a command
void require_no_command(int argc, const char* const* argv) {
  std::error_code unknown;
  if (argc < 2 || std::filesystem::exists(argv[1], unknown)) return;
  for (const char* const command : {"check", "view", "batch"})
    require(edits_between(argv[1], command) > kMostEdits,
            fmt::format("{}: no such file; did you mean vdb_offset {}?", argv[1], command));
}

/// Completes the request by what several options say together.
void complete(Draft& draft) {
  Request& request = draft.request;
  const auto has = [&](const char* option) { return request.given.contains(option); };
  if (has("--mode iso")) request.iso = draft.iso;
  if (has("--tolerance")) request.tolerance = draft.tolerance;
  if (request.corners == Corners::Arc && !request.tolerance) {
    request.tolerance = draft.tolerance;
    request.tolerance->text = "1%";
    request.tolerance->tolerance.share = parse_tolerance(request.tolerance->text).share;
    request.tolerance->tolerance.ridges_only = true;
  }
  complete_layers(draft);
  if (draft.fills) request.fill = draft.fill;
  if (draft.no_sync) request.sync = OutputFiles::Sync::No;
  constexpr std::size_t kParts = 5, kPartsTaken = 4;  // four fifths of the free memory, as --help says
  if (request.max_memory == 0) request.max_memory = std::max<std::size_t>(1, available_memory() / kParts * kPartsTaken);
  request.axes = parse_axes(draft.distance_xy, draft.distance_z);
  if (request.axes)
    request.distances.push_back({draft.distance_xy + " xy " + draft.distance_z + " z", request.axes->xy, {}});
  if (!request.fit.empty()) request.distances.push_back({"fit", {}, {}});
  complete_part_distances(request);
}

}  // namespace

std::vector<std::vector<std::string>> alternative_options() {
  return {{"distance", "distance-from", "distance-xy", "distance-z", "fit"},
          {"first-height", "y-plus", "total-thickness", "last-height", "heights"},
          {"layers", "heights"},
          {"growth", "heights"}};
}

void declare_offset_options(CommandLine& line, Draft& draft) {
  declare_distances(line, draft);
  declare_tolerance(line, draft);
  declare_parts(line, draft);
  declare_level_set(line, draft.request);
  declare_cad(line, draft.request);
  declare_cad_output(line, draft.request);
  declare_products(line, draft.request);
  declare_layers(line, draft);
  declare_fill(line, draft);
  declare_case(line, draft);
  declare_method(line, draft);
  declare_files(line, draft);
  declare_run(line, draft);
}

std::optional<Request> parse_command_line(int argc, const char* const* argv) {
  Draft draft;
  CommandLine line("vdb_offset", kAbout, kMore, "vdb_offset --help all");
  line.add_version(std::string("vdb_offset ") + version());
  line.file("INPUT", "Mesh to offset (.obj .ply .stl .off, also .gz .zst; '-'), curves (see below), or a scene (.json)",
            draft.request.input);
  line.file("OUTPUT", "Mesh to write, by extension; may be the input; '-' is standard output", draft.request.output);
  line.add_config(alternative_options(), {"output", "models", "jobs", "reports", "retry-failed", "slurm"},
                  {"sshlogin"});
  declare_offset_options(line, draft);
  line.arrange_help(help_topics(), {"distance", "preset", "corners", "tolerance", "only", "shell", "mode", "layers"},
                    kMoreOfFirst);
  require_no_command(argc, argv);
  if (!line.parse(argc, argv)) return std::nullopt;
  draft.request.given = line.given();
  draft.request.of_preset = line.of_preset();
  draft.request.command = as_typed(argc, argv);
  draft.request.config = line.config();
  explaining_presets(line.of_preset(), [&] {
    settle_given_layers(draft);
    require_together(draft.request.given);
    complete(draft);
    require_sound(draft.request);
  });
  return draft.request;
}

}  // namespace vdb_offset::tool
