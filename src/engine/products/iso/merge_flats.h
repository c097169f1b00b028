// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// The result of merge_flats().
struct MergedFlats {
  std::size_t vertices = 0;            ///< Number of vertices taken out.
  std::vector<std::uint32_t> changed;  ///< Triangles that have other corners than before. Sorted.
  /// The number that each triangle, and each vertex, had before; empty if no vertex was taken out.
  std::vector<std::uint32_t> triangle_before, vertex_before;
};

/// Takes vertices out of a closed mesh where that leaves its shape as it is: inside flat parts, and along the straight
/// edge between two flat parts. Each is merged into a neighbour, and all others keep their positions.
///
/// A part is flat around a vertex if the vertex and all its neighbours lie within `tolerance` (world units) of a plane.
/// A closed and manifold mesh stays so, faces stay on their planes and point where they pointed, and no face gets
/// thinner than 1 to 50 that was not. Cost: O(triangles), and a few trials for each vertex taken out. The mesh's
/// vertices, triangles and stars change; its other members are those of the mesh as it was.
/// \param stays of each vertex: 1 if it has to stay; empty: none has to
/// \pre the mesh is built, not placed, and does not cross itself
MergedFlats merge_flats(Surface& mesh, double tolerance, std::span<const std::uint8_t> stays = {});

/// Merges flat parts by merge_flats() such that no triangle crosses another, as triangles of parts that are flat only
/// to rounding may do: around crossings vertices stay, in wider rings with each trial. If there are crossings after a
/// few trials, the mesh stays as it was. Returns the number of vertices taken out.
std::size_t merge_flats_soundly(Surface& mesh, double tolerance);

}  // namespace vdb_offset
