// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "vdb_offset/api.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Traits with double-precision positions: a float would lose the exact distance.
struct MeshTraits : OpenMesh::DefaultTraitsDouble {};

/// The half-edge mesh that the library takes and gives; polygons of any size.
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<MeshTraits>;

/// Copies the mesh's vertices and faces in the order of their handles. \pre no deleted elements (call
/// garbage_collection() first).
VDB_OFFSET_API Polygons to_polygons(const Mesh& mesh);

/// Makes an OpenMesh with these vertices and faces, in their order.
/// \throw InvalidInput if a face cannot be added to a half-edge mesh (non-manifold or wrongly oriented).
VDB_OFFSET_API Mesh to_mesh(PolygonView polygons);

/// Offsets a half-edge mesh by offset(), and replaces its points. \pre no deleted elements.
VDB_OFFSET_API OffsetResult offset(Mesh& mesh, const OffsetOptions& options);

}  // namespace vdb_offset
