// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vdb_offset/options.h"
#include "vdb_offset/parts/mesh_parts.h"
#include "vdb_offset/paths/miters.h"

namespace vdb_offset {

/// The planes that the edge of a part slides in with its miters, of the moving part's vertices: those of the faces that
/// stay around a vertex, where these are flat and not in the plane of the part. Empty unless the edge slides.
std::vector<MiterWalls> walls_at_edge(const MeshParts& parts, Border border);

/// The miters of the moving part's vertices by their numbers among the vertices of parts.surface(). Sorted by vertex.
std::vector<Miter> miters_of_all(const MeshParts& parts, std::vector<Miter> of_part);

}  // namespace vdb_offset
