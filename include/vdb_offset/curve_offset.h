// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Offsets plane curves, open or closed, as offset_several() does surfaces: the points get positions at `distance` from
/// the curves in their plane, or as near to that as their states say. Which side a positive distance leads to: see
/// join_curves().
///
/// The stages are those of surfaces: a ribbon stands on the curves, its field is a slab of leaf nodes, one thick, and
/// the line half way up the ribbon is what moves. For Collision::Limit see limit_curves(). The options `only`,
/// `border`, `obstacles`, `off_source`, `weld` and `orient` have no effect; in the facts of the mesh, "faces" are
/// segments. \throw InvalidInput for curves that do not lie in one plane or an option that cannot be used, OutOfBudget
/// before work that would not fit, Cancelled when the progress callback asks for it.
VDB_OFFSET_API std::vector<OffsetResult> offset_curves(CurvesView curves, std::span<const Distances> distances,
                                                       const OffsetOptions& options);

/// Grows layers on curves, as grow_layers() does on a mesh: one march goes to the outermost layer, which is made valid
/// as with Collision::Limit, and stack_curves() puts the others in between. For their cells see make_curve_cells().
/// \throw InvalidInput as grow_layers() and offset_curves().
VDB_OFFSET_API LayersResult grow_curve_layers(CurvesView curves, std::span<const Distances> heights,
                                              const OffsetOptions& options);

/// Layers on curves whose sharp corners are opened into fans.
struct VDB_OFFSET_API FannedCurveLayers {
  /// The curves with their opened corners, points of which stand off the source by 1e-9 of the thickness, so that
  /// copies can be told apart: what cells are made on. Not set where no corner is opened.
  std::optional<Curves> wall;
  LayersResult layers;  ///< Of the wall's points, at their places in the source; without a wall, of the curves'.
};

/// grow_curve_layers() with fans of cells at sharp convex corners, as at a trailing edge: see grow_fanned_layers(). In
/// the first layer of a fan there are triangles. \throw InvalidInput as both
VDB_OFFSET_API FannedCurveLayers grow_fanned_curve_layers(CurvesView curves, std::span<const Distances> heights,
                                                          const OffsetOptions& options, double angle);

/// Plans what offset_curves() would do, or grow_curve_layers() if there are layers, without doing it. \throw as
/// offset_curves()
VDB_OFFSET_API OffsetStatistics plan_curves(CurvesView curves, std::span<const Distances> distances,
                                            const OffsetOptions& options, std::size_t layers = 0);

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

/// Measures `positions` as an offset of plane curves, as check_offset() does for meshes, with segments for faces, and
/// the faults that limit_curves() looks for (see CurveFaults). Welding and orientation have no effect. \throw
/// InvalidInput for curves that do not lie in one plane or have no segment, and for positions that are not one for each
/// of their points, not finite, or not in that plane; Cancelled when the progress callback asks for it.
VDB_OFFSET_API CheckResult check_curves(CurvesView source, std::span<const Vec3d> positions,
                                        const CheckOptions& options = {});

}  // namespace vdb_offset
