// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "vdb_offset/api.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/refinement.h"

namespace vdb_offset {

/// How far the faces of an offset may be off their distance.
struct VDB_OFFSET_API Tolerance {
  double share = 0;   ///< Of the distance at each point, above 1e-5 and below 1; or 0, and
  double length = 0;  ///< world units, above 1e-5 of the largest distance.
  /// No more are made, but for the pieces of faces that vertices hang on; 0: 20 times as many as the mesh has, at least
  /// a million.
  std::size_t most_faces = 0;
  /// What the file that the refined mesh is for keeps of coordinates: those of vertices that are added are rounded to
  /// that; if it `rounds_all`, those of the mesh first, so that what is offset is what will be read.
  Precision precision;

  /// The tolerance where the distance is `distance`, world units.
  double at(double distance) const;
};

struct RefinedOffset {
  Refinement refinement;  ///< The mesh that was offset: the one given, rounded if the precision asks for that, its
                          ///< faces split.
  OffsetResult result;    ///< Of that; `statistics.certified` tells what is proven.
};

/// Offsets a mesh so that its faces are at the distance, too: they are split until it is proven that every point of the
/// offset is within the tolerance, wherever its vertices get to their distance.
///
/// Added vertices go to the point at their distance that is nearest to the middle between the ends of their neighbours.
/// The result is an offset() of the refined mesh, in which the given mesh's vertices go where they go without
/// refinement, unless something has to be held back; the proof is made of its positions as written. Options are those
/// of offset(), but for `metric`, `off_source`, `inner_skin_last`, `keep_field` and `keep_paths`; `keep_face_errors`
/// has no effect. \throw as offset(), and InvalidInput for a tolerance that cannot be used, or one of these options
VDB_OFFSET_API RefinedOffset offset_to_tolerance(PolygonView mesh, const OffsetOptions& options,
                                                 const Tolerance& tolerance);

}  // namespace vdb_offset
