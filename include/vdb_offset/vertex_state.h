// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// What became of a vertex.
enum class VertexState : std::uint8_t {
  Reached,       ///< Its exact distance is the target's, to 1e-6 of it and the rounding of the coordinates.
  Collision,     ///< Stopped short where the distance grows no further: at the medial axis, or closed in.
  Limited,       ///< Held back to keep the result valid.
  OutsideField,  ///< Left the voxels that the field covers before it arrived.
  Unused,        ///< In no face; it stays where it is.
};

inline constexpr std::size_t kVertexStateCount = 5;

VDB_OFFSET_API const char* name(VertexState state);

/// A vertex has reached its distance if it is off by no more than this share of the distance. Rounding of coordinates
/// to seven digits is allowed for apart. Not measured: small beside what a mesh is off between its vertices.
inline constexpr double kReachedTolerance = 1e-6;

}  // namespace vdb_offset
