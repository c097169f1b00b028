// SPDX-License-Identifier: Apache-2.0
#include "ground/distances/mean_distances.h"

#include "ground/system/assert.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

MeanDistances mean_distances(const Distances& of_vertices, std::span<const std::uint32_t> group,
                             std::span<const std::uint32_t> first) {
  VDB_OFFSET_ASSERT(of_vertices.uniform() || of_vertices.count() == group.size());
  const std::size_t count = first.size();
  MeanDistances mean;
  mean.each.assign(count, 0.0);
  std::vector<std::uint32_t> copies(count, 0), apart(count, 0);
  for (std::size_t v = 0; v < group.size(); ++v) {
    const auto g = group[v];
    if (g == kNone) continue;
    VDB_OFFSET_ASSERT(g < count && first[g] != kNone);
    mean.each[g] += of_vertices[v];
    ++copies[g];
    apart[g] += of_vertices[v] != of_vertices[first[g]];
  }
  for (std::size_t g = 0; g < count; ++g) {
    if (copies[g] == 0) continue;
    mean.disagreeing += apart[g];
    mean.each[g] =
        apart[g] ? mean.each[g] / copies[g] : of_vertices[first[g]];  // where all agree, their distance keeps its bits
  }
  return mean;
}

}  // namespace vdb_offset
