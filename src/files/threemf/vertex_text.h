// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "bytes/chunked_output.h"
#include "document/document.h"
#include "threemf/package.h"

namespace vdb_offset::io {

/// A model part in which the coordinates of vertices that moved are others: back in the frames of their objects. All
/// other bytes stay. `vertex_at` has the first byte of each vertex of the part; `meshes` are the part's. The pieces
/// refer to all but the meshes, and begin at a byte.
Pieces with_moved_vertices(std::string_view text, const std::vector<std::uint64_t>& vertex_at,
                           std::vector<PlacedMesh> meshes, const MovedMesh& moved, std::size_t begin = 0);

/// Appends the coordinate that an attribute of a vertex is. Returns false, and appends nothing, if it is none.
bool append_coordinate_named(std::string& text, std::string_view name, const Vec3d& position,
                             const Rounding& precision);

}  // namespace vdb_offset::io
