// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// The heights of all vertices, one set for each layer.
struct AskedHeights {
  std::vector<Distances> of_all;
  std::size_t disagreeing = 0;  // input vertices with another height than is asked for, in the layer with most of them
};
AskedHeights ask_heights(const PreparedMesh& mesh, std::span<const Distances> heights);

/// \throw InvalidInput for a mesh, heights or options of which no layers can be made
void require_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options);

/// Grows layers on a mesh whose vertices have paths to the outermost height.
/// \param foot see LayersResult
LayersResult grow_marched(const PreparedMesh& mesh, const AskedHeights& asked, PreparedMesh::Marched marched,
                          CellRules rules, std::span<const std::uint32_t> foot = {});

}  // namespace vdb_offset
