// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <vector>

#include "offset/offset_surface.h"

namespace vdb_offset::cad {

/// How far a face is offset towards the outside, and which faces are offset alike: those of one part have the same
/// distance wherever they meet.
struct PartOfFace {
  FaceDistance distance;
  std::size_t part = 0;
};

/// The distances of a shape's faces (numbered as TopExp_Explorer meets them), blended across smooth edges: at a
/// distance s from the edge of another part that is joined smoothly, that part's distance at the closest point of its
/// edge has the weight S(1 - s / length) beside the own one's weight of 1, as in vertex_distances(). A face that none
/// reaches keeps its distance as it is.
/// \param length in the shape's unit, > 0
std::vector<FaceDistance> blended_faces(const TopoDS_Shape& shape, const std::vector<PartOfFace>& faces, double length);

}  // namespace vdb_offset::cad
