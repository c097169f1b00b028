// SPDX-License-Identifier: Apache-2.0
#include "motion/parts/part_miters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// The least sine between a face that stays and the part, below which it goes on in the part's plane. 6 degrees, not
// measured.
constexpr double kAcrossPart = 0.1;

/// The normals of the planes of the faces that stay around a vertex, each once; none if there are more than two, or if
/// one of them goes on in the part's plane.
std::vector<Vec3d> walls_around(const MeshParts& parts, std::uint32_t vertex) {
  const Surface& whole = *parts.whole;
  std::vector<Vec3d> walls = planes_that_stay(parts, vertex);
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

std::vector<Miter> edge_miters_of(const MeshParts& parts, const BorderSlides& slides, const ClosestQuery& moving_part,
                                  const Distances& distances, const OwnDistances* own) {
  const Surface& part = moving_part.surface();
  std::vector<std::uint32_t> border;
  for (std::uint32_t w = 0; w < parts.at_border.size(); ++w) {
    const std::uint32_t f = parts.part_vertex[w];
    if (parts.at_border[w] && distances[f] != 0 && !(own && own->differ(f))) border.push_back(w);
  }
  std::vector<std::optional<Miter>> found(border.size());
  const auto find = [&](std::size_t i) {
    const std::uint32_t w = border[i], f = parts.part_vertex[w];
    const double target = std::abs(distances[f]);
    const std::optional<Vec3d> there = slides.meet(w, distances[f]);
    if (!there) return;
    const Vec3d displacement = round_displacement(*there - part.vertices[f], target),
                end = (part.vertices[f] + part.origin) + displacement - part.origin;
    const Closest closest = moving_part(end, part.triangles_around(f).front());
    const bool is_farther = closest.distance > target * (1 + kReachedTolerance);
    if (!is_farther && !slides.lead(w)) return;  // its path in the plane gets there, as those beside it do
    found[i] = {w, displacement,     closest.distance,
                0, closest.triangle, is_farther ? VertexState::Mitered : VertexState::Reached,
                0};
  };
  for_each_index(border.size(), find, 16);
  std::vector<Miter> miters;
  for (const std::optional<Miter>& each : found)
    if (each) miters.push_back(*each);
  return miters;
}

std::vector<Miter> with_edge_miters(const MeshParts& parts, const BorderSlides& slides, std::vector<Miter> miters,
                                    const std::vector<Miter>& at_edge, std::span<const MiterWalls> walls) {
  const auto has_walls = [&](std::uint32_t w) {
    return std::binary_search(walls.begin(), walls.end(), MiterWalls{parts.part_vertex[w], {}},
                              [](const MiterWalls& a, const MiterWalls& b) { return a.vertex < b.vertex; });
  };
  std::erase_if(miters, [&](const Miter& miter) {
    return find_miter(at_edge, miter.vertex) && slides.lead(miter.vertex) && !has_walls(miter.vertex);
  });
  std::vector<Miter> all;
  std::set_union(miters.begin(), miters.end(), at_edge.begin(), at_edge.end(), std::back_inserter(all),
                 [](const Miter& a, const Miter& b) { return a.vertex < b.vertex; });
  return all;
}

std::vector<Miter> miters_of_all(const MeshParts& parts, std::vector<Miter> of_part) {
  if (parts.part_vertex.empty()) return of_part;
  const std::vector<std::uint32_t> number = vertices_of_whole(parts);
  for (Miter& miter : of_part) miter.vertex = number[miter.vertex];
  std::sort(of_part.begin(), of_part.end(), [](const Miter& a, const Miter& b) { return a.vertex < b.vertex; });
  return of_part;
}

}  // namespace vdb_offset
