// SPDX-License-Identifier: Apache-2.0
// What --help says around the options, and the topics it lists them by.
#include "request/help.h"

namespace vdb_offset::tool {

const char* const kAbout =
    "Offsets a mesh by a distance and keeps its topology: the same vertices in the same order, the same faces,\n"
    "texture coordinates, groups and materials; only positions (and normals) change.";

const char* const kMore = R"(
INPUT and OUTPUT end in .obj, .ply, .stl, .off, .3mf, .glb, .gltf, .vtp, .vtk or .vtu, also with .gz or .zst behind it,
or are '-' (standard input and output, with --format). INPUT may also be .fbx, .dae or .3ds; a CAD model (.step .stp
.iges .igs .brep), whose offset may be one again (.step .stp .brep); a level set (.vdb, with --mode iso OUTPUT as well);
or a scene (.json), which has its own distance. If both have the same format, only coordinates and normals of what moved
change. Plane curves are .dat, .txt, .xy, .svg or .dxf files, or an .obj with line elements and no face.
D is in the file's own units, or a percentage of the diagonal of the bounding box of the vertices in use; below zero it
is inward. Write --distance=-1% or --distance -1%. Or it is an expression, evaluated for each vertex, in x y z (place),
nx ny nz (normal) and u v (texture coordinates), with numbers, pi, e, + - * / ^, ?: and functions (sin, sqrt, min ...);
a % behind it makes it percent. Several distances give several outputs: NAME_001.obj, NAME_002.obj ..., or OUTPUT has
{i} (their number) or {d} (the distance as given).

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
  vdb_offset body.stl case/constant/polyMesh --first-height 0.1% --last-height edge --fill     all cells, out to 20 lengths
  vdb_offset part.stl out.stl --distance-xy -0.1 --distance-z -0.05      less across than up
  vdb_offset peg.stl out.stl --fit socket.stl --clearance 0.1           makes room where there is less
  vdb_offset part.obj out.obj --distance 1% --tolerance 2%     faces at the distance, too, to 2 % of it
  vdb_offset scan.obj clean.obj --distance 1% --mode iso       a new, clean surface, with textures
  vdb_offset scenes/torus.json torus.obj                a procedural scene
  vdb_offset check bunny.obj bigger.obj                 measure an offset (vdb_offset check --help)
  vdb_offset view bunny.obj bigger.obj                  look at it in a browser (vdb_offset view --help)
  vdb_offset batch models bigger --distance 1%          a folder of models (vdb_offset batch --help)

Exit codes: 0 done, 1 usage, 2 input, 3 processing (or --strict and a vertex short, or a scene's expectation not
met, or more than --max-faces needed), 4 output. Ctrl-C and similar signals end the run at once, and every output stays
as it was before.
Report keys, library and guarantees: see the guides in docs/.)";

const char* const kMoreOfFirst = R"(
INPUT is a mesh (.obj .ply .stl .off .3mf .glb .gltf .vtp .vtk .vtu .fbx .dae .3ds), a CAD model (.step .iges .brep), a
level set (.vdb), curves (.svg .dxf .dat .txt .xy), or a scene (.json). D is in the file's units, or a percentage of the
bounding box's diagonal; below zero it is inward: --distance=-1%.

Examples:
  vdb_offset bunny.obj bigger.obj --distance 1%          enlarge by 1 % of the diagonal
  vdb_offset part.stl bigger.stl -d 0.2 --preset part    enlarge a printed part by 0.2 units, certified
  vdb_offset vase.stl shell.stl -d -2 --shell            a closed solid, 2 units thick
  vdb_offset scan.obj clean.obj -d 1% --mode iso         a new, clean surface
  vdb_offset check bunny.obj bigger.obj                  measure an offset (vdb_offset check --help)
  vdb_offset view bunny.obj bigger.obj                   look at it (vdb_offset view --help)
  vdb_offset batch models bigger -d 1%                   a folder of models (vdb_offset batch --help))";

std::span<const HelpTopic> help_topics() {
  static const HelpTopic kTopics[] = {
      {"distances",
       "Distances and corners",
       {"distance", "side-of", "unit", "distance-from", "distance-of", "blend", "distance-xy", "distance-z", "fit",
        "clearance", "corners", "miter-limit", "collision", "taper"}},
      {"accuracy",
       "Accuracy and when to fail",
       {"tolerance", "max-faces", "refined-source", "map", "strict", "strict-faces", "strict-certified"}},
      {"parts", "Parts and surroundings", {"only", "border", "symmetry", "obstacle", "weld", "orient"}},
      {"solids",
       "Solids and iso-surfaces",
       {"shell", "open", "inner", "mode", "adaptivity", "inside", "keep-specks", "transport"}},
      {"layers",
       "Layers of cells",
       {"layers",  "first-height", "total-thickness", "last-height", "growth",       "y-plus",    "layers-of",
        "heights", "fan-angle",    "periodic",        "structured",  "fill",         "fill-with", "farfield",
        "caps",    "fill-growth",  "fill-max",        "fill-quads",  "fill-seconds", "patch",     "case",
        "speed",   "direction",    "layers-anyway",   "viscosity",   "density",      "reynolds",  "length"}},
      {"inputs",
       "Curves, CAD models and level sets",
       {"close", "flatten", "deflection", "angle", "bodies", "cad-seconds", "fit-tolerance", "exact", "grid",
        "isovalue"}},
      {"outputs",
       "Files that are written",
       {"format", "normals", "precision", "report", "states", "paths", "html", "save-vdb", "no-sync", "json"}},
      {"run",
       "The run",
       {"preset", "config", "threads", "max-memory", "voxel-size", "voxels-per-distance", "solver", "dry-run", "quiet",
        "verbose", "help", "version"}}};
  return kTopics;
}

}  // namespace vdb_offset::tool
