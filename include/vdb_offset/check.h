#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/offset.h"

namespace vdb_offset {

struct CheckOptions {
  /// What was asked for, world units, negative inward, one for all or one for each vertex; empty: the median of the
  /// distances found, with the sign of most.
  std::optional<Distances> distance;
  /// These as they were for the offset (see OffsetOptions).
  std::vector<std::uint8_t> only;
  Border border = Border::Slide;
  PolygonView obstacles;
  double clearance = 0;
  WeldOptions weld = WeldOptions::automatic();
  Metric metric;  ///< That distances are measured in.
  Orient orient = Orient::Keep;
  Precision precision;  ///< Of the offset's coordinates as stored.
  int threads = 0;      ///< 0: as many as the machine has.
};

/// What is found of an offset that may come from anywhere.
struct CheckResult {
  double distance = 0;  ///< Asked for or found, world units; the farthest where they differ.
  Distances distances;  ///< The same of each vertex of the source.
  MeshFacts facts;      ///< Of the source.
  /// By vertex of the source: Reached (to 1e-6 of the distance and the rounding of coordinates), Limited (nearer or
  /// farther) or Unused; and the exact distance to the source.
  std::vector<VertexState> states;
  std::vector<double> achieved;
  std::size_t beyond = 0;      ///< Vertices farther than the distance.
  std::size_t wrong_side = 0;  ///< Vertices on the other side; closed sources with one orientation only.
  std::size_t torn = 0;        ///< Vertices that moved as one in the source and stand apart in the offset.
  FaultCounts faults;
  std::size_t source_crossings = 0, crossings_near_source = 0;
  bool more_source_crossings = false;      ///< There are more of them than these, and what is near is not looked at.
  FaceInteriorError interior;              ///< Of all faces.
  std::optional<ObstacleFacts> obstacles;  ///< If there are any.

  bool valid() const { return faults.total() + wrong_side + torn == 0; }
};

/// Measures `positions` as an offset of `source`: exact distances, and what the faults of FaultFinder are, which are
/// those that offset() has found in what it made, if these are the places that it made, rounded as they were stored.
/// The result does not depend on the number of threads. \throw InvalidInput for a source without faces, distances or
/// positions that are not one for each of its vertices, or positions that are not finite.
CheckResult check_offset(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options = {});

}  // namespace vdb_offset
