// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "vdb_offset/result.h"

namespace vdb_offset {

/// Adds the numbers of vertices in each state to the statistics.
void count_states(std::span<const VertexState> states, OffsetStatistics& statistics);

}  // namespace vdb_offset
