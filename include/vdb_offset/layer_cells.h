#pragma once

#include <memory>

#include "vdb_offset/layer_facts.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/patch_names.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

struct LayerCells;

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
/// \throw InvalidInput for polygons that are none, for layers that cannot be this mesh's, by their counts and places,
/// for more than 2^32 points or cells, and as require_names()
VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                      LayerCellFacts* facts = nullptr);

/// The cells over layers, numbered and measured, but not yet made: what a report needs, for a third of the memory.
class MeasuredCells {
 public:
  /// Keeps a reference to `layers`. The result does not depend on the number of threads. Cost: O(cells).
  /// \throw InvalidInput as make_cells()
  MeasuredCells(PolygonView mesh, const LayersResult& layers);
  MeasuredCells(MeasuredCells&&) noexcept;
  MeasuredCells& operator=(MeasuredCells&&) noexcept;
  ~MeasuredCells();

  const LayerCellFacts& facts() const;
  const LayerQuality& quality() const { return quality_; }

  /// As make_cells(); what was measured goes into the mesh. \throw InvalidInput as require_names()
  VolumeMesh make(const WallNames& names) &&;

 private:
  const LayersResult* layers_;
  std::unique_ptr<LayerCells> cells_;
  LayerQuality quality_;
};

}  // namespace vdb_offset
