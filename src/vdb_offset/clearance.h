#pragma once

#include <array>
#include <cstdint>

#include "vdb_offset/body.h"
#include "vdb_offset/box_tree.h"

namespace vdb_offset {

/// Three corners.
using TriangleCorners = std::array<Vec3d, 3>;

/// Distance between two triangles, 0 if they meet.
double distance_between(const TriangleCorners& a, const TriangleCorners& b);

/// Finds what comes nearer to obstacles than may be, not at its vertices alone.
class ClearanceFinder {
 public:
  /// Keeps a reference.
  explicit ClearanceFinder(const Obstacles& obstacles);

  /// Whether a triangle, in the obstacles' frame, is nearer to any of them than the clearance by more than 1e-6 of it.
  bool is_crowded(const TriangleCorners& triangle) const;

 private:
  const Obstacles& obstacles_;
  BoxTree tree_;
};

}  // namespace vdb_offset
