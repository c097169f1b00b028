#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/surface.h"

namespace vdb_offset {

/// What merge_flats() has done.
struct MergedFlats {
  std::size_t vertices = 0;            ///< How many went.
  std::vector<std::uint32_t> changed;  ///< Triangles that have other corners than before: sorted.
};

/// Takes vertices out of a closed mesh where that changes nothing of its shape: inside what is flat, and along the
/// straight edge between two flat parts. Each goes into a neighbour, so that all that is left stands where it stood.
///
/// Flat is what lies within `tolerance` (world units) of a plane, from a vertex to all its neighbours. What is closed
/// and manifold stays so, faces stay on their planes and point where they pointed, and none gets longer and thinner
/// than 1 to 50 that was not. Cost: O(triangles), and some looks at each vertex taken out. The mesh's vertices,
/// triangles and stars change; what else it tells is of the mesh as it was.
/// \pre the mesh is built, not placed, and does not cross itself
MergedFlats merge_flats(Surface& mesh, double tolerance);

}  // namespace vdb_offset
