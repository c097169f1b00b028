#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What merge_flats() has done.
struct MergedFlats {
  std::size_t vertices = 0;            ///< How many went.
  std::vector<std::uint32_t> changed;  ///< Triangles that have other corners than before: sorted.
  /// What number each triangle, and each vertex, had before; empty if none went.
  std::vector<std::uint32_t> triangle_before, vertex_before;
};

/// Takes vertices out of a closed mesh where that changes nothing of its shape: inside what is flat, and along the
/// straight edge between two flat parts. Each goes into a neighbour, so that all that is left stands where it stood.
///
/// Flat is what lies within `tolerance` (world units) of a plane, from a vertex to all its neighbours. What is closed
/// and manifold stays so, faces stay on their planes and point where they pointed, and none gets longer and thinner
/// than 1 to 50 that was not. Vertices that are marked in `stays` stay (empty: none has to). Cost: O(triangles), and
/// some looks at each vertex taken out. The mesh's vertices, triangles and stars change; what else it tells is of the
/// mesh as it was. \pre the mesh is built, not placed, and does not cross itself
MergedFlats merge_flats(Surface& mesh, double tolerance, std::span<const std::uint8_t> stays = {});

/// The same, until no triangle crosses another, which what is flat to rounding alone may do: around those that do,
/// vertices stay, farther with each look. If some do after a few looks, the mesh is as it was.
/// Returns how many vertices went.
std::size_t merge_flats_soundly(Surface& mesh, double tolerance);

}  // namespace vdb_offset
