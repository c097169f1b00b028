#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/surface.h"

namespace vdb_offset {

/// Two triangles, the smaller index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// The pairs of a surface's triangles that meet elsewhere than in the corners and edges they share, with its vertices
/// at `positions`, as they are: decided with exact predicates (CGAL's kernel), without a tolerance. Neighbours across
/// an edge meet if they are folded flat onto each other. Triangles without area meet nothing.
/// If `moved` is not empty, only pairs of which at least one triangle has moved (is not 0) are looked at.
/// Sorted; the same for any number of threads. Positions may lie anywhere; one for each surface vertex.
std::vector<TrianglePair> find_crossings(const Surface& surface, std::span<const Vec3d> positions,
                                         std::span<const std::uint8_t> moved = {});

}  // namespace vdb_offset
