// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/openmesh.h"

namespace vdb_offset {

template Polygons to_polygons(const Mesh& mesh);
template Mesh to_mesh(PolygonView polygons);
template OffsetResult offset(Mesh& mesh, const OffsetOptions& options);

}  // namespace vdb_offset
