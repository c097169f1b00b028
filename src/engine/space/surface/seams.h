// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// What close_seams() has done.
struct ClosedSeams {
  SeamFacts facts;
  std::optional<double> tolerance;  ///< How far apart borders are that count as one; none if there is no border.
};

/// Closes cracks that rounding has left: welds vertices at which two borders begin to run along each other, no farther
/// apart than the coordinates are precise, four units in the last place of the largest of them (or a billionth of the
/// diagonal, if that is more: nothing that small is meant). Inner vertices stay as they are, and so do borders that
/// only touch, edges that short, and faces that would lose a corner.
/// \param precision of a coordinate, relative to the largest; 0: found out from the coordinates at the borders, which
///                  may be those of a file in single precision or with few digits
/// \param first of each vertex in use the first that it is welded with already, kNone of others; changed
/// \return what was welded, which borders are still suspiciously close to each other, and what counts as one
ClosedSeams close_seams(PolygonView polygons, double precision, std::vector<std::uint32_t>& first);

/// Makes one vertex of the ends of edges that are nothing but rounding: no longer than single precision can resolve
/// across the mesh, and than MeshFacts::kSliver of the median edge. Marching tetrahedra, for one, leave such edges; the
/// slivers between them would fold. A set of vertices stays apart if it is wider than that, or if it is all that
/// there is.
/// \param first as close_seams() takes it; changed
void weld_slivers(PolygonView polygons, std::vector<std::uint32_t>& first, SeamFacts& facts);

/// The unit in the last place of a number as large as `largest` (> 0), judged by numbers that a file holds: that of
/// single precision if they all are, or look like ones that were; half that of their decimal digits if these are as
/// many for most of those near the largest; else that of double precision.
double unit_in_last_place(const std::vector<double>& numbers, double largest);

}  // namespace vdb_offset
