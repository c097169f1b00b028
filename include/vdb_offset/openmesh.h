#pragma once

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Double-precision positions: a float would lose the exact distance.
struct MeshTraits : OpenMesh::DefaultTraitsDouble {};

/// The half-edge mesh that the library takes and gives; polygons of any size.
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<MeshTraits>;

/// The mesh's vertices and faces in handle order. \pre no deleted elements (call garbage_collection() first).
Polygons to_polygons(const Mesh& mesh);

/// An OpenMesh with the same vertices and faces in the same order.
/// \throw InvalidInput if a face cannot be added to a half-edge mesh (non-manifold or wrongly oriented).
Mesh to_mesh(PolygonView polygons);

/// The same as offset() for a half-edge mesh, whose points are replaced. \pre no deleted elements.
OffsetResult offset(Mesh& mesh, const OffsetOptions& options);

}  // namespace vdb_offset
