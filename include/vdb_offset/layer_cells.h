// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "vdb_offset/api.h"
#include "vdb_offset/layer_facts.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/patch_names.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

struct LayerCells;

/// Fills layers with cells. Over each face that carries layers stands one cell in each layer: a prism on a triangle, a
/// hexahedron on a quad, a polyhedron on more corners; on a quad in two triangles (LayersResult::carries), two prisms.
/// Vertices that are welded give one point in each layer. A flat vertex, which is at its position on the wall in all
/// layers, gives a single point, and the cells there are the cones from that point over the sides that do not hold it:
/// pyramids and tetrahedra; over a quad with two flat corners in a row, a prism on its side. All faces match those of
/// the neighbours and of the layers below and above; every face that a single cell has is in one patch. Where the cells
/// at an edge cannot be paired, two by two and of opposite directions (on edges of three faces, or where faces disagree
/// about the outside), the faces of unpaired cells are in the patch of sides; points there are split, so that no other
/// cell has these faces as well. Sides that are connected belong to one opening, which has a patch of its own; of more
/// than 64 openings the smallest share the last patch.
///
/// Points: those of the wall in the order of the mesh's vertices, split points behind them; then those of each layer,
/// in that order, without the flat ones. Cells: layer by layer from the wall, in the order of faces. Patches: one for
/// each of patch_names(), which may have no faces, "outer", and "sides" if the surface has an opening, or "sides_1",
/// "sides_2"
/// ... if it has several. Point fields: layer (0: wall), share, height (asked of the point, world units, signed),
/// achieved, state (of VertexState). Cell fields: layer (from 1), face (of the input; exact up to 2^24), patch,
/// scaled_jacobian, aspect_ratio. The result does not depend on the number of threads. Cost: O(cells).
///
/// \throw InvalidInput for faces that are no polygons, for layers that cannot be this mesh's, by their counts and
/// positions, for more than 2^32 points or cells, and as require_names()
VDB_OFFSET_API VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                                     LayerCellFacts* facts = nullptr);

/// The cells over layers, numbered and measured, but not made: enough for a report, in a third of the memory.
class VDB_OFFSET_API MeasuredCells {
 public:
  /// Keeps a reference to `layers`. The result does not depend on the number of threads. Cost: O(cells).
  /// \throw InvalidInput as make_cells()
  MeasuredCells(PolygonView mesh, const LayersResult& layers);
  MeasuredCells(MeasuredCells&&) noexcept;
  MeasuredCells& operator=(MeasuredCells&&) noexcept;
  ~MeasuredCells();

  const LayerCellFacts& facts() const;
  const LayerQuality& quality() const { return quality_; }

  /// Makes the cells, as make_cells() does; the measures go into the mesh. \throw InvalidInput as require_names()
  VolumeMesh make(const WallNames& names) &&;

 private:
  const LayersResult* layers_;
  std::unique_ptr<LayerCells> cells_;
  LayerQuality quality_;
};

}  // namespace vdb_offset
