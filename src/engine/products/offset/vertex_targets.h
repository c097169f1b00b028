// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vdb_offset/numbers.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Where the vertices of a mesh go, in place of the ends of paths that would be found for them.
struct VertexTargets {
  std::vector<Vec3d> displacement;  ///< Of each vertex of the input, world units.
  std::vector<VertexState> state;   ///< What each is there: Mitered, Cut, or why it falls short, if it does.
  double vertex_error = 0;          ///< See ConstrainedSurface.
};

}  // namespace vdb_offset
