// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "products/cells/measure_cells.h"
#include "products/cells/number_cells.h"
#include "vdb_offset/cells.h"

namespace vdb_offset {

/// Makes cells that have been numbered and measured (see cells.h). \pre `cells` are those of `layers`, and
/// `quality` is that of `cells`. \throw InvalidInput as require_names()
VolumeMesh make_cells(const LayersResult& layers, const LayerCells& cells, const WallNames& names,
                      LayerQuality quality);

}  // namespace vdb_offset
