// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "space/surface/holes.h"
#include "space/surface/inside.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// The boundary of the inside of a surface, where that is not the surface itself. Only distances to it are meaningful:
/// its triangles may meet anywhere, not only at their edges.
struct Boundary {
  Surface surface;  ///< In the frame of the given surface.
  /// Of each triangle: the triangle of the given surface that it is part of; for one that fills a hole, a triangle at
  /// the hole's rim.
  std::vector<std::uint32_t> given;
  std::size_t buried = 0;  ///< Given triangles with both sides inside, which are left out.
  std::size_t cut = 0;     ///< Given triangles that meet others, and of which parts are left.
};

/// Finds the boundary of the inside: leaves out triangles that are buried inside, where solids overlap or lie in each
/// other, and fills holes. Triangles that meet others are cut along the segments that they share; each part is buried
/// or not as a whole. So is each component of the other triangles, connected over edges. None if all of the surface is
/// boundary and there are no holes. Cost: a search for crossings, and a ray for each component and each part.
/// \param holes to fill
/// \param look_for_buried not needed for distances outside
/// \pre the surface is placed. The result does not depend on the number of threads.
std::optional<Boundary> find_boundary(const Surface& given, const Inside& inside, std::span<const Hole> holes,
                                      bool look_for_buried);

}  // namespace vdb_offset
