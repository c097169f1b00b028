#pragma once

#include <span>
#include <vector>

#include "vdb_offset/mesh_measures.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Offsets a mesh: the same vertices and faces, each vertex at `distance` from the surface or as near to that as
/// its state says. The faces need not be manifold, closed or oriented; only the positions are new.
/// The result does not depend on the number of threads. Concurrent calls are independent of each other.
/// \throw InvalidInput for a mesh or an option that cannot be used, OutOfBudget before work that would not fit,
/// Cancelled when the progress callback asks for it.
OffsetResult offset(PolygonView mesh, const OffsetOptions& options);

/// Several offsets of one mesh, for little more than one: one field and one march serve all. `options.distance` does
/// not count. Directions are smoothed as for the farthest, and with Collision::Limit nearer offsets begin, where they
/// have to be mended, with what became of the farthest on their side (see warm_start.h): there, one alone may end up
/// elsewhere. Answers come in the order of `distances`.
std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                         const OffsetOptions& options);

/// What offset() would do, without doing it: the mesh's facts and the plan of the grid.
OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options);
/// The same for offset_several(), or for grow_layers() to the only distance, with so many layers.
OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options,
                              std::size_t layers = 0);

}  // namespace vdb_offset
