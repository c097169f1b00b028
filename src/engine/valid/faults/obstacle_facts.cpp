// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/obstacle_facts.h"

#include "ground/system/assert.h"

namespace vdb_offset {

Surroundings::Surroundings(const MeshParts& parts, std::span<const Vec3d> source, double clearance)
    : surface_(parts.surface()),
      query_(*parts.obstacles),
      obstacles_{query_, clearance},
      source_crossings_(CrossingFinder(surface_, source).all()),
      start_(find_starting_gaps(surface_, source, obstacles_, source_crossings_)) {
  VDB_OFFSET_ASSERT(parts.obstacles->origin == surface_.origin);
  obstacles_.start = &start_;
}

void Surroundings::hold(const Paths& paths, const Distances& distances, std::vector<std::uint8_t>& bound) const {
  if (start_.touching == 0) return;
  bound.resize(surface_.vertices.size(), 0);
  for (std::size_t t = 0; t < start_.touches.size(); ++t)
    if (start_.touches[t])
      for (const auto v : surface_.triangles[t])
        if (distances[v] != 0 && paths.displacement[v] == Vec3d(0.0)) bound[v] = 1;
}

ObstacleFacts Surroundings::facts(std::span<const Vec3d> positions) const {
  const Gap gap = measure_gap(surface_, positions, obstacles_);
  return {gap.least, start_.least, gap.near, start_.touching - start_.crossing, start_.crossing};
}

}  // namespace vdb_offset
