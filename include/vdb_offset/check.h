// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/exact_surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

struct VDB_OFFSET_API CheckOptions {
  /// The distance that was asked for, world units, negative inward, one for all vertices or one for each; empty: the
  /// median of the distances found, with the sign of most of them.
  std::optional<Distances> distance;
  /// Marks of the faces that were offset. This and the next seven are as they were for the offset (see OffsetOptions).
  std::vector<std::uint8_t> only;
  Border border = Border::Slide;
  SymmetryOptions symmetry;  ///< What is beyond a plane is on the wrong side if that plane is named.
  PolygonView obstacles;
  double clearance = 0;
  Corners corners = Corners::Round;
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
  /// Of each vertex of the source: Reached (to 1e-6 of the distance and the rounding of coordinates), Mitred or Cut
  /// (at the end of its miter, as exactly; Mitred also elsewhere on the planes of all its faces, moved by the distance,
  /// or at the nearest point of some where all have no point in common, within the miter limit), Limited (nearer or
  /// farther) or Unused.
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

}  // namespace vdb_offset
