// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/own_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ground/system/assert.h"

namespace vdb_offset {

OwnDistances::OwnDistances(std::span<const double> at_corner, PolygonView mesh, std::span<const std::uint8_t> only,
                           const Surface& surface)
    : surface_(surface),
      at_corner_(at_corner),
      own_(3 * surface.triangles.size(), 0.0),
      differ_(surface.vertices.size(), 0) {
  VDB_OFFSET_ASSERT(at_corner.size() == mesh.corners.size());
  std::vector<std::uint32_t> marked;
  for (std::uint32_t f = 0; f < only.size(); ++f)
    if (only[f]) marked.push_back(f);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const std::uint32_t f = marked.empty() ? surface.face[t] : marked[surface.face[t]];
    for (std::uint32_t k = 0; k < 3; ++k)
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
        if (surface.welded[mesh.corners[c]] == surface.triangles[t][k]) own_[3 * t + k] = at_corner[c];
  }
  for (std::uint32_t v = 0; v < differ_.size(); ++v) {
    const auto around = surface.triangles_around(v);
    differ_[v] = std::any_of(around.begin(), around.end(),
                             [&](std::uint32_t t) { return this->at(t, v) != this->at(around[0], v); });
  }
}

std::optional<OwnDistances> OwnDistances::of(const Distances& distances, PolygonView mesh,
                                             std::span<const std::uint8_t> only, const Surface& surface) {
  if (distances.at_corner().empty()) return std::nullopt;
  return std::optional<OwnDistances>(std::in_place, distances.at_corner(), mesh, only, surface);
}

double OwnDistances::at(std::uint32_t triangle, std::uint32_t vertex) const {
  const auto& corners = surface_.triangles[triangle];
  return own_[3 * triangle + (corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2)];
}

double OwnDistances::least(std::uint32_t vertex) const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto t : surface_.triangles_around(vertex)) least = std::min(least, std::abs(at(t, vertex)));
  return least;
}

}  // namespace vdb_offset
