#pragma once

#include <span>

#include "vdb_offset/statistics.h"

namespace vdb_offset {

/// Adds up what became of vertices.
void count_states(std::span<const VertexState> states, OffsetStatistics& statistics);

}  // namespace vdb_offset
