// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// How far a field reaches on each side of the surface, world units, both > 0.
struct Reach {
  double inside, outside;
};

/// How fine the grid is. At most one of the two may be set; with neither the size is chosen (see plan_grid).
struct GridOptions {
  std::optional<double> voxel_size;           ///< World units, > 0.
  std::optional<double> voxels_per_distance;  ///< > 0; the voxel size is |distance| / this.
};

/// What a run will need, known before it starts.
struct GridPlan {
  double voxel_size = 0;                              ///< World units.
  std::string reason;                                 ///< Why this size, in words.
  double band = 0;                                    ///< Width on each side that is rasterised exactly.
  Reach reach{};                                      ///< Width on each side that the field covers.
  std::size_t leaf_nodes = 0, voxels = 0, bytes = 0;  ///< Estimates; bytes is the peak of the whole run.
  double seconds = 0;                                 ///< Rough estimate for `threads` threads.
};

enum class Solver {
  Closest,  ///< Hands closest points on from voxel to voxel, each walking on from there over the mesh: exact.
  Eikonal,  ///< Godunov's update of |grad phi| = 1 on phi alone: first order, the paper's method.
};

/// What the edge of a part does where the rest of the mesh goes on.
enum class Border {
  Slide,  ///< It slides along the rest of the surface, or along that surface's extension.
  Fixed,  ///< It stays where it is.
  Free,   ///< It moves as if the rest of the mesh were not there.
};

/// What happens where fronts meet.
enum class Collision {
  Limit,  ///< The result stays valid: vertices are held back where faces would fold or cross.
  Merge,  ///< The paper's weak solution: every vertex goes as far as phi allows; faces there may fold or collapse.
};

/// What becomes of sharp corners on the side where the offset of a corner is round: the vertex cannot be at the
/// distance, and have its faces at the distance, too.
enum class Corners {
  Round,  ///< Every vertex is at the distance (phi = d, as in the paper). Faces beside it are nearer, unless all of
          ///< them can be at the distance as well, as inward at a convex edge.
  Miter,  ///< A vertex on a crease goes to where the planes around it meet that are moved by the distance.
  Arc,    ///< Faces are at the distance, and more of them are added over sharp edges: see offset_to_tolerance().
};

struct VDB_OFFSET_API OffsetOptions {
  /// World units, one for all or one for each vertex of the input; negative is inward, 0 leaves a vertex where it is.
  /// Vertices welded together use the mean of their distances.
  Distances distance;
  GridOptions grid;
  /// One number a face: 1 for faces that are offset; the others stay, and are in the way. Distances are measured from
  /// the part. Empty: all faces are offset.
  std::vector<std::uint8_t> only;
  Border border = Border::Slide;  ///< What the edge of that part does.
  SymmetryOptions symmetry;       ///< Which vertices stay in planes.
  PolygonView obstacles;          ///< Meshes that the offset must not touch, or come nearer to than `clearance`.
  double clearance = 0;           ///< World units, >= 0.
  bool off_source = false;        ///< For shells: neither the result nor the rim may meet the surface they come from.
  bool inner_skin_last = false;  ///< For shells of two offsets: the last of several is the inner skin, which the others
                                 ///< must not meet.
  /// The space in which distances are measured, and all figures about them; not with obstacles, shells or layers.
  /// Positions are the file's.
  Metric metric;
  Solver solver = Solver::Closest;
  Collision collision = Collision::Limit;
  /// What becomes of sharp corners. None: Corners::Miter; in layers Corners::Round.
  std::optional<Corners> corners;
  /// The longest that a miter may be, in distances, >= 1; one that would be longer is cut, unless its end is at the
  /// distance itself.
  double miter_limit = 4;
  /// What falls short fades into its surroundings: along the surface, thickness rises from there by no more than so
  /// many times the way, >= 0. 0: it may rise at once. Vertices on creases and those inside flat faces do not fade. Not
  /// of curves and layers, nor with Collision::Merge.
  double taper = 1;
  /// The surface that the mesh is a tessellation of, which outlives the call; nullptr: the mesh is all that is known.
  /// Where it is known, vertices go along its normals, and those on its sharp edges have the miters of its faces; a
  /// vertex is Reached that is at the distance from it, though its faces may be nearer by the deflection. Has
  /// no effect where axes count differently.
  const ExactSurface* exact = nullptr;
  Precision precision;  ///< What the file that the result is for keeps; validity is checked on that.
  WeldOptions weld = WeldOptions::automatic();
  Orient orient = Orient::Keep;
  int threads = 0;  ///< 0: as many as the machine has.
  /// Bytes for the whole run, by the plan; 0: no limit. What is read, and lists that may grow to anything, keep to that
  /// of the process (set_memory_limit in run.h).
  std::size_t max_memory = 0;
  /// Bytes that the caller holds for the run, such as a file's text: counted in the plan.
  std::size_t bytes_held = 0;
  bool keep_field = false;  ///< Hand the distance field out with the result.
  bool keep_paths = false;  ///< Hand the vertices' paths out with the result; not for layers.
  bool keep_face_errors =
      false;  ///< Hand out how far each face is off its distance, and its faults; not for layers and curves.
  ProgressCallback progress;  ///< See run.h; may cancel.
  ReserveCallback reserve;    ///< See run.h; may wait, and cancel.
};

}  // namespace vdb_offset
