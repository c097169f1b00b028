// SPDX-License-Identifier: Apache-2.0
#include "products/offset/stand_off.h"

#include <cstddef>

#include "space/surface/surface.h"

namespace vdb_offset {

/// place.
std::vector<Vec3d> positions_off_source(PolygonView source, std::span<const Vec3d> positions, const WeldOptions& weld) {
  const Welding welding = find_welding(source, weld);
  std::vector<Vec3d> off(source.positions.begin(), source.positions.end());
  for (std::size_t v = 0; v < off.size(); ++v) {
    if (welding.first[v] == kNone) continue;
    const Vec3d& from = source.positions[welding.first[v]];
    off[v] = stand_off(from, positions[v] - from);
  }
  return off;
}

}  // namespace vdb_offset
