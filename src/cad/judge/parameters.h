// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>

#include "judge/judge.h"
#include "offset/offset_surface.h"

namespace vdb_offset::cad {

/// How far points of a face of the result are from those of its source at the same (u, v).
struct AtParameters {
  std::size_t samples = 0;
  double least = 1, most = 1;  ///< As shares of what the distance is there; of points whose distance is not 0.
  double worst = 0;            ///< How far points are from where they ought to be, in the shape's unit.
};

/// Measures some points of a face, spread evenly over the (u, v) that lie in both faces.
/// \param made null if nothing became of the face
/// \param distance towards the outside of the source face
/// \param asked takes in what the distance is at the points of the source
AtParameters measure_at_parameters(const TopoDS_Face& source, const TopoDS_Face& made, const FaceDistance& distance,
                                   std::size_t count, AskedDistance& asked);

}  // namespace vdb_offset::cad
