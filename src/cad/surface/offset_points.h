// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "messages/cad_messages.h"
#include "surface/face_surface.h"

namespace vdb_offset::cad {

/// A face's surface, and which of its sides is outward.
struct SidedSurface {
  FaceSurface surface;
  double side = 1;  ///< -1 if the face is reversed.
};

/// Moves each point to where it is at its distance from all of its faces' surfaces, by Gauss and Newton's method: each
/// step is the shortest that would do if the surfaces were planes. A point for which that leads nowhere stays.
/// \pre the places are those of the aims, one aim's after the other's, and their faces are among `surfaces`
std::vector<Vec3d> offset_points(std::span<const SidedSurface> surfaces, std::span<const io::CadAim> aims,
                                 std::span<const io::CadPlace> places);

}  // namespace vdb_offset::cad
