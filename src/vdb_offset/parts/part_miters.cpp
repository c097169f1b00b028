// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/parts/part_miters.h"

#include <algorithm>
#include <cstdint>

namespace vdb_offset {

std::vector<Miter> miters_of_all(const MeshParts& parts, std::vector<Miter> of_part) {
  if (parts.part_vertex.empty()) return of_part;
  std::vector<std::uint32_t> number(parts.moving_part.vertices.size());
  for (std::uint32_t w = 0; w < parts.part_vertex.size(); ++w)
    if (parts.part_vertex[w] != kNone) number[parts.part_vertex[w]] = w;
  for (Miter& miter : of_part) miter.vertex = number[miter.vertex];
  std::sort(of_part.begin(), of_part.end(), [](const Miter& a, const Miter& b) { return a.vertex < b.vertex; });
  return of_part;
}

}  // namespace vdb_offset
