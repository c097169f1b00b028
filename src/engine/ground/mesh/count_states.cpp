// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/count_states.h"

namespace vdb_offset {

void count_states(std::span<const VertexState> states, OffsetStatistics& statistics) {
  for (const VertexState state : states) ++statistics.vertices_by_state[static_cast<std::size_t>(state)];
}

}  // namespace vdb_offset
