// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// Where a vertex has to go for most of the area around it to be moved by 1, each plane along its normal, though some
/// planes are not: the x with the least sum of area . |n . x - 1|. It is the smallest one on some one, two or three of
/// the planes (as of any sum of absolute values; of many planes those with the largest areas are tried).
/// \param normals of unit length, or shorter by what a plane that x has to lie in takes from them
/// \param areas of the planes, as many
/// \param longest that x may be
/// \return nothing if no such x lets planes of at least half the area be where they ought to be, to a tenth
std::optional<Vec3d> prevailing_point(std::span<const Vec3d> normals, std::span<const double> areas, double longest);

/// Calls visit(x) with the smallest x on each one, two and three of the planes n . x = 1 that meet, of the `most`
/// planes with the largest areas.
void for_each_point_on_planes(std::span<const Vec3d> normals, std::span<const double> areas, std::size_t most,
                              const std::function<void(const Vec3d& x)>& visit);

}  // namespace vdb_offset
