#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "vdb_offset/faults.h"
#include "vdb_offset/offset.h"

namespace vdb_offset {

struct CheckOptions {
  /// What was asked for, world units, negative inward; empty: the median of the distances found, with the sign of most.
  std::optional<double> distance;
  Precision precision;  ///< Of the offset's coordinates as stored.
  WeldOptions weld = WeldOptions::automatic();
  Metric metric;                 ///< That distances are measured in.
  Orient orient = Orient::Keep;  ///< As it was for the offset: which side of the source a distance above 0 is on.
  int threads = 0;               ///< 0: as many as the machine has.
};

/// What is found of an offset that may come from anywhere.
struct CheckResult {
  double distance = 0;  ///< Asked for or found, world units.
  MeshFacts facts;      ///< Of the source.
  /// By vertex of the source: Reached (to 1e-6 of the distance and the rounding of coordinates), Limited (nearer or
  /// farther) or Unused; and the exact distance to the source.
  std::vector<VertexState> states;
  std::vector<double> achieved;
  std::size_t beyond = 0;      ///< Vertices farther than the distance.
  std::size_t wrong_side = 0;  ///< Vertices on the other side; closed sources with one orientation only.
  std::size_t torn = 0;        ///< Vertices at one place in the source and at several in the offset.
  FaultCounts faults;
  std::size_t source_crossings = 0, crossings_near_source = 0;
  InteriorError interior;  ///< Of all faces.

  bool valid() const { return faults.total() + wrong_side + torn == 0; }
};

/// Measures `positions` as an offset of `source`: exact distances, and what the faults of FaultFinder are. The result
/// does not depend on the number of threads.
/// \throw InvalidInput for a source without faces, or positions that are not one for each of its vertices or not
/// finite.
CheckResult check_offset(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options = {});

}  // namespace vdb_offset
