// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/source_crossings.h"

#include <algorithm>
#include <numeric>

#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

// Rings around a face that crosses another within which crossings slide. Not measured.
constexpr int kNearRings = 2;

}  // namespace

SourceCrossings::SourceCrossings(const Surface& surface, SelfCrossings crossings)
    : surface_(surface), crossings_(std::move(crossings)), near_begin_(surface.vertices.size() + 1, 0) {
  VDB_OFFSET_ASSERT(std::is_sorted(pairs().begin(), pairs().end()));
  VDB_OFFSET_ASSERT(!has_more() || crossings_.crossed.size() == surface.triangles.size());
  if (count() == 0) return;
  if (!has_more()) pair_up();
  for (std::uint32_t t = 0; t < crossings_.crossed.size(); ++t)
    if (crossings_.crossed[t]) crossing_.push_back(t);
  find_near();
}

void SourceCrossings::pair_up() {
  std::vector<TrianglePair> both_ways = pairs();
  for (const auto& [s, t] : pairs()) both_ways.emplace_back(t, s);
  std::sort(both_ways.begin(), both_ways.end());
  for (std::size_t i = 0; i < both_ways.size(); ++i) {
    if (i > 0 && both_ways[i].first == both_ways[i - 1].first) continue;
    crossing_.push_back(both_ways[i].first);
    crossed_begin_.push_back(static_cast<std::uint32_t>(i));
  }
  crossed_begin_.push_back(static_cast<std::uint32_t>(both_ways.size()));
  for (const TrianglePair& pair : both_ways)
    crossed_.push_back(static_cast<std::uint32_t>(std::lower_bound(crossing_.begin(), crossing_.end(), pair.second) -
                                                  crossing_.begin()));
}

void SourceCrossings::find_near() {
  std::vector<std::vector<std::uint32_t>> beside;
  beside.reserve(crossing_.size());
  for (const auto triangle : crossing_) {
    beside.push_back(vertices_beside(triangle));
    for (const auto v : beside.back()) ++near_begin_[v + 1];
  }
  std::partial_sum(near_begin_.begin(), near_begin_.end(), near_begin_.begin());
  near_.resize(near_begin_.back());
  std::vector<std::uint32_t> end(near_begin_.begin(), near_begin_.end() - 1);
  for (std::uint32_t i = 0; i < beside.size(); ++i)
    for (const auto v : beside[i]) near_[end[v]++] = i;
  triangle_near_.assign(surface_.triangles.size(), 0);
  for (const auto& vertices : beside)
    for (const auto v : vertices)
      for (const auto t : surface_.triangles_around(v)) triangle_near_[t] = 1;
}

/// The vertices of a triangle, and those within two rings of it; sorted.
std::vector<std::uint32_t> SourceCrossings::vertices_beside(std::uint32_t triangle) const {
  std::vector<std::uint32_t> vertices(surface_.triangles[triangle].begin(), surface_.triangles[triangle].end());
  for (int ring = 0; ring < kNearRings; ++ring) {
    for (std::size_t i = 0, inner = vertices.size(); i < inner; ++i)
      for (const auto t : surface_.triangles_around(vertices[i]))
        vertices.insert(vertices.end(), surface_.triangles[t].begin(), surface_.triangles[t].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return vertices;
}

bool SourceCrossings::sheets_cross(std::uint32_t s, std::uint32_t t) const {
  const auto is_near_t = [&](std::uint32_t crossing) {
    const auto& corners = surface_.triangles[t];
    return std::any_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return std::binary_search(near(v).begin(), near(v).end(), crossing); });
  };
  if (!is_near(t)) return false;
  if (has_more()) return is_near(s);
  for (const auto v : surface_.triangles[s])
    for (const auto crossing : near(v))
      for (std::uint32_t i = crossed_begin_[crossing]; i < crossed_begin_[crossing + 1]; ++i)
        if (is_near_t(crossed_[i])) return true;
  return false;
}

}  // namespace vdb_offset
