// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ground/system/progress_count.h"
#include "products/layers/layer_wall.h"
#include "products/layers/surface_layer_grower.h"

namespace vdb_offset {

/// Grows layers for stack_layers() and stack_curves(), in rounds: thins them, and lets them out again, until all cells
/// are valid and the outermost surface has no fault.
/// \param wall with stacks that nothing has been done to yet; they are taken from it
/// \param paths of the vertices; receive what became of the outermost surface
/// \param unspread see stack_layers()
LayerStack grow_on(LayerWall& wall, Paths& paths, std::span<const Vec3d> unspread, Progress& progress);

}  // namespace vdb_offset
