// SPDX-License-Identifier: Apache-2.0
#include "products/periodic/mesh_borders.h"

#include "ground/mesh/single_edges.h"
#include "space/surface/surface.h"

namespace vdb_offset {

MeshBorders::MeshBorders(PolygonView mesh) : first(weld_by_position(mesh, {})) {
  for (const SingleEdge& edge : find_single_edges(mesh, first)) {
    const bool is_forward = first[mesh.corners[edge.corner]] == edge.a;
    edges.insert(is_forward ? std::array{edge.a, edge.b} : std::array{edge.b, edge.a});
    for (const std::uint32_t v : {edge.a, edge.b}) number.try_emplace(v, 0);
  }
  for (auto& [v, i] : number) {
    i = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(v);
    points.push_back(mesh.positions[v]);
  }
}

}  // namespace vdb_offset
