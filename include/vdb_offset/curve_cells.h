#pragma once

#include "vdb_offset/curves.h"
#include "vdb_offset/layer_facts.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// Layers on curves, filled with cells.
struct CurveCells {
  Polygons segments;  ///< Of the joined curves, as faces of two corners: what the facts and report_layers() go by.
  VolumeMesh mesh;    ///< A plane mesh.
  LayerCellFacts facts;
};

/// Fills layers with cells: over each segment a quadrilateral in each layer; where one of its points has no height,
/// triangles that meet there; where both have none, nothing. Points of one place give one point in each layer, flat
/// ones a single one. Points: those of the wall in the order of the curves' points, then the same for each layer
/// without the flat ones. Cells: layer by layer from the wall, in the order of segments. Patches: "wall", "outer", and
/// "sides" if curves end. Fields as make_cells() has them. \throw InvalidInput as plane_of()
CurveCells make_curve_cells(CurvesView curves, const LayersResult& layers);

/// Measures those cells. \pre `cells` are those of `layers`.
LayerQuality measure_curve_cells(const CurveCells& cells, const LayersResult& layers);

/// Layers on one curve as one structured block, nk = 1: i along the curve, j from the wall outward, and i, j and the
/// plane's normal a right-handed system, in which the cells have positive areas. A closed curve is cut open at its
/// first point, which comes again as the last. Fields as make_block() has them.
/// \throw InvalidInput unless there is one curve that does not branch, or as plane_of()
StructuredBlock make_curve_block(CurvesView curves, const LayersResult& layers);

}  // namespace vdb_offset
