// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "products/curves/curve_faults.h"
#include "products/layers/surface_layer_grower.h"

namespace vdb_offset {

/// Stacks layers between the points of plane curves and the ends of their paths, as stack_layers() does for surfaces.
/// No segment of the outermost curve is inverted, collapsed or crossing another (see limit_curves()). Cells are
/// quadrilaterals over the segments; at a point without any height, triangles. All of their corners turn the right way,
/// and the sine of the angle between the sides of a cell is at least 1e-3. The result does not depend on the number of
/// threads.
/// \param heights of the polyline's vertices, one set for each layer
/// \param faults of `curves`; receives those of the outermost curve
/// \param paths of the polyline's vertices; receive what became of the outermost curve
/// \return stacks whose positions are in the plane, all of one z
LayerStack stack_curves(const PlaneCurves& curves, std::span<const Distances> heights, CurveFaults& faults,
                        Paths& paths, const ProgressCallback& progress = {});

}  // namespace vdb_offset
