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
/// refer to all but the meshes.
Pieces with_moved_vertices(std::string_view text, const std::vector<std::uint64_t>& vertex_at,
                           std::vector<PlacedMesh> meshes, const MovedMesh& moved);

}  // namespace vdb_offset::io
