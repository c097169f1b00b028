// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// An edge with a single face: where a mesh has a border.
struct SingleEdge {
  std::uint32_t a, b;    ///< Its ends; a < b.
  std::uint32_t corner;  ///< Of the face: where its side along the edge begins. Index into PolygonView::corners.
};

/// The edges with a single face, sorted by their ends; see visit_sides() for what counts as a side.
/// \param position of each vertex the number of its position, which ends are told by
std::vector<SingleEdge> find_single_edges(PolygonView polygons, std::span<const std::uint32_t> position);

}  // namespace vdb_offset
