// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// Keeps the cells that can be reached from the inner sides of the domain's triangles without going through these:
/// fillers that make tetrahedra of all points fill holes as well.
void keep_cells_inside(const FillDomain& domain, FilledDomain& filled);

}  // namespace vdb_offset
