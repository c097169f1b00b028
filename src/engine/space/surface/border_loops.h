// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// A border: vertices all around an opening, or from one vertex to another if more than two edges of borders meet at
/// these.
struct BorderLoop {
  std::vector<std::uint32_t> vertices;  ///< The first one is not repeated at the end.
  bool closed;
};

/// The borders of a surface, in the order of their first edges.
std::vector<BorderLoop> border_loops(const Surface& surface);

}  // namespace vdb_offset
