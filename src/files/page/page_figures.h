// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "vdb_offset/io/view_file.h"

namespace vdb_offset::io {

/// The share of what was asked that each vertex has; NaN where nothing was, or nothing is known.
std::vector<float> shares_of(const PageSurface& surface, std::size_t vertices);

/// How many vertices have each share: `below`, in equal steps from 0 to 1; `at` it; and `above`, in steps of a quarter
/// with all that is farther in the last.
nlohmann::json histogram_of_shares(std::span<const float> shares, std::span<const VertexState> states);

/// How many cells have each scaled Jacobian: `invalid`, 0 or below, and in equal steps from 0 to 1.
nlohmann::json histogram_of_quality(std::span<const float> scaled_jacobian);

/// Vertices by state, in the states' order.
nlohmann::json counts_of_states(std::span<const VertexState> states);

}  // namespace vdb_offset::io
