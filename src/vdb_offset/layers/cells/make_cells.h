#pragma once

#include "vdb_offset/layers/cells/measure_cells.h"
#include "vdb_offset/layers/cells/number_cells.h"
#include "vdb_offset/volume/volume_mesh.h"

namespace vdb_offset {

/// Fills layers with cells. Over each face that carries layers stands one in each: a prism on a triangle, a hexahedron
/// on a quad, a polyhedron on more corners; on a quad in two triangles (LayersResult::carries), two prisms. Vertices
/// that are welded give one point in each layer; one whose positions are those of the wall in all layers (a flat one)
/// gives a single point, and the cells there are the cones, from that point, over the sides that do not hold it:
/// pyramids and tetrahedra; over a quad with two flat corners in a row, a prism on its side. All faces match those of
/// the neighbours and of the layers below and above; every one that a single cell has is in one patch. Where the cells
/// of an edge cannot be paired, two by two and of opposite directions (on edges of three faces, or where faces disagree
/// about the outside), what is left over has its face in the patch of sides; points there are split, so that these
/// faces are not those of other cells as well. Sides that hang together belong to one opening, which has a patch of its
/// own; of more than 64 the smallest share the last.
///
/// Points: those of the wall in the order of the mesh's vertices, split ones behind them; then the same for each layer
/// without the flat ones. Cells: layer by layer from the wall, in the order of faces. Patches: one for each of
/// patch_names(), which may have no faces, "outer", and "sides" if the surface has an opening, or "sides_1", "sides_2"
/// ... if it has several. Point fields: layer (0: wall), share, height (asked of the point, world units, signed),
/// achieved, state (of VertexState). Cell fields: layer (from 1), face (of the input; exact up to 2^24), patch,
/// scaled_jacobian, aspect_ratio. The result does not depend on the number of threads. Cost: O(cells).
///
/// \pre `cells` are those of `layers`, and `quality` is theirs. \throw InvalidInput as require_names()
VolumeMesh make_cells(const LayersResult& layers, const LayerCells& cells, const WallNames& names,
                      LayerQuality quality);

/// The same from the mesh.
/// \throw InvalidInput as number_cells() and require_names()
VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                      LayerCellFacts* facts = nullptr);

}  // namespace vdb_offset
