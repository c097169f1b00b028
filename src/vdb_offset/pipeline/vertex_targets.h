// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/numbers.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

/// Where vertices of a mesh are to go, in place of the ends of the paths that would be found for them.
struct VertexTargets {
  std::vector<Vec3d> displacement;  ///< Of each vertex of the input, world units.
  std::vector<VertexState> state;   ///< Reached, Mitred or Cut there; any other state where it has no target.

  bool has(std::size_t vertex) const {
    return state[vertex] == VertexState::Reached || state[vertex] == VertexState::Mitred ||
           state[vertex] == VertexState::Cut;
  }
};

}  // namespace vdb_offset
