// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hybrid/shell_mesh.h"
#include "offset/offset_solid.h"

namespace vdb_offset::cad {

/// Which triangles stand for exact faces: those whose vertices are near to these, those whose vertices are there, none.
enum class ExactParts { Near, There, None };

/// An offset whose faces are exact where the offset mesh lies on the offsets of the source's faces, and its triangles
/// elsewhere: these are valid wherever the mesh is. Edges between exact faces are their common curves, others straight.
/// \param meshes of the shells of the request's source
OffsetCadResult hybrid_offset(const OffsetCadRequest& request, const std::vector<ShellMesh>& meshes, ExactParts parts);

}  // namespace vdb_offset::cad
