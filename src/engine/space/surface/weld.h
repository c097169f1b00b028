// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "space/surface/surface.h"

namespace vdb_offset {

/// Refuses polygons that no surface can be built of. \throw InvalidInput if there are none: without a face, with fewer
/// corners than that in one, with indices out of range, coordinates that are not finite, or too many corners
void require_usable(PolygonView polygons, std::uint32_t least_corners = 3);

/// Does what find_welding() does. \pre require_usable() accepts the polygons
Welding weld_usable(PolygonView polygons, const WeldOptions& options);

/// The part of a welding that some of the faces have.
Welding restricted(Welding welding, PolygonView some_faces);

/// Gives the surface its vertices: one for each position that faces use; and for each vertex of the input the surface
/// vertex that it is part of.
void give_vertices(PolygonView polygons, const Welding& welding, Surface& surface);

/// Joins borders that run along each other, but have vertices where the other has none (T-junctions): splits the
/// triangle beside such a hanging vertex there, so that the triangles meet edge to edge. The pieces are of the same
/// face. Vertices stay where they are. Borders that only touch stay as they are, and so do edges of two faces.
/// \param reach how far a vertex may be from an edge to count as on it, >= 0
/// \pre the surface has vertices and triangles, and nothing was made of these yet
void join_hanging_vertices(Surface& surface, double reach);

}  // namespace vdb_offset
