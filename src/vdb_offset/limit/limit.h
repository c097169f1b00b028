#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/limit/warm_start.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/statistics.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {

/// Makes a result valid: no inverted face, no collapsed one, no pair of triangles that meet anew.
///
/// What counts as wrong is told in fault_finder.h. Where a precedent is followed, patches that were mended there, and
/// in which something is wrong here, begin with what became of them; what could not be freed there is not tried again.
/// Then patches around what is wrong are untangled (Untangler), small ones, then larger ones and with smoother normals,
/// and a patch keeps that where it makes nothing worse. That costs no distance; what has collided slides to where it
/// has its distance in the same way, if there is such a place near. Then vertices of a face that is wrong are pulled
/// back towards where they came from, by a little in each round, until nothing is wrong: those with which little area
/// is lost that has room (LiveArea), and the others only where these do not help. Then those that were are let out
/// again as far as nothing goes wrong, a few at a time by leaps; what was stopped by what has not moved since does not
/// try the same again. What is short still, though there is room beside it, is put there, one vertex at a time, if less
/// is lost with what goes back for that. A surface pulled back altogether is the source, so that it ends. Last,
/// vertices around the pulled ones follow these, where thickness would else change by more than twice the way from one
/// to the other, as far as nothing goes wrong, and unless far more area is around them. Pulled vertices are `Limited`,
/// with the distance that they keep.
///
/// `source` holds where the body's vertices stand in the input, world coordinates; `distances` and `paths` are theirs,
/// and who is not on the front has no way to go. `faults` looks at the same, and has looked at the paths' ends.
/// `set` is told what becomes of this offset. The result does not depend on the number of threads.
LimitStatistics limit(FaultFinder& faults, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                      const Distances& distances, Paths& paths, const ProgressCallback& progress = {},
                      const WarmStart* followed = nullptr, WarmStart* set = nullptr);

/// The untangling of that alone: nothing is pulled back. Faults may be left.
LimitStatistics untangle(FaultFinder& faults, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                         const Distances& distances, Paths& paths, const ProgressCallback& progress = {});

}  // namespace vdb_offset
