// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/parts/part_miters.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace vdb_offset {
namespace {

// The largest sine of the angle between normals of faces on one plane; and the least between a face that stays and the
// part, below which it goes on in the part's plane. As kOnePlaneSine of miters; 6 degrees, not measured.
constexpr double kSameWall = 1e-4, kAcrossPart = 0.1;

/// The normals of the planes of the faces that stay around a vertex, each once; none if there are more than two, or if
/// one of them goes on in the part's plane.
std::vector<Vec3d> walls_around(const MeshParts& parts, std::uint32_t vertex) {
  const Surface& whole = *parts.whole;
  std::vector<Vec3d> walls;
  for (const auto t : whole.triangles_around(vertex)) {
    const Vec3d& n = whole.triangle_normals[t];
    if (!parts.off_part[t] || n.lengthSqr() == 0) continue;
    const auto is_same = [&](const Vec3d& wall) { return wall.cross(n).length() < kSameWall; };
    if (std::none_of(walls.begin(), walls.end(), is_same)) walls.push_back(n);
  }
  if (walls.size() > 2 || (walls.size() == 2 && walls[0].cross(walls[1]).length() < kAcrossPart)) return {};
  for (const auto t : whole.triangles_around(vertex))
    for (const Vec3d& wall : walls)
      if (!parts.off_part[t] && wall.cross(whole.triangle_normals[t]).length() < kAcrossPart) return {};
  return walls;
}

}  // namespace

std::vector<MiterWalls> walls_at_edge(const MeshParts& parts, Border border) {
  std::vector<MiterWalls> walls;
  if (border != Border::Slide || !parts.rest) return walls;
  for (std::uint32_t w = 0; w < parts.at_border.size(); ++w) {
    if (!parts.at_border[w] || parts.moving_part.is_held(parts.part_vertex[w])) continue;
    std::vector<Vec3d> normals = walls_around(parts, w);
    if (!normals.empty()) walls.push_back({parts.part_vertex[w], std::move(normals)});
  }
  std::sort(walls.begin(), walls.end(), [](const MiterWalls& a, const MiterWalls& b) { return a.vertex < b.vertex; });
  return walls;
}

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
