// The options of an offset, and the words of --help.
#include "declare_options.h"

#include <CLI/CLI.hpp>

#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {

const char* const kAbout =
    "Offsets a mesh by a distance and keeps its topology: the same vertices in the same order, the same faces,\n"
    "texture coordinates, groups and materials; only positions (and normals) change.";

const char* const kMore = R"(
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

}  // namespace vdb_offset::tool
