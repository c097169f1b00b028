#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/base/box_tree.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/validity/triangle_crossings.h"

namespace vdb_offset {

/// Three corners.
using TriangleCorners = std::array<Vec3d, 3>;

/// Distance between two triangles, 0 if they meet.
double distance_between(const TriangleCorners& a, const TriangleCorners& b);
/// The same, with a point of `a` that is that near to `b`.
double distance_between(const TriangleCorners& a, const TriangleCorners& b, Vec3d& on_a);

/// Tells how near triangles come to obstacles, not at their vertices alone.
class ClearanceFinder {
 public:
  /// Keeps a reference.
  explicit ClearanceFinder(const Obstacles& obstacles);

  /// The least distance of a triangle, in the obstacles' frame, to any of them: exact if it is below `limit`, which is
  /// the answer if none is that near.
  double gap(const TriangleCorners& triangle, double limit) const;
  /// The same, with a point of the triangle that is that near, if there is one.
  double gap(const TriangleCorners& triangle, double limit, Vec3d& where) const;
  /// Whether it is nearer to any of them than `bound` by more than 1e-6 of the clearance and `slack`.
  bool is_crowded(const TriangleCorners& triangle, double bound, double slack) const;

 private:
  const Obstacles& obstacles_;
  BoxTree tree_;
};

/// What stands between a body and its obstacles: of the triangles that are not obstacles' own.
struct Gap {
  double least = 0;             ///< World units; 0 if any meets an obstacle.
  std::size_t near = 0;         ///< Triangles nearer than the clearance by more than 1e-6 of it, or that meet one.
  std::vector<double> of_each;  ///< Of each triangle, but no more than the clearance; only if asked for.
};
enum class OfEach : bool { No, Yes };
/// `places` of the surface's vertices, in world coordinates. The result does not depend on the number of threads.
Gap measure_gap(const Surface& surface, std::span<const Vec3d> places, const Obstacles& obstacles,
                OfEach of_each = OfEach::No);

/// Where a body stands to its obstacles, given the pairs of its surface's triangles that meet where it stands. Of those
/// the ones are taken out that have an obstacle in them and do not go through each other: touching is not crossing.
StartingGaps find_starting_gaps(const Surface& surface, std::span<const Vec3d> places, const Obstacles& obstacles,
                                std::vector<TrianglePair>& meeting);

}  // namespace vdb_offset
