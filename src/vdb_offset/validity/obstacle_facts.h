#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/mesh/distances.h"
#include "vdb_offset/parts/mesh_parts.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/validity/clearance.h"

namespace vdb_offset {

/// What is between a result and its obstacles. World units; triangles of the whole mesh, whether or not they move.
struct ObstacleFacts {
  double gap = 0, starting_gap = 0;  ///< Least distance to an obstacle: of the result as written, and of the input.
  std::size_t near = 0;              ///< Triangles of the result nearer than the clearance, or that meet an obstacle.
  std::size_t touching = 0;          ///< Pairs of the input's triangles and obstacles' that meet: not through each
  std::size_t crossing = 0;          ///< other, and through.
};

/// What fit() did. Gaps are world units, below 0 inside of the other mesh, if that is a solid.
struct FitFacts {
  double clearance = 0;
  double gap = 0, starting_gap = 0;         ///< Least gap: of the result as written, and of the input.
  std::size_t near = 0, near_at_start = 0;  ///< Triangles nearer than the clearance by more than 1e-6 of it.
  std::size_t moved = 0;                    ///< Vertices of the mesh that gave way.
  double deepest = 0;                       ///< How far any went inward, as exact distance from the input.
  std::size_t rounds = 0;                   ///< Offsets that were made.
  bool is_signed = false;                   ///< The other mesh is a solid: what is inside of it is known.
  std::size_t enclosed = 0;                 ///< Components of the other mesh that lie inside of the result as a whole.
};

/// A workpiece's obstacles, and how it stands to them before anything moves.
class Surroundings {
 public:
  /// `source` holds where the vertices of the workpiece's surface stand, world coordinates. Keeps a reference to the
  /// workpiece. \pre it is placed, and has obstacles
  Surroundings(const Workpiece& work, std::span<const Vec3d> source, double clearance);
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
