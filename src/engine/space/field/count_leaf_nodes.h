// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/surface/surface.h"
#include "vdb_offset/options.h"

namespace vdb_offset {

/// Estimates the number of leaf nodes within reach of a surface, on each of its sides. They are counted if there are
/// not too many. Else larger cells are counted: those that reach fills are full of leaf nodes; where they are wider
/// than the reach, they hold a sheet of them, or as many as the area of the surface gives. \param leaf the width of a
/// leaf node, world units \param slab the surface is a ribbon, and the grid one leaf node thick
double count_leaf_nodes(const Surface& surface, const Reach& reach, double leaf, bool slab);

}  // namespace vdb_offset
