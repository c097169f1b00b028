// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// For each of some points the nearest of others that is no farther away than a tolerance; kNone where there is none.
/// Of several at one distance the first counts.
std::vector<std::uint32_t> match_points(std::span<const Vec3d> points, std::span<const Vec3d> others, double tolerance);

}  // namespace vdb_offset
