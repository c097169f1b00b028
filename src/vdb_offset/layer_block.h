#pragma once

#include "vdb_offset/layers.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// Layers on a grid of quads as one structured block: i and j over the grid, k from the wall outward; its cells have
/// positive volumes. Row and column 0 are at the corner of the grid with the lowest vertex. A grid that is closed in a
/// direction, as a tube is, is cut open, and its first points come again as the last.
/// Fields: share, height and state, as make_cells() has them.
/// \throw InvalidInput as require_layers_of(), and unless the faces that carry layers are quads that make one such
/// grid, with its vertices welded.
StructuredBlock make_block(PolygonView mesh, const LayersResult& layers);

}  // namespace vdb_offset
