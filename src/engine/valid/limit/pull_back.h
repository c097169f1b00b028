// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "valid/limit/limit_state.h"

namespace vdb_offset {

/// Share of its whole displacement below which a vertex is pulled back altogether. Reasoned: it is small, as the skins
/// of a shell touch where a vertex has not moved at all.
inline constexpr double kLastShare = 1e-4;

/// Pulls vertices of faulty faces a step back towards their source. To be called until it returns false: then no fault
/// is left, or no vertex of a fault has any displacement left. That ends, as a surface that is pulled back altogether
/// is the source. limit() pulls back once patches are untangled, and again at the end.
bool pull_back(LimitState& state);

/// The vertices that pull_back() pulls: of each fault's corners those with which little live area is lost, and those
/// that have gone far back already. Of faults of a rim, and of misplaced vertices, all. `pinned` is left out; kNone: no
/// vertex is.
Indices vertices_to_pull(LimitState& state, std::uint32_t pinned = kNone);

}  // namespace vdb_offset
