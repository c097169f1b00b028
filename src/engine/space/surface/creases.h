// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// Marks the vertices that lie on creases: 1 of each of those, 0 of the others.
///
/// A crease is a line of edges at which the surface bends sharply, and far more than beside it: so are the edges of a
/// part that was drawn, however coarse its curved faces are; where all edges of a vertex are sharp, all are creases. So
/// are its sharp edges where all planes around it, moved by one distance, meet in one point, however much the others
/// bend; with four planes or more the vertex alone is on one, if it is the tip of a sharp cone.
/// Where the surface bends everywhere a little and here and there more, as scans do, no edge is one, nor are a few
/// edges that are connected with no others. A vertex on an edge of more than two faces is on none.
std::vector<std::uint8_t> vertices_on_creases(const Surface& surface);

}  // namespace vdb_offset
