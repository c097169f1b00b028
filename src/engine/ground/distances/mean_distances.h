// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Distances of groups of vertices that move together.
struct MeanDistances {
  std::vector<double> each;     ///< Of each group: the mean of its vertices' distances; 0 for a group without any.
  std::size_t disagreeing = 0;  ///< Vertices that have another distance than the first vertex of their group.
};

/// Averages the distances of vertices that move together. Where all of a group agree, their distance is kept to the
/// last bit.
/// \param group of each vertex; kNone for a vertex in none
/// \param first of each group the vertex that the others are compared with; kNone for a group without vertices
MeanDistances mean_distances(const Distances& of_vertices, std::span<const std::uint32_t> group,
                             std::span<const std::uint32_t> first);

}  // namespace vdb_offset
