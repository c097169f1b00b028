// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Offsets a mesh: its vertices and faces stay, and each vertex gets a position at `distance` from the surface, or one
/// as near to that as its state says. The faces need not be manifold, closed or oriented. The result does not depend on
/// the number of threads. Concurrent calls are independent of each other. \throw InvalidInput for a mesh or an option
/// that cannot be used, OutOfBudget before work that would not fit, Cancelled when the progress callback asks for it.
VDB_OFFSET_API OffsetResult offset(PolygonView mesh, const OffsetOptions& options);

/// Makes several offsets of one mesh, for little more than one: one field and one march serve all. `options.distance`
/// has no effect. Directions are smoothed as for the farthest distance, and with Collision::Limit nearer offsets that
/// have to be mended start from the finished farthest offset on their side (see warm_start.h): there, an offset made
/// alone may have other positions. Results are in the order of `distances`.
VDB_OFFSET_API std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                                        const OffsetOptions& options);

/// Tells what offset() would do, without doing it: the mesh's facts and the plan of the grid.
VDB_OFFSET_API OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options);
/// Tells what offset_several() would do, or grow_layers() to the only distance with so many layers, without doing it:
/// the mesh's facts and the plan of the grid.
VDB_OFFSET_API OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances,
                                             const OffsetOptions& options, std::size_t layers = 0);

/// Makes room between a mesh and another one: parts of the mesh that are nearer to the other than `clearance` (world
/// units, above 0) go inward until they are that far away, including faces between vertices; the rest stays. A flat
/// face between sharp edges goes as a whole, so that it stays flat, and corners go to where the moved faces and those
/// that stay meet, as with Corners::Miter. If the
/// other mesh is a solid, parts inside of it are too near by their depth, whichever way its faces point; if it is not,
/// each side of it is outside.
///
/// Each round is an offset in which flat faces, and the vertices of curved ones, go inward by what they lack: the
/// nearest point of a triangle that is too near is a weighted mean of its corners, and each corner goes farther by its
/// weight. Where several faces meet, those go for which that helps. How much the gap grows tells how far to go in the
/// next round. Rounds end when nothing is too near, or the gap no longer grows: where the mesh is too thin, or inward
/// does not lead away from the other mesh. The best round is the result; its `distances` are those that were needed,
/// and its `statistics.fit` tells the gap that is left.
///
/// Of the options, `distance`, `corners`, `obstacles`, `clearance`, `metric` and those of shells have no effect. \throw
/// InvalidInput as offset(), and for a clearance that is not above 0 or another mesh without faces.
VDB_OFFSET_API OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options);
/// Reports what fit() would do in its first round, without doing it: the mesh's facts, the plan of the grid (without
/// voxels where nothing is too near), and in `fit` the gap, what is nearer than the clearance, and how far parts have
/// to go. \throw as fit()
VDB_OFFSET_API OffsetStatistics plan_fit(PolygonView mesh, PolygonView other, double clearance,
                                         const OffsetOptions& options);

}  // namespace vdb_offset
