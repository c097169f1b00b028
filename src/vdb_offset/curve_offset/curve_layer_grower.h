#pragma once

#include <span>

#include "vdb_offset/curve_offset/curve_faults.h"
#include "vdb_offset/layers/surface_layer_grower.h"

namespace vdb_offset {

/// What stack_layers() does, for plane curves: stacks layers between their points and where these ended up, of which
/// `paths` tells, with no segment of the outermost curve inverted, collapsed or crossing another (see limit_curves()).
/// `heights` are those of the points, one set for each layer. Cells are quadrilaterals over the segments; at a point
/// without any height, triangles. None has a corner that does not turn the right way, nor a layer an angle with the
/// layer below whose sine is under 1e-3. `paths` receives what became of the outermost curve, and `faults`, of
/// the same curves, what is wrong with it still; places of the stacks are in the plane, all of one z. The result does
/// not depend on the number of threads.
LayerStack stack_curves(const PlaneCurves& curves, std::span<const Distances> heights, CurveFaults& faults,
                        Paths& paths, const ProgressCallback& progress = {});

}  // namespace vdb_offset
