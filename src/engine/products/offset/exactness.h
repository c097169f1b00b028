// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// How exactly the vertices of a result that are said to be there are at their distances from the model's faces: from
/// those that a vertex is on, where it goes along their normals or to their miter; else from the face that it is
/// nearest to. One that is nearest to a sharp edge, as at a round corner, has its distance from that, and does not
/// count. \pre mesh.exact()
ExactFacts measure_exactness(const PreparedMesh& mesh, const PreparedMesh::Marched& marched,
                             const OffsetResult& result);

}  // namespace vdb_offset
