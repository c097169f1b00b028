#include "vdb_offset/near_crossings.h"

#include <algorithm>

namespace vdb_offset {
namespace {

constexpr int kNearRings = 2;

}  // namespace

NearCrossings::NearCrossings(const Surface& surface, std::vector<TrianglePair> pairs)
    : surface_(surface), pairs_(std::move(pairs)), near_(surface.vertices.size(), 0) {
  for (const auto& [s, t] : pairs_) {
    reversed_.emplace_back(t, s);
    for (const auto triangle : {s, t})
      for (const auto v : surface.triangles[triangle]) near_[v] = 1;
  }
  std::sort(reversed_.begin(), reversed_.end());
  for (int ring = 0; ring < kNearRings && !pairs_.empty(); ++ring) {
    const std::vector<std::uint8_t> inner = near_;
    for (const auto& [a, b, c] : surface.triangles)
      if (inner[a] || inner[b] || inner[c]) near_[a] = near_[b] = near_[c] = 1;
  }
}

bool NearCrossings::is_near(std::uint32_t triangle) const {
  const auto& [a, b, c] = surface_.triangles[triangle];
  return near_[a] || near_[b] || near_[c];
}

/// Those of the triangle, and within two rings of it; sorted.
std::vector<std::uint32_t> NearCrossings::vertices_beside(std::uint32_t triangle) const {
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

bool NearCrossings::sheets_cross(std::uint32_t s, std::uint32_t t) const {
  if (!is_near(s) || !is_near(t)) return false;
  const std::vector<std::uint32_t> beside_t = vertices_beside(t);
  const auto is_beside_t = [&](std::uint32_t triangle) {
    const auto& corners = surface_.triangles[triangle];
    return std::any_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return std::binary_search(beside_t.begin(), beside_t.end(), v); });
  };
  for (const auto v : vertices_beside(s))
    for (const auto first : surface_.triangles_around(v))
      for (const auto* pairs : {&pairs_, &reversed_})
        for (auto pair = std::lower_bound(pairs->begin(), pairs->end(), TrianglePair(first, 0));
             pair != pairs->end() && pair->first == first; ++pair)
          if (is_beside_t(pair->second)) return true;
  return false;
}

}  // namespace vdb_offset
