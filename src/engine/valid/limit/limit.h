// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "motion/paths/miters.h"
#include "motion/paths/propagate.h"
#include "valid/faults/fault_finder.h"
#include "valid/untangle/warm_start.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// An offset of a constrained surface, which limit() makes valid.
struct SurfaceOffset {
  const ConstrainedSurface& constrained;
  std::span<const Vec3d> source;  ///< Positions of the constrained surface's vertices in the input, world coordinates.
  const Distances& distances;     ///< Of these vertices.
  Paths& paths;                   ///< Of these vertices; displacement 0 of those that are not on the moving part.
  MiteredPaths* mitered = nullptr;  ///< Of these vertices, if any are mitered.
  bool keeps_faces = false;  ///< Faces are to be at the distance: no vertex slides where that loses more of them.
  double taper = 0;          ///< See OffsetOptions::taper.
  /// Faces from this one on lie over ridges: their vertices count as on creases.
  std::uint32_t first_over_ridges = kNone;
};

/// Makes a result valid: no inverted face, no collapsed one, no pair of triangles that meet anew (see fault_finder.h
/// for what counts as a fault).
///
/// Steps, each of which makes less invalid or gives more distance back (limit.cpp calls them in this order):
/// 1. Untangling (PatchUntangler): patches of vertices around faults slide at their distance until they have no fault.
///    That costs no distance. Collided vertices slide to where they have their distance in the same way.
/// 2. Pulling back (pull_back()): displacements of vertices of faulty faces are shortened, little by little, until
///    there is no fault, beginning with those of vertices with which little live area is lost; mitered vertices get the
///    paths back first that they had before. A surface that is pulled back
///    altogether is the source, so that this ends.
/// 3. Letting out (LetOut): pulled vertices are let out again as far as no fault arises, a few at a time.
/// 4. Returning (ReturnToFaces), before and after settling: vertices go where there is room and the faces around them
///    are nearest to the distance; with round corners those that are short, with miters also those that have slid
///    aside.
/// 5. Settling (Settling): short vertices are put where there is room, if less is lost with what goes back for that.
/// 6. Contracting (Contraction): what is short yet is put beside neighbours that are at the distance.
/// 7. Fading (Fading): what is beside short vertices comes nearer, where thickness would change too fast.
/// 8. Pulling back once more, should a face that was put back be judged otherwise than before.
/// With `started_from`, patches that were moved in that offset and are faulty here start from there, and patches that
/// could not be freed there are not tried again.
///
/// Vertices that are short in the end are `Limited`, with the distance that they have. `faults` has been made of this
/// offset, and has its vertices at the ends of the paths. `starts`, if it is not null, gets what becomes of this
/// offset. The result does not depend on the number of threads.
/// \pre each vector of `offset.paths`, and of `started_from`, has a value for each vertex
LimitStatistics limit(FaultFinder& faults, const SurfaceOffset& offset, const ProgressCallback& progress = {},
                      const WarmStart* started_from = nullptr, WarmStart* starts = nullptr);

/// The first step of limit() alone: nothing is pulled back, and faults may be left.
LimitStatistics untangle(FaultFinder& faults, const SurfaceOffset& offset, const ProgressCallback& progress = {});

}  // namespace vdb_offset
