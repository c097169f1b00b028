// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// Makes one structured block of the layers on a grid of quads: i and j over the grid, k from the wall outward. All
/// cells but inverted_cells() have positive volumes. Row and column 0 are at the corner of the grid with the lowest
/// vertex. A grid that is closed in a direction, as a tube is, is cut open, and its first points are repeated as the
/// last. Point fields: share, height and state, as make_cells() has them. \throw InvalidInput as require_layers_of(),
/// and unless the faces that carry layers are quads that make one such grid, with its vertices welded.
VDB_OFFSET_API StructuredBlock make_block(PolygonView mesh, const LayersResult& layers);

/// Counts a block's hexahedra whose scaled Jacobian (cell_quality.h) is not above 0: cells of no height where layers
/// end, which a block cannot leave out, and cells on quads that would otherwise carry two prisms. \pre nk > 1
VDB_OFFSET_API std::size_t inverted_cells(const StructuredBlock& block);

}  // namespace vdb_offset
