// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

struct VDB_OFFSET_API IsoOptions {
  double distance = 0;  ///< World units, not 0; negative is inward.
  GridOptions grid;     ///< The voxel size is an accuracy knob here: the length of the new mesh's edges.
  /// Whether a mesh that is not closed can have an inside, by what its solid parts wind around.
  bool use_winding = true;
  /// How readily voxels are merged where the surface is nearly flat: from 0, none, to 1. Without a value, triangles are
  /// merged where they are exactly flat, which leaves the surface as it is.
  std::optional<double> adaptivity;
  bool off_source = false;   ///< By default, voxels are so small that no face reaches the source, as in hollow solids.
  bool keep_specks = false;  ///< Keep pieces that enclose less than a voxel, as knife edges leave them.
  Precision precision;       ///< Of the coordinates in the file that the result is for; validity is checked on these.
  WeldOptions weld = WeldOptions::automatic();
  Orient orient = Orient::Keep;
  int threads = 0;             ///< 0: as many as the machine has.
  std::size_t max_memory = 0;  ///< Bytes for the whole run; 0: no limit.
  std::size_t bytes_held = 0;  ///< Bytes that the caller holds for the run, as in OffsetOptions.
  ProgressCallback progress;   ///< See run.h; may cancel.
  ReserveCallback reserve;     ///< See run.h; may wait, and cancel.
};

/// What a run will need, known before it starts.
struct IsoPlan {
  double voxel_size = 0;                  ///< World units.
  std::string reason;                     ///< Why this size, in words.
  std::size_t leaf_nodes = 0, bytes = 0;  ///< Estimates; bytes is the peak of the whole run.
  std::size_t triangles = 0;              ///< Estimate, without merging.
};

/// Facts about the solid parts of a mesh.
struct SolidFacts {
  std::size_t parts = 0, open_parts = 0;  ///< Parts connected over edges; parts without an inside.
  std::size_t holes = 0;                  ///< Holes of solid parts, which are filled.
  double hole_share = 0;                  ///< The area of these holes divided by that of the solid parts.
  std::size_t buried = 0, cut = 0;        ///< Triangles with both sides inside; triangles that others cut.
};

/// Faults of a closed mesh.
struct MeshFaults {
  std::size_t crossings = 0;  ///< Pairs of triangles that meet elsewhere than in the corners and edges they share.
  std::size_t needles = 0;    ///< Triangles without area (see is_needle).

  std::size_t total() const { return crossings + needles; }
};

/// The faults that mending found and left, and what it did to the mesh that was kept.
struct MendStatistics {
  MeshFaults before, left;
  std::size_t rounds = 0, moved_vertices = 0, flipped_edges = 0, split_edges = 0;
};

/// Figures of a run, measured on coordinates as they will be written, with vertices at one position counted as one.
struct IsoStatistics {
  MeshFacts source;
  double distance = 0;  ///< The distance that was asked for.
  IsoPlan plan;
  int threads = 0;
  std::size_t leaf_nodes = 0;
  std::array<double, kStageCount> seconds{};  ///< By Stage.
  bool is_signed = false;                     ///< The source has an inside; else the result surrounds all of it.
  SolidFacts solid;
  std::size_t vertices = 0, triangles = 0, components = 0;
  std::size_t dropped_specks = 0;         ///< Pieces that enclosed less than a voxel (see IsoOptions::keep_specks).
  std::size_t merged_vertices = 0;        ///< Vertices taken out of flat parts (see merge_flats.h).
  std::size_t attempts = 0;               ///< Lattices on which the surface was made until it was valid.
  std::size_t border_edges = 0;           ///< Edges with one face.
  std::size_t non_manifold_edges = 0;     ///< Edges with three faces or more.
  std::size_t pinched_vertices = 0;       ///< Vertices whose faces make more than one fan.
  std::size_t turned_edges = 0;           ///< Edges whose two faces run through them in the same direction.
  MendStatistics mending;                 ///< Crossings and needles, and what was done about them.
  double worst_error = 0, rms_error = 0;  ///< Of vertices: |distance to the source - target| / target.
  FaceError faces;                        ///< Its causes are not found.

  bool closed() const { return border_edges == 0 && non_manifold_edges == 0; }
  bool manifold() const { return non_manifold_edges == 0 && pinched_vertices == 0 && turned_edges == 0; }
  bool valid() const { return closed() && manifold() && mending.left.total() == 0; }
};

/// The stages of making an iso-surface: Rasterise makes the surface and phi, Capture the mesh, Limit mends it.
inline constexpr Stage kIsoStages[] = {Stage::Read,  Stage::Rasterise, Stage::Capture,
                                       Stage::Limit, Stage::Measure,   Stage::Write};

struct IsoSource;

/// An iso-surface: triangles that point outward as the source's faces do.
struct IsoResult {
  Polygons polygons;                   ///< The mesh, with positions that will be written.
  std::vector<Vec3d> normals;          ///< Of each vertex: the gradient of phi, unit length.
  std::vector<std::uint32_t> closest;  ///< Of each vertex: the source's triangle that is closest (see IsoSource).
  std::shared_ptr<const IsoSource> source;
  IsoStatistics statistics;
};

/// Makes the iso-surface phi = distance, where phi is the distance to a mesh, below 0 inside of it: closed and
/// manifold, with each vertex at that distance, to rounding, and faces that do not cross. Its vertices and faces are
/// new.
///
/// Inside is what the mesh's solid parts wind around (see holes.h): parts that are closed, however many faces an edge
/// has, and parts whose holes are small beside them. Inward, distances are measured to the boundary of the inside, so
/// that parts which overlap or lie in each other count as one (see solid_boundary.h). Around all other parts phi has no
/// sign; if no part is solid, the surface is a tube around the mesh on all its sides, whatever the sign of `distance`.
///
/// phi is exact at the corners of the voxels that the surface passes through. OpenVDB's volumeToMesh, the dual marching
/// cubes of Museth et al. (OpenVDB: an open-source data structure and toolkit for high-resolution volumes, 2013), puts
/// a vertex into each of these voxels. The vertex goes along the exact gradient of phi to the distance asked for, and
/// stays in its voxel. Few faces cross then; crossings are mended (see mend.h), and those that cannot be are counted.
/// The result does not depend on the number of threads. \throw InvalidInput for a mesh or an option that cannot be
/// used, and if there is no surface at that distance; OutOfBudget before work that would not fit; Cancelled when the
/// progress callback asks for it.
VDB_OFFSET_API IsoResult make_iso_surface(PolygonView mesh, const IsoOptions& options);

/// Plans what make_iso_surface() would do, without doing it.
VDB_OFFSET_API IsoStatistics plan_iso_surface(PolygonView mesh, const IsoOptions& options);

/// Makes an iso-surface with distances in a metric, by make_iso_surface(). Validity is checked on coordinates as they
/// will be written; distances, and all figures of them, are measured in the metric. \throw as make_iso_surface()
VDB_OFFSET_API IsoResult make_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options, const Metric& metric);

/// Plans what make_iso_surface_in_metric() would do, without doing it.
VDB_OFFSET_API IsoStatistics plan_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options,
                                                        const Metric& metric);

}  // namespace vdb_offset
