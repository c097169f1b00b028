#pragma once

#include "vdb_offset/offset.h"

namespace vdb_offset {

/// Makes room between a mesh and another one: those parts of the mesh that are nearer to the other than `clearance`
/// (world units, above 0) go inward until they are that far away, faces between vertices, too; all else stays. If the
/// other mesh is a solid, what is inside of it is too near by its depth, whichever way its faces point; if it is not,
/// each side of it is outside.
///
/// An offset, each vertex by what its faces lack: the nearest point of a face that is too near lies at some share of
/// each corner, which goes as much farther inward. What that offset gains tells how much farther to go in the next
/// one, until nothing is too near, or nothing gains any more: what cannot leave, as the mesh is too thin there, or
/// inward does not lead away from the other mesh. What comes nearest to the wish is handed out. The result's
/// `distances` are those that were needed, its `statistics.fit` tells what is left between.
///
/// Of the options, `distance`, `obstacles`, `clearance`, `metric` and those of shells do not count. \throw InvalidInput
/// as offset(), and for a clearance that is not above 0 or another mesh without faces.
OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options);

}  // namespace vdb_offset
