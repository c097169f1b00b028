// SPDX-License-Identifier: Apache-2.0
#include "products/offset/stand_off.h"

#include <cstddef>
#include <utility>

#include "space/surface/surface.h"

namespace vdb_offset {

std::vector<Distances> less_stand_off(std::span<const Distances> heights) {
  const Distances& outer = heights.back();
  std::vector<Distances> less;
  for (const Distances& each : heights) {
    if (each.uniform() && outer.uniform()) {
      less.emplace_back(each[0] - kStandOff * outer[0]);
      continue;
    }
    const std::size_t count = each.uniform() ? outer.count() : each.count();
    std::vector<double> of_vertices(count);
    for (std::size_t v = 0; v < count; ++v) of_vertices[v] = each[v] - kStandOff * outer[v];
    less.emplace_back(std::move(of_vertices));
  }
  return less;
}

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
