// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/layer_facts.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// Layers on curves, filled with cells.
struct CurveCells {
  Polygons
      segments;     ///< Segments of the joined curves, as faces of two corners; the facts and report_layers() use them.
  VolumeMesh mesh;  ///< A plane mesh.
  LayerCellFacts facts;
};

/// Fills layers with cells: over each segment a quadrilateral in each layer; where one of its points has no height,
/// triangles that meet there; where both have none, no cell. Points at one position give one point in each layer, flat
/// points a single one. Points: those of the wall in the order of the curves' points, then those of each layer, in that
/// order, without the flat ones. Cells: layer by layer from the wall, in the order of segments. Patches: "wall",
/// "outer", and "sides" if curves end. Fields as make_cells() has them. \throw InvalidInput as plane_of()
VDB_OFFSET_API CurveCells make_curve_cells(CurvesView curves, const LayersResult& layers);

/// Measures cells made by make_curve_cells(). \pre `cells` are those of `layers`.
VDB_OFFSET_API LayerQuality measure_curve_cells(const CurveCells& cells, const LayersResult& layers);

/// Makes one structured block of the layers on one curve, with nk = 1: i along the curve, j from the wall outward, and
/// i, j and the plane's normal a right-handed system, in which the cells have positive areas. A closed curve is cut
/// open at its first point, which is repeated as the last. Fields as make_block() has them. \throw InvalidInput unless
/// there is one curve that does not branch, or as plane_of()
VDB_OFFSET_API StructuredBlock make_curve_block(CurvesView curves, const LayersResult& layers);

}  // namespace vdb_offset
