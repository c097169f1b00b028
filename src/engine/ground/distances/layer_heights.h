// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Refuses distances that cannot be heights of layers. \throw InvalidInput unless these can be the heights of layers
/// over so many vertices, as grow_layers() has it. \pre each is uniform or has one for each vertex
void require_heights(std::span<const Distances> heights, std::size_t vertices);

}  // namespace vdb_offset
