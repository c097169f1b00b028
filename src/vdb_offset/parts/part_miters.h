// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vdb_offset/parts/mesh_parts.h"
#include "vdb_offset/paths/miters.h"

namespace vdb_offset {

/// The miters of the moving part's vertices by their numbers among the vertices of parts.surface(). Sorted by vertex.
std::vector<Miter> miters_of_all(const MeshParts& parts, std::vector<Miter> of_part);

}  // namespace vdb_offset
