#pragma once

#include <array>
#include <memory>
#include <vector>

#include "vdb_offset/closest.h"
#include "vdb_offset/interior.h"
#include "vdb_offset/mend.h"
#include "vdb_offset/plan.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/precision.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/surface.h"

namespace vdb_offset {

struct CaptureOptions {
  double distance = 0;    ///< World units, not 0; negative is inward.
  GridOptions grid;       ///< The voxel size is an accuracy knob here: the length of the new mesh's edges.
  double adaptivity = 0;  ///< 0 .. 1: how readily cells are merged where the surface is flat; 0: not at all.
  Precision precision;    ///< What the file that the result is for keeps; validity is checked on that.
  WeldOptions weld;
  Orient orient = Orient::Keep;
  int threads = 0;             ///< 0: as many as the machine has.
  std::size_t max_memory = 0;  ///< Bytes for the whole run; 0: no limit.
  ProgressCallback progress;   ///< See progress.h; may cancel.
};

/// What a run will need, known before it starts.
struct CapturePlan {
  double voxel_size = 0;                  ///< World units.
  std::string reason;                     ///< Why this size, in words.
  std::size_t leaf_nodes = 0, bytes = 0;  ///< Estimates; bytes is the peak of the whole run.
  std::size_t triangles = 0;              ///< An estimate, too; without adaptivity.
};

/// The mesh that distances are measured to, in the local frame.
struct CaptureSource {
  Surface surface;
  ClosestQuery query{surface};  // refers to the surface beside it

  explicit CaptureSource(Surface placed) : surface(std::move(placed)) {}
  CaptureSource(const CaptureSource&) = delete;
  CaptureSource& operator=(const CaptureSource&) = delete;
};

/// Figures of a run. All is measured on coordinates as they will be written, vertices at one place counted as one.
struct CaptureStatistics {
  MeshFacts source;
  double distance = 0;  ///< As asked for.
  CapturePlan plan;
  int threads = 0;
  std::size_t leaf_nodes = 0;
  std::array<double, kStageCount> seconds{};  ///< By Stage.
  bool is_signed = false;                     ///< The source has an inside; else the result goes round all of it.
  std::size_t vertices = 0, triangles = 0, components = 0;
  std::size_t border_edges = 0;           ///< With one face.
  std::size_t non_manifold_edges = 0;     ///< With three faces or more.
  std::size_t pinched_vertices = 0;       ///< Whose faces make more than one fan.
  std::size_t turned_edges = 0;           ///< Whose two faces run through them in the same direction.
  MendStatistics mending;                 ///< What crossed, and what was done about it.
  double worst_error = 0, rms_error = 0;  ///< Of vertices: |distance to the source - target| / target.
  InteriorError interior;                 ///< Between vertices, of 10,000 triangles, evenly taken from all.

  bool closed() const { return border_edges == 0 && non_manifold_edges == 0; }
  bool manifold() const { return non_manifold_edges == 0 && pinched_vertices == 0 && turned_edges == 0; }
  bool valid() const { return closed() && manifold() && mending.left.total() == 0; }
};

/// The stages that take time here: Rasterise makes the surface and phi, Capture the mesh, Limit mends it.
inline constexpr Stage kCaptureStages[] = {Stage::Read,  Stage::Rasterise, Stage::Capture,
                                           Stage::Limit, Stage::Measure,   Stage::Write};

/// The captured surface, all triangles, outward as the source's faces are.
struct CaptureResult {
  Polygons polygons;                   ///< Positions are those that will be written.
  std::vector<Vec3d> normals;          ///< Of vertices: the gradient of phi, unit length.
  std::vector<std::uint32_t> closest;  ///< Of vertices: the source's triangle that is closest (see CaptureSource).
  std::shared_ptr<const CaptureSource> source;
  CaptureStatistics statistics;
};

/// The surface phi = distance, where phi is the distance to a mesh, below 0 inside of it: closed and manifold, with
/// each vertex at that distance, to rounding, and faces that do not cross. Its vertices and faces are new.
///
/// A mesh that is closed and whose faces agree about the outside has an inside: what it winds around (see Inside).
/// Around any other, phi is the distance alone, and the surface a tube around it on all its sides, whatever the sign of
/// `distance`.
///
/// phi is exact at the corners of the voxels that the surface passes through. OpenVDB's volumeToMesh, the dual marching
/// cubes of Museth et al. (OpenVDB: an open-source data structure and toolkit for high-resolution volumes, 2013), puts
/// a vertex into each of those; it goes along the exact gradient of phi to the distance asked for, and stays in its
/// voxel. Few faces cross then; what does is mended (see mend.h), and what cannot be is counted. The result does not
/// depend on the number of threads. \throw InvalidInput for a mesh or an option that cannot be used, and if there is no
/// surface at that distance; OutOfBudget before work that would not fit; Cancelled when the progress callback asks for
/// it.
CaptureResult capture(PolygonView mesh, const CaptureOptions& options);

/// What capture() would do, without doing it.
CaptureStatistics plan_capture(PolygonView mesh, const CaptureOptions& options);

}  // namespace vdb_offset
