#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "vdb_offset/base/progress.h"
#include "vdb_offset/field/grid_plan.h"
#include "vdb_offset/field/sweep.h"
#include "vdb_offset/limit/limit.h"
#include "vdb_offset/mesh/distances.h"
#include "vdb_offset/mesh/metric.h"
#include "vdb_offset/mesh/openmesh.h"
#include "vdb_offset/mesh/polygons.h"
#include "vdb_offset/parts/border_facts.h"
#include "vdb_offset/parts/mesh_parts.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/paths/side_room.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/validity/face_error.h"
#include "vdb_offset/validity/obstacle_facts.h"

namespace vdb_offset {

/// What happens where fronts meet.
enum class Collision {
  Limit,  ///< The result stays valid: vertices are held back where faces would fold or cross.
  Merge,  ///< The paper's weak solution: every vertex goes as far as phi allows; faces there may fold or collapse.
};

struct OffsetOptions {
  /// World units, one for all or one for each vertex of the input; negative is inward, 0 leaves a vertex where it is.
  /// Vertices that move as one go their numbers' mean.
  Distances distance;
  GridOptions grid;
  /// Of each face: 1 for those that are offset; the others stay, and are in the way. Distances are those from the part.
  /// Empty: all are.
  std::vector<std::uint8_t> only;
  Border border = Border::Slide;  ///< What the edge of that part does.
  SymmetryOptions symmetry;       ///< Which vertices stay in planes.
  PolygonView obstacles;          ///< Other geometry that nothing may touch, or come nearer to than `clearance`.
  double clearance = 0;           ///< World units, >= 0.
  bool off_source = false;        ///< For shells: neither the result nor the rim may meet the surface they come from.
  bool inner_skin_last = false;   ///< For shells of two offsets: the last of several is one that the others keep off.
  /// Distances are measured in its space, and so are states and all else that is told of them; not with obstacles,
  /// shells or layers. Positions are the file's.
  Metric metric;
  Solver solver = Solver::Closest;
  Collision collision = Collision::Limit;
  Precision precision;  ///< What the file that the result is for keeps; validity is checked on that.
  WeldOptions weld = WeldOptions::automatic();
  Orient orient = Orient::Keep;
  int threads = 0;  ///< 0: as many as the machine has.
  /// Bytes for the whole run, by the plan; 0: no limit. What is read, and lists that may grow to anything, keep to that
  /// of the process (set_memory_limit in memory.h).
  std::size_t max_memory = 0;
  bool keep_field = false;    ///< Hand the distance field out with the result.
  bool keep_paths = false;    ///< The same for the vertices' paths; not for layers.
  ProgressCallback progress;  ///< See progress.h; may cancel.
};

/// Figures of a run, beside its result.
struct OffsetStatistics {
  MeshFacts facts;
  GridPlan plan;
  int threads = 0;
  std::size_t active_voxels = 0, leaf_nodes = 0;
  std::size_t phi_bytes = 0, closest_bytes = 0, gradient_bytes = 0;
  std::array<double, kStageCount> seconds{};  ///< By Stage.
  std::array<std::size_t, kVertexStateCount> vertices_by_state{};
  std::size_t straight_vertices = 0;
  std::size_t disagreeing_distances = 0;  ///< Vertices that move with one of which another distance was asked;
                                          ///< of layers, at the height at which most do.
  LimitStatistics limit;
  BorderFacts borders;
  SideRoom room;
  std::optional<ObstacleFacts> obstacles;  ///< If there are any. Of layers: of the outermost surface.
  std::optional<FitFacts> fit;             ///< Of what fit() made.
  InteriorError interior;  ///< Of 10,000 triangles, evenly taken from all, or of all if there are fewer.
};

struct OffsetResult {
  std::vector<Vec3d> positions;     ///< One per input vertex, in the input's order.
  std::vector<VertexState> states;  ///< One per input vertex.
  std::vector<double> achieved;     ///< Exact unsigned distance to the input surface, world units.
  Distances distances;              ///< What was asked of each input vertex, in the end.
  OffsetStatistics statistics;
  std::shared_ptr<DistanceField> field;  ///< Only with keep_field and a distance other than 0.
  /// Only with keep_paths: the places that each input vertex came by on its march, from where it stood to where that
  /// ended; after that, if it has been moved to keep the result valid, its position.
  std::vector<std::vector<Vec3d>> paths;
};

/// Offsets a mesh: the same vertices and faces, each vertex at `distance` from the surface or as near to that as
/// its state says. The faces need not be manifold, closed or oriented; only the positions are new.
/// The result does not depend on the number of threads. Concurrent calls are independent of each other.
/// \throw InvalidInput for a mesh or an option that cannot be used, OutOfBudget before work that would not fit,
/// Cancelled when the progress callback asks for it.
OffsetResult offset(PolygonView mesh, const OffsetOptions& options);

/// Several offsets of one mesh, for little more than one: one field and one march serve all. `options.distance` does
/// not count. Directions are smoothed as for the farthest, and with Collision::Limit nearer offsets begin, where they
/// have to be mended, with what became of the farthest on their side (see warm_start.h): there, one alone may end up
/// elsewhere. Answers come in the order of `distances`.
std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                         const OffsetOptions& options);

/// The same as offset() for a half-edge mesh, whose points are replaced. \pre no deleted elements.
OffsetResult offset(Mesh& mesh, const OffsetOptions& options);

/// Diagonal of the bounding box of the vertices that faces use, which percentages of a distance refer to.
double used_diagonal(PolygonView mesh);

/// What offset() would do, without doing it: the mesh's facts and the plan of the grid.
OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options);
/// The same for offset_several(), or for grow_layers() to the only distance, with so many layers.
OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options,
                              std::size_t layers = 0);

}  // namespace vdb_offset
