// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Diagonal of the bounding box of the vertices that faces use, which percentages of a distance refer to.
VDB_OFFSET_API double used_diagonal(PolygonView mesh);

/// Unit normals of the mesh's vertices, outward: of the welded surface and weighted by angles, as the offset itself
/// takes them. Zero for a vertex that no face uses, and where the faces around have no normals or these cancel out.
/// \throw InvalidInput as build_surface()
VDB_OFFSET_API std::vector<Vec3d> vertex_normals(PolygonView polygons, const WeldOptions& weld = {},
                                                 Orient orient = Orient::Keep);

}  // namespace vdb_offset
