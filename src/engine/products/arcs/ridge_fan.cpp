// SPDX-License-Identifier: Apache-2.0
#include "products/arcs/ridge_fan.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset {

void RidgeFan::part() {
  const std::size_t count = triangles.size();
  sector.assign(count, 0);
  sectors = 0;
  if (is_at_border) {
    for (std::size_t i = 0; i < count; ++i) {
      sector[i] = sectors;
      sectors += is_open[i] != 0 || i + 1 == count ? 1 : 0;
    }
    return;
  }
  const auto open = std::find(is_open.begin(), is_open.end(), 1);
  if (open == is_open.end()) {
    sectors = 1;
    return;
  }
  std::size_t i = next(static_cast<std::size_t>(open - is_open.begin()));
  for (std::size_t turn = 0; turn < count; ++turn, i = next(i)) {
    sector[i] = sectors;
    if (is_open[i]) ++sectors;
  }
}

RidgeFinder::RidgeFinder(const PreparedMesh& mesh, const Distances& distances, double least_bend, bool at_borders)
    : mesh_(mesh),
      distances_(distances),
      least_bend_(least_bend),
      at_borders_(at_borders),
      is_left_out_(mesh.surface().vertices.size(), 0) {
  const Surface& surface = mesh.surface();
  std::vector<std::uint32_t> triangles(mesh.mesh().face_count(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.face[t] < triangles.size() && surface.representative[surface.triangles[t][0]] != kNone)
      ++triangles[surface.face[t]];
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const auto face = mesh.mesh().face(f);
    if (triangles[f] + 2 == face.size()) continue;
    for (const std::uint32_t v : face)
      if (const std::uint32_t w = surface.welded[v]; w != kNone) is_left_out_[w] = 1;
  }
}

bool RidgeFinder::is_corner_once(std::uint32_t face, std::uint32_t vertex) const {
  const auto corners = mesh_.mesh().face(face);
  return std::count_if(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return mesh_.surface().welded[v] == vertex; }) == 1;
}

bool RidgeFinder::walk_around(RidgeFan& fan) const {
  const Surface& surface = mesh_.surface();
  const MeshParts& parts = mesh_.parts();
  const auto around = surface.triangles_around(fan.vertex);
  const auto corner = [&](std::uint32_t t) {
    const auto& corners = surface.triangles[t];
    return corners[0] == fan.vertex ? 0u : corners[1] == fan.vertex ? 1u : 2u;
  };
  const auto is_border = [&](std::uint32_t half_edge) { return surface.next_around_edge[half_edge] == half_edge; };
  const auto begins =
      std::find_if(around.begin(), around.end(), [&](std::uint32_t t) { return is_border(3 * t + corner(t)); });
  fan.is_at_border = begins != around.end();
  if (fan.is_at_border && !at_borders_) return false;
  const std::uint32_t first = fan.is_at_border ? *begins : around.front();
  std::uint32_t t = first;
  do {
    if (!parts.off_part.empty() && parts.off_part[t]) return false;
    const std::uint32_t incoming = 3 * t + (corner(t) + 2) % 3, twin = surface.next_around_edge[incoming];
    if (is_border(incoming)) {
      fan.triangles.push_back(t);
      fan.across.push_back(surface.from(incoming));
      return is_corner_once(surface.face[t], fan.vertex) && fan.triangles.size() == around.size();
    }
    if (surface.next_around_edge[twin] != incoming || surface.from(twin) != fan.vertex ||
        surface.is_turned(t) != surface.is_turned(twin / 3) || !is_corner_once(surface.face[t], fan.vertex))
      return false;
    fan.triangles.push_back(t);
    fan.across.push_back(surface.from(incoming));
    t = twin / 3;
  } while (t != first && fan.triangles.size() <= around.size());
  return fan.triangles.size() == around.size();
}

double RidgeFinder::bend(const RidgeFan& fan, std::size_t edge) const {
  const Surface& surface = mesh_.surface();
  if (fan.is_at_border && edge + 1 == fan.triangles.size()) return 0;
  const std::uint32_t s = fan.triangles[edge], t = fan.triangles[fan.next(edge)];
  const Vec3d &n = surface.triangle_normals[s], &m = surface.triangle_normals[t];
  if (surface.face[s] == surface.face[t] || n.lengthSqr() == 0 || m.lengthSqr() == 0) return 0;
  const Vec3d along = surface.vertices[fan.across[edge]] - surface.vertices[fan.vertex];
  const double turn = -n.cross(m).dot(along) * fan.side;  // the fan runs counter-clockwise around the vertex
  const double angle = std::atan2(n.cross(m).length(), n.dot(m));
  return turn < 0 ? -angle : angle;
}

std::optional<RidgeFan> RidgeFinder::operator()(std::uint32_t vertex) const {
  const Surface& surface = mesh_.surface();
  const double distance = distances_[vertex];
  if (is_left_out_[vertex] || surface.representative[vertex] == kNone || distance == 0 ||
      surface.triangles_around(vertex).empty())
    return std::nullopt;
  RidgeFan fan{vertex, distance < 0 ? -1 : 1, {}, {}, {}, {}, 0};
  if (!walk_around(fan)) return std::nullopt;
  // What two planes hold has one way to go, and what a plane holds inside of the surface lies in it.
  if (surface.is_held(vertex) && (!fan.is_at_border || surface.held[vertex] > 1)) return std::nullopt;
  for (std::size_t i = 0; i < fan.triangles.size(); ++i) fan.is_open.push_back(bend(fan, i) > least_bend_);
  fan.part();
  return fan;
}

}  // namespace vdb_offset
