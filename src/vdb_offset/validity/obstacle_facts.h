#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/mesh_parts.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/statistics.h"
#include "vdb_offset/validity/clearance.h"

namespace vdb_offset {

/// A workpiece's obstacles, and how it stands to them before anything moves.
class Surroundings {
 public:
  /// `source` holds where the vertices of the workpiece's surface stand, world coordinates. Keeps a reference to the
  /// workpiece. \pre it is placed, and has obstacles
  Surroundings(const MeshParts& parts, std::span<const Vec3d> source, double clearance);
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  const Obstacles& obstacles() const { return obstacles_; }
  /// Pairs of triangles that meet in the source, but for those that only touch an obstacle, and obstacles' own.
  const std::vector<TrianglePair>& source_crossings() const { return source_crossings_; }
  /// How many of them go through an obstacle.
  std::size_t crossing() const { return start_.crossing; }

  /// Marks the vertices that cannot leave an obstacle that they touch, so that they do not slide past it, either.
  void hold(const Paths& paths, const Distances& distances, std::vector<std::uint8_t>& bound) const;
  /// Of a result whose vertices stand at these places, as written.
  ObstacleFacts facts(std::span<const Vec3d> places) const;

 private:
  const Surface& surface_;
  ClosestQuery query_;
  Obstacles obstacles_;
  std::vector<TrianglePair> source_crossings_;
  StartingGaps start_;
};

}  // namespace vdb_offset
