#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

inline bool repeats_corner(const std::array<std::uint32_t, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Keeps the triangles, and the faces they are of, that `is_kept(t)`, in their order.
template <class IsKept>
void keep_triangles(Surface& surface, IsKept&& is_kept) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!is_kept(t)) continue;
    surface.triangles[kept] = surface.triangles[t];
    surface.face[kept++] = surface.face[t];
  }
  surface.triangles.resize(kept);
  surface.face.resize(kept);
}

/// Joins the triangles and settles which side is outward. Sheets that lie on each other, as doubled faces do, would
/// join into edges of four faces with no side at all; one of them says where they all go.
void join_and_settle(PolygonView polygons, Orient orient, Surface& surface);

}  // namespace vdb_offset
