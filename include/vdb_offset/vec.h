// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/math/Vec2.h>
#include <openvdb/math/Vec3.h>

#include <cstdint>
#include <limits>

namespace vdb_offset {

using openvdb::math::Vec2d;
using openvdb::math::Vec3d;

/// The number of no vertex, face or other thing.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace vdb_offset
