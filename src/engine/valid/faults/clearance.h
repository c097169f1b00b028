// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "motion/parts/constrained_surface.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {

/// The corners of a triangle.
using TriangleCorners = std::array<Vec3d, 3>;

/// Distance between two triangles, 0 if they meet.
double distance_between(const TriangleCorners& a, const TriangleCorners& b);
/// Distance between two triangles, 0 if they meet; `on_a` becomes a point of `a` that is that near to `b`.
double distance_between(const TriangleCorners& a, const TriangleCorners& b, Vec3d& on_a);

/// Measures how near triangles come to obstacles, not at their vertices alone.
class ClearanceFinder {
 public:
  /// Keeps a reference. Lengths are world units.
  explicit ClearanceFinder(const Obstacles& obstacles);

  /// The least distance of a triangle, in the obstacles' frame, to any obstacle: exact if it is below `limit`, which is
  /// the answer if no obstacle is that near.
  double gap(const TriangleCorners& triangle, double limit) const;
  /// The least distance of a triangle to any obstacle, at most `limit`; `where` becomes a point of the triangle that is
  /// that near, if the answer is below `limit`.
  double gap(const TriangleCorners& triangle, double limit, Vec3d& where) const;
  /// Whether a triangle is nearer to any obstacle than `bound` by more than 1e-6 of the clearance and `slack`.
  bool is_crowded(const TriangleCorners& triangle, double bound, double slack) const;

 private:
  const Obstacles& obstacles_;
  BoxTree tree_;
};

/// The gap between a constrained surface and its obstacles: of its triangles that are not obstacles' own.
struct Gap {
  double least = 0;             ///< World units; 0 if any triangle meets an obstacle.
  std::size_t near = 0;         ///< Triangles nearer than the clearance by more than 1e-6 of it, or that meet one.
  std::vector<double> of_each;  ///< Of each triangle, but no more than the clearance; only if asked for.
};
/// Whether Gap::of_each is asked for.
enum class OfEach : bool { No, Yes };
/// Measures the gap. The result does not depend on the number of threads.
/// \param positions of the surface's vertices, world coordinates
Gap measure_gap(const Surface& surface, std::span<const Vec3d> positions, const Obstacles& obstacles,
                OfEach of_each = OfEach::No);

/// Measures how near a surface is to its obstacles before anything moves. `meeting` are the pairs of triangles that
/// meet at these positions: those of an obstacle's triangle that do not go through each other are taken out, as
/// touching is not crossing.
StartingGaps find_starting_gaps(const Surface& surface, std::span<const Vec3d> positions, const Obstacles& obstacles,
                                std::vector<TrianglePair>& meeting);

}  // namespace vdb_offset
