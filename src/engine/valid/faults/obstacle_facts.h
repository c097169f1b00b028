// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/parts/mesh_parts.h"
#include "motion/paths/propagate.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The obstacles of mesh parts, and how near the parts are to them before anything moves.
class Surroundings {
 public:
  /// Keeps a reference to the parts. \param source positions of the vertices of parts.surface(), world coordinates
  /// \pre to_local_frame() has been called, and there are obstacles
  Surroundings(const MeshParts& parts, std::span<const Vec3d> source, double clearance);
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  const Obstacles& obstacles() const { return obstacles_; }
  /// Pairs of triangles that meet in the source, without those that only touch an obstacle, and obstacles' own.
  const std::vector<TrianglePair>& source_crossings() const { return source_crossings_; }
  /// The number of these pairs that go through an obstacle.
  std::size_t crossing() const { return start_.crossing; }

  /// Marks, as 1 in `bound`, the vertices that cannot leave an obstacle that they touch, so that they do not slide past
  /// it, either.
  void hold(const Paths& paths, const Distances& distances, std::vector<std::uint8_t>& bound) const;
  /// What is between the obstacles and a result with its vertices at these positions, as written.
  ObstacleFacts facts(std::span<const Vec3d> positions) const;

 private:
  const Surface& surface_;
  ClosestQuery query_;
  Obstacles obstacles_;
  std::vector<TrianglePair> source_crossings_;
  StartingGaps start_;
};

}  // namespace vdb_offset
