#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/surface/holes.h"
#include "vdb_offset/surface/inside.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The boundary of what is inside of a surface, as far as that is not the surface itself. Of use to measure distances
/// to: its triangles may meet anywhere, not only at their edges.
struct Boundary {
  Surface surface;                   ///< In the frame of the given one.
  std::vector<std::uint32_t> given;  ///< Of each of its triangles, the one of the given surface that it is part of;
                                     ///< what fills a hole belongs to one at the rim.
  std::size_t buried = 0;            ///< Triangles given that are inside with both of their sides, and left out.
  std::size_t cut = 0;               ///< Those that meet others, and are left in parts.
};

/// Leaves out what is buried inside, where solids overlap or lie in each other, and fills holes. Triangles that meet
/// others are cut along what they share with them; each part is buried or not as a whole. The rest is so patch by
/// patch, joined over edges. None, if all of the surface is boundary and there are no holes.
///
/// `holes` are those to fill; `look_for_buried` is of no use for distances outside. Cost: a search for crossings, a ray
/// for each patch and each part. \pre the surface is placed. The result does not depend on the number of threads.
std::optional<Boundary> find_boundary(const Surface& given, const Inside& inside, std::span<const Hole> holes,
                                      bool look_for_buried);

}  // namespace vdb_offset
