// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "space/surface/surface.h"

namespace vdb_offset {

/// Whether a triangle has a corner twice.
inline bool repeats_corner(const std::array<std::uint32_t, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Removes the triangles for which is_kept(t) is false, and their entries in `face` and `piece_of`; the others keep
/// their order.
template <class IsKept>
void keep_triangles(Surface& surface, IsKept&& is_kept) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!is_kept(t)) continue;
    surface.triangles[kept] = surface.triangles[t];
    if (!surface.piece_of.empty()) surface.piece_of[kept] = surface.piece_of[t];
    surface.face[kept++] = surface.face[t];
  }
  surface.triangles.resize(kept);
  surface.face.resize(kept);
  if (!surface.piece_of.empty()) surface.piece_of.resize(kept);
}

/// Connects the triangles over edges and settles which side is outward. Faces that repeat each other would be
/// connected over edges of four faces, and have no side: one of them stands for all.
void join_and_settle(PolygonView polygons, Orient orient, Surface& surface);

}  // namespace vdb_offset
