// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/grid.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Estimates the number of leaf nodes within reach of a surface, on each of its sides. If there are not too many, they
/// are counted; else larger cells are, and each is taken to hold a sheet of leaf nodes, or as many as the area of the
/// surface gives. \param leaf the width of a leaf node, world units \param slab the surface is a ribbon, and the grid
/// one leaf node thick
double count_leaf_nodes(const Surface& surface, const Reach& reach, double leaf, bool slab);

}  // namespace vdb_offset
