// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "products/cells/number_cells.h"
#include "vdb_offset/cells.h"

namespace vdb_offset {

/// Measures the cells of columns without making them. Where prisms stand on each other, each triangle is looked at
/// once, for the prism above and the one below it, in four columns at once. The result does not depend on the number of
/// threads. Cost: O(cells). \pre `cells` are those of `layers`.
LayerQuality measure_cells(const LayersResult& layers, const LayerCells& cells);

}  // namespace vdb_offset
