#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "vdb_offset/grid.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/metric.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/precision.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

struct IsoOptions {
  double distance = 0;      ///< World units, not 0; negative is inward.
  GridOptions grid;         ///< The voxel size is an accuracy knob here: the length of the new mesh's edges.
  bool use_winding = true;  ///< Else nothing is inside of a mesh, one edge of which does not have two faces.
  /// Without one, triangles are merged where they are flat, which changes nothing of the surface. 0: none are; up to 1:
  /// the more readily cells are merged where the surface is nearly flat.
  std::optional<double> adaptivity;
  bool keep_specks = false;  ///< Keep pieces that enclose less than a voxel, as knife edges leave them.
  Precision precision;       ///< What the file that the result is for keeps; validity is checked on that.
  WeldOptions weld = WeldOptions::automatic();
  Orient orient = Orient::Keep;
  int threads = 0;             ///< 0: as many as the machine has.
  std::size_t max_memory = 0;  ///< Bytes for the whole run; 0: no limit.
  ProgressCallback progress;   ///< See progress.h; may cancel.
};

/// What a run will need, known before it starts.
struct IsoPlan {
  double voxel_size = 0;                  ///< World units.
  std::string reason;                     ///< Why this size, in words.
  std::size_t leaf_nodes = 0, bytes = 0;  ///< Estimates; bytes is the peak of the whole run.
  std::size_t triangles = 0;              ///< An estimate, too; without adaptivity.
};

/// What of a mesh is solid, and was made of it.
struct SolidFacts {
  std::size_t parts = 0, open_parts = 0;  ///< Joined over edges; those without an inside.
  std::size_t holes = 0;                  ///< Filled, of the others.
  double hole_share = 0;                  ///< Their area by that of the solid parts.
  std::size_t buried = 0, cut = 0;        ///< Triangles that are inside with both sides, and those that others cut.
};

/// What may be wrong with a closed mesh's places.
struct MeshFaults {
  std::size_t crossings = 0;  ///< Pairs of triangles that meet elsewhere than in the corners and edges they share.
  std::size_t needles = 0;    ///< Triangles without area (see is_needle).

  std::size_t total() const { return crossings + needles; }
};

/// What mending found and did, to the mesh that was kept.
struct MendStatistics {
  MeshFaults before, left;
  std::size_t rounds = 0, moved_vertices = 0, flipped_edges = 0, split_edges = 0;
};

/// Figures of a run. All is measured on coordinates as they will be written, vertices at one place counted as one.
struct IsoStatistics {
  MeshFacts source;
  double distance = 0;  ///< As asked for.
  IsoPlan plan;
  int threads = 0;
  std::size_t leaf_nodes = 0;
  std::array<double, kStageCount> seconds{};  ///< By Stage.
  bool is_signed = false;                     ///< The source has an inside; else the result goes round all of it.
  SolidFacts solid;
  std::size_t vertices = 0, triangles = 0, components = 0;
  std::size_t dropped_specks = 0;         ///< Pieces that enclosed less than a voxel (see IsoOptions::keep_specks).
  std::size_t merged_vertices = 0;        ///< Taken out of what is flat (see merge_flats.h).
  std::size_t attempts = 0;               ///< On how many lattices the surface was captured until it was valid.
  std::size_t border_edges = 0;           ///< With one face.
  std::size_t non_manifold_edges = 0;     ///< With three faces or more.
  std::size_t pinched_vertices = 0;       ///< Whose faces make more than one fan.
  std::size_t turned_edges = 0;           ///< Whose two faces run through them in the same direction.
  MendStatistics mending;                 ///< What crossed, and what was done about it.
  double worst_error = 0, rms_error = 0;  ///< Of vertices: |distance to the source - target| / target.
  FaceInteriorError interior;             ///< Between vertices, of 10,000 triangles, evenly taken from all.

  bool closed() const { return border_edges == 0 && non_manifold_edges == 0; }
  bool manifold() const { return non_manifold_edges == 0 && pinched_vertices == 0 && turned_edges == 0; }
  bool valid() const { return closed() && manifold() && mending.left.total() == 0; }
};

/// The stages that take time here: Rasterise makes the surface and phi, Capture the mesh, Limit mends it.
inline constexpr Stage kIsoStages[] = {Stage::Read,  Stage::Rasterise, Stage::Capture,
                                       Stage::Limit, Stage::Measure,   Stage::Write};

struct IsoSource;

/// The captured surface, all triangles, outward as the source's faces are.
struct IsoResult {
  Polygons polygons;                   ///< Positions are those that will be written.
  std::vector<Vec3d> normals;          ///< Of vertices: the gradient of phi, unit length.
  std::vector<std::uint32_t> closest;  ///< Of vertices: the source's triangle that is closest (see IsoSource).
  std::shared_ptr<const IsoSource> source;
  IsoStatistics statistics;
};

/// The surface phi = distance, where phi is the distance to a mesh, below 0 inside of it: closed and manifold, with
/// each vertex at that distance, to rounding, and faces that do not cross. Its vertices and faces are new.
///
/// Inside is what the mesh's solid parts wind around (see holes.h): those that are closed, however many faces an edge
/// has, and those whose holes are small beside them. Inward, distances are to the boundary of that, so that parts which
/// overlap or lie in each other are one (see solid_boundary.h). Around the others phi is the distance alone; if nothing
/// is solid, the surface is a tube around the mesh on all its sides, whatever the sign of `distance`.
///
/// phi is exact at the corners of the voxels that the surface passes through. OpenVDB's volumeToMesh, the dual marching
/// cubes of Museth et al. (OpenVDB: an open-source data structure and toolkit for high-resolution volumes, 2013), puts
/// a vertex into each of those; it goes along the exact gradient of phi to the distance asked for, and stays in its
/// voxel. Few faces cross then; what does is mended (see mend.h), and what cannot be is counted. The result does not
/// depend on the number of threads. \throw InvalidInput for a mesh or an option that cannot be used, and if there is no
/// surface at that distance; OutOfBudget before work that would not fit; Cancelled when the progress callback asks for
/// it.
IsoResult make_iso_surface(PolygonView mesh, const IsoOptions& options);

/// What make_iso_surface() would do, without doing it.
IsoStatistics plan_iso_surface(PolygonView mesh, const IsoOptions& options);

/// make_iso_surface() with distances in a metric. Validity is checked on coordinates as they will be written; distances
/// and what they tell are the metric's. \throw as make_iso_surface()
IsoResult make_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options, const Metric& metric);

/// What make_iso_surface_in_metric() would do, without doing it.
IsoStatistics plan_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options, const Metric& metric);

}  // namespace vdb_offset
