// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/offset.h"

namespace vdb_offset {

/// Makes room between a mesh and another one: parts of the mesh that are nearer to the other than `clearance` (world
/// units, above 0) go inward until they are that far away, including faces between vertices; the rest stays. If the
/// other mesh is a solid, parts inside of it are too near by their depth, whichever way its faces point; if it is not,
/// each side of it is outside.
///
/// Each round is an offset in which each vertex goes inward by what its faces lack: the nearest point of a face that is
/// too near is a weighted mean of its corners, and each corner goes farther by its weight. How much the gap grows tells
/// how far to go in the next round. Rounds end when nothing is too near, or the gap no longer grows: where the mesh is
/// too thin, or inward does not lead away from the other mesh. The best round is the result; its `distances` are those
/// that were needed, and its `statistics.fit` tells the gap that is left.
///
/// Of the options, `distance`, `obstacles`, `clearance`, `metric` and those of shells have no effect. \throw
/// InvalidInput as offset(), and for a clearance that is not above 0 or another mesh without faces.
VDB_OFFSET_API OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options);

}  // namespace vdb_offset
