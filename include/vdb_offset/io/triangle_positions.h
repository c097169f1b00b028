// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// Where a mesh's vertices stand in a file of its triangles alone, as STL is written of it: three vertices for each,
/// face by face. Vertices of no face are where they are in the mesh. None if these are not its triangles, or if the
/// corners of a vertex are apart.
VDB_OFFSET_API std::optional<std::vector<Vec3d>> positions_in_triangles(PolygonView mesh, PolygonView triangles);

}  // namespace vdb_offset::io
