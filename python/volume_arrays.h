// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arrays.h"
#include "vdb_offset/cells.h"

namespace vdb_offset::python {

/// A volume mesh as VTK names its parts: `points` (n, 3); `cells`, one-dimensional: of each cell the length of what
/// follows, and its points (of a polyhedron the number of faces, and of each the number of points and these); and
/// `cell_types`, VTK's numbers. `point_data` and `cell_data` are arrays by name; `patches` are the faces of the
/// boundary by name, each a pair of offsets and points.
py::dict volume_as_dict(VolumeMesh mesh);

/// A structured block: `points`, (nk, nj, ni, 3), and `point_data`, (nk, nj, ni) arrays by name.
py::dict block_as_dict(StructuredBlock block);

}  // namespace vdb_offset::python
