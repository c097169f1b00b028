// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/vec.h"

namespace vdb_offset {

/// A plane: all x with normal . x = offset; the normal has unit length.
struct VDB_OFFSET_API SymmetryPlane {
  Vec3d normal{0.0};
  double offset = 0;

  /// Signed height of a position above the plane, world units.
  double height(const Vec3d& x) const;
};

struct SymmetryOptions {
  bool find = true;  ///< Borders stay in the planes that they lie in.
  std::vector<SymmetryPlane>
      planes;  ///< World coordinates. All vertices on one of these stay in it, whatever is around them.
};

}  // namespace vdb_offset
