// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// Offsets a mesh: its vertices and faces stay, and each vertex gets a position at `distance` from the surface, or one
/// as near to that as its state says. The faces need not be manifold, closed or oriented. The result does not depend on
/// the number of threads. Concurrent calls are independent of each other. \throw InvalidInput for a mesh or an option
/// that cannot be used, OutOfBudget before work that would not fit, Cancelled when the progress callback asks for it.
VDB_OFFSET_API OffsetResult offset(PolygonView mesh, const OffsetOptions& options);

/// Makes several offsets of one mesh, for little more than one: one field and one march serve all. `options.distance`
/// has no effect. Directions are smoothed as for the farthest distance, and with Collision::Limit nearer offsets that
/// have to be mended start from the finished farthest offset on their side (see warm_start.h): there, an offset made
/// alone may have other positions. Results are in the order of `distances`.
VDB_OFFSET_API std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                                        const OffsetOptions& options);

/// Plans what offset() would do, without doing it: the mesh's facts and the plan of the grid.
VDB_OFFSET_API OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options);
/// Plans what offset_several() would do, or grow_layers() to the only distance with so many layers, without doing it:
/// the mesh's facts and the plan of the grid.
VDB_OFFSET_API OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances,
                                             const OffsetOptions& options, std::size_t layers = 0);

/// Makes room between a mesh and another one: parts of the mesh that are nearer to the other than `clearance` (world
/// units, above 0) go inward until they are that far away, including faces between vertices; the rest stays. A flat
/// face between sharp edges goes as a whole, so that it stays flat, and corners go to where the moved faces and those
/// that stay meet, as with Corners::Miter. If the
/// other mesh is a solid, parts inside of it are too near by their depth, whichever way its faces point; if it is not,
/// each side of it is outside.
///
/// Each round is an offset in which flat faces, and the vertices of curved ones, go inward by what they lack: the
/// nearest point of a triangle that is too near is a weighted mean of its corners, and each corner goes farther by its
/// weight. Where several faces meet, those go for which that helps. How much the gap grows shows how far to go in the
/// next round. Rounds end when nothing is too near, or when the best one has not been bettered for some: where the mesh
/// is too thin, or inward does not lead away from the other mesh. The best round, with the fewest triangles too near
/// and then the widest gap, is the result; its `distances` are those that were needed, and its `statistics.fit` has the
/// gap that is left.
///
/// Of the options, `distance`, `corners`, `obstacles`, `clearance`, `metric` and those of shells have no effect. \throw
/// InvalidInput as offset(), and for a clearance that is not above 0 or another mesh without faces.
VDB_OFFSET_API OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options);
/// Reports what fit() would do in its first round, without doing it: the mesh's facts, the plan of the grid (without
/// voxels where nothing is too near), and in `fit` the gap, what is nearer than the clearance, and how far parts have
/// to go. \throw as fit()
VDB_OFFSET_API OffsetStatistics plan_fit(PolygonView mesh, PolygonView other, double clearance,
                                         const OffsetOptions& options);

struct VDB_OFFSET_API CheckOptions {
  /// The distance that was asked for, world units, negative inward, one for all vertices or one for each; empty: the
  /// median of the distances found, with the sign of most of them; with miters that of most of the faces' area.
  std::optional<Distances> distance;
  /// Marks of the faces that were offset. This and the next seven are as they were for the offset (see OffsetOptions).
  std::vector<std::uint8_t> only;
  Border border = Border::Slide;
  SymmetryOptions symmetry;  ///< What is beyond a plane is on the wrong side if that plane is named.
  PolygonView obstacles;
  double clearance = 0;
  /// None: Corners::Miter. Arc: the source is a refinement with faces over ridges.
  std::optional<Corners> corners;
  double miter_limit = 4;
  const ExactSurface* exact = nullptr;
  WeldOptions weld = WeldOptions::automatic();
  Metric metric;  ///< Of the space in which distances are measured.
  Orient orient = Orient::Keep;
  Precision precision;  ///< Of the coordinates of the offset as stored.
  /// How far faces may be off at any point of them, as a share of the distance or in world units; then it is proven of
  /// as many as possible. One of them is above 0, or nothing is proven. Not with a metric.
  double tolerance_share = 0, tolerance_length = 0;
  bool keep_face_errors = false;  ///< Hand out how far each face is off its distance, and its faults.
  int threads = 0;                ///< 0: as many as the machine has.
  ProgressCallback progress;      ///< See run.h; all of a check is Stage::Measure. May cancel.
};

/// Measures of an offset, wherever it comes from.
struct CheckResult {
  double distance = 0;  ///< The distance asked for, or found, world units; the farthest if vertices differ.
  Distances distances;  ///< The distance of each vertex of the source.
  MeshFacts facts;      ///< Of the source.
  /// Of each vertex of the source: Reached (to 1e-6 of the distance and the rounding of coordinates), Mitered or Cut
  /// (at the end of its miter, as exactly; Mitered also elsewhere on the planes of all its faces, moved by the
  /// distance, or at the nearest point of some where all have no point in common, within the miter limit), Limited
  /// (nearer or farther) or Unused.
  std::vector<VertexState> states;
  std::vector<double> achieved;  ///< Of each vertex: the exact distance to the source, world units.
  std::size_t beyond = 0;        ///< Vertices farther than the distance.
  std::size_t wrong_side = 0;    ///< Vertices on the other side; of closed sources with one orientation only.
  std::size_t torn = 0;          ///< Vertices welded to another in the source that have another position in the offset.
  FaultCounts faults;
  std::size_t source_crossings = 0, crossings_near_source = 0;
  bool more_source_crossings = false;  ///< There are more source crossings than these; faces near them are not judged.
  FaceError faces;
  std::vector<float> face_errors;           ///< Only with keep_face_errors: as OffsetResult's.
  std::vector<FaceFault> face_faults;       ///< Only with keep_face_errors: of each face; empty if there are none.
  std::optional<CertifiedFaces> certified;  ///< If there is a tolerance, and a distance other than 0.
  std::optional<ObstacleFacts> obstacles;   ///< If there are obstacles.

  bool valid() const { return faults.total() + wrong_side + torn == 0; }
};

/// Measures `positions` as an offset of `source`: exact distances, and the faults that FaultFinder finds. For positions
/// made by offset(), rounded as they were stored, these are the faults that offset() has found itself. The result does
/// not depend on the number of threads. \throw InvalidInput for a source without faces, distances or positions that are
/// not one for each of its vertices, or positions that are not finite; Cancelled when the progress callback asks for
/// it.
VDB_OFFSET_API CheckResult check_offset(PolygonView source, std::span<const Vec3d> positions,
                                        const CheckOptions& options = {});

/// How far the faces of an offset may be off their distance.
struct VDB_OFFSET_API Tolerance {
  double share = 0;   ///< Of the distance at each point, above 1e-5 and below 1; or 0, and
  double length = 0;  ///< world units, above 1e-5 of the largest distance.
  /// No more are made, but for the pieces of faces that vertices hang on; 0: 20 times as many as the mesh has, at least
  /// a million. Arcs that would need more are refused.
  std::size_t most_faces = 0;
  /// What the file that the refined mesh is for keeps of coordinates: those of vertices that are added are rounded to
  /// that; if it `rounds_all`, those of the mesh first, so that what is offset is what will be read.
  Precision precision;
  /// With Corners::Arc: faces are added over ridges, and none are split.
  bool ridges_only = false;

  /// The tolerance where the distance is `distance`, world units.
  double at(double distance) const;
  /// How many faces may be made of a mesh that has so many.
  std::size_t limit_of_faces(std::size_t mesh_faces) const;
};

struct RefinedOffset {
  Refinement refinement;  ///< The mesh that was offset: the one given, rounded if the precision asks for that, its
                          ///< faces split.
  OffsetResult result;    ///< Of that; `statistics.certified` is what is proven.
};

/// Offsets a mesh so that its faces are at the distance, too: they are split until it is proven that every point of the
/// offset is within the tolerance, wherever its vertices get to their distance.
///
/// Added vertices go to the point at their distance that is nearest to the middle between the ends of their neighbours.
/// The result is an offset() of the refined mesh, in which the given mesh's vertices go where they go without
/// refinement, unless something has to be held back; the proof is made of its positions as written. Options are those
/// of offset(), but for `metric`, `off_source`, `inner_skin_last`, `keep_field` and `keep_paths`; `keep_face_errors`
/// has no effect. \throw as offset(), and InvalidInput for a tolerance that cannot be used, or one of these options
///
/// With Corners::Arc faces are added over ridges, and then split where that is still needed, unless the tolerance is
/// for `ridges_only`. Ridges are edges that are convex on the side to which they go (inward, concave ones), and bend by
/// more than one vertex could serve within the tolerance. A vertex on ridges has a copy for each part of the surface
/// between them, and more in between; all copies stand where it stands in the mesh, and each moves by itself: faces in
/// their planes, and what lies between them on the round surface at the distance. The refinement has the mesh's faces
/// in their order, with the copies of their corners; then strips of faces, edge by edge, then patches over corners
/// (`over_ridges` and `over_corners` count them), each with one of the mesh's faces beside it for a parent. On borders,
/// ridges are opened along the border. They are not at borders of the part that moves, where two planes hold a vertex,
/// at edges of more than two faces, and where their strips would cross. `exact` has no effect. \throw OutOfBudget
/// before more faces are made than may be
VDB_OFFSET_API RefinedOffset offset_to_tolerance(PolygonView mesh, const OffsetOptions& options,
                                                 const Tolerance& tolerance);

}  // namespace vdb_offset
