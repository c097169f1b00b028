// SPDX-License-Identifier: Apache-2.0
#include "motion/parts/mesh_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "ground/distances/mean_distances.h"
#include "ground/mesh/triangulate.h"
#include "space/surface/weld.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The faces of a mesh whose mark is `kept`, over the mesh's own vertices.
struct SomeFaces {
  std::vector<std::uint32_t> corners, face_begin{0};
  std::vector<std::array<std::uint32_t, 3>> triangles;

  SomeFaces(PolygonView mesh, std::span<const std::uint8_t> marks, std::uint8_t kept) {
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      if (marks[f] != kept) continue;
      const auto face = mesh.face(f);
      corners.insert(corners.end(), face.begin(), face.end());
      face_begin.push_back(static_cast<std::uint32_t>(corners.size()));
      if (!mesh.triangles.empty()) append_triangles(mesh, f, triangles);
    }
  }
  PolygonView of(PolygonView mesh) const { return {mesh.positions, corners, face_begin, triangles}; }
  bool empty() const { return corners.empty(); }
};

/// Finds for the whole's vertices and triangles where they are on the moving part, and which lie at its border.
void relate(PolygonView mesh, std::span<const std::uint8_t> only, MeshParts& parts) {
  const Surface& whole = *parts.whole;
  parts.part_vertex.assign(whole.vertices.size(), kNone);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (parts.moving_part.welded[v] != kNone) parts.part_vertex[whole.welded[v]] = parts.moving_part.welded[v];
  parts.off_part.assign(whole.triangles.size(), 0);
  parts.at_border.assign(whole.vertices.size(), 0);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    if (only.empty() || only[whole.face[t]]) continue;
    parts.off_part[t] = 1;
    for (const auto v : whole.triangles[t]) parts.at_border[v] = parts.part_vertex[v] != kNone;
  }
}

/// Where the faces that stay lead out of planes that borders of the moving part lie in. Refers to the parts.
LeadsOn beyond_part(const MeshParts& parts) {
  return [&parts, of_whole = vertices_of_whole(parts)](std::uint32_t vertex, std::uint32_t other, const Vec3d& plane) {
    constexpr double kInPlane = 1e-6;  // of a normal's cosine
    const Surface& whole = *parts.whole;
    bool goes_on = false, leads_out = false;
    for (const auto t : whole.triangles_around(of_whole[vertex])) {
      const auto& corners = whole.triangles[t];
      const Vec3d& normal = whole.triangle_normals[t];
      if (!parts.off_part[t]) continue;
      goes_on = goes_on || std::find(corners.begin(), corners.end(), of_whole[other]) != corners.end();
      leads_out = leads_out || (normal.lengthSqr() > 0 && std::abs(normal.dot(plane)) < 1 - kInPlane);
    }
    return goes_on && leads_out;
  };
}

}  // namespace

std::vector<std::uint32_t> vertices_of_whole(const MeshParts& parts) {
  std::vector<std::uint32_t> of_whole(parts.moving_part.vertices.size(), kNone);
  for (std::uint32_t w = 0; w < parts.part_vertex.size(); ++w)
    if (parts.part_vertex[w] != kNone) of_whole[parts.part_vertex[w]] = w;
  return of_whole;
}

std::vector<Vec3d> MeshParts::source(PolygonView mesh) const {
  std::vector<Vec3d> positions;
  positions.reserve(surface().vertices.size());
  for (const auto v : surface().representative)
    if (v != kNone) positions.push_back(mesh.positions[v]);
  for (std::size_t i = 0; positions.size() < surface().vertices.size(); ++i)
    positions.push_back(obstacle_mesh.positions[obstacles->representative[i]]);
  return positions;
}

MeshParts build_mesh_parts(PolygonView mesh, const MeshPartsOptions& options) {
  const bool of_parts = !options.only.empty();
  if (of_parts && options.only.size() != mesh.face_count())
    throw InvalidInput("part: expected a mark for each of " + std::to_string(mesh.face_count()) + " faces, got " +
                       std::to_string(options.only.size()));
  MeshParts parts;
  if (!of_parts) {
    parts.moving_part = build_surface(mesh, options.weld, options.orient);
  } else {
    const SomeFaces chosen(mesh, options.only, 1), left(mesh, options.only, 0);
    if (chosen.empty()) throw InvalidInput("part: expected at least one face, got none");
    // All of the mesh decides which vertices are one: where a part ends, the mesh has no border.
    const Welding welding = find_welding(mesh, options.weld);
    const auto build = [&](PolygonView faces) {
      return build_welded(faces, restricted(welding, faces), options.orient);
    };
    parts.moving_part = build(chosen.of(mesh));
    parts.whole = build_welded(mesh, welding, options.orient);
    if (!left.empty()) parts.rest = build(left.of(mesh));
  }
  require_area(parts.moving_part);
  if (options.obstacles.face_count() > 0) {
    if (!parts.whole) parts.whole = parts.moving_part;
    parts.obstacle_mesh = options.obstacles;
    parts.obstacles = build_surface(options.obstacles, {});
  }
  if (parts.whole) relate(mesh, options.only, parts);
  return parts;
}

void to_local_frame(MeshParts& parts, double voxel_size, const SymmetryOptions& symmetry, double reach,
                    PartEdges edges) {
  to_local_frame(parts.moving_part, voxel_size);
  for (std::optional<Surface>* other : {&parts.whole, &parts.rest, &parts.obstacles})
    if (*other) to_frame(**other, parts.moving_part.origin);
  const bool follow = parts.rest && edges == PartEdges::FollowFaces;
  hold_in_planes(parts.moving_part, symmetry, reach, follow ? beyond_part(parts) : LeadsOn());
  if (!parts.obstacles) return;
  append(*parts.whole, *parts.obstacles);
  parts.part_vertex.resize(parts.whole->vertices.size(), kNone);
  parts.at_border.resize(parts.whole->vertices.size(), 0);
  parts.off_part.resize(parts.whole->triangles.size(), 1);
}

Distances distances_on_parts(const MeshParts& parts, Border border, const Distances& of_input,
                             std::size_t& disagreeing) {
  const bool all_move = parts.part_vertex.empty();
  if (of_input.uniform() && all_move) return of_input;
  const Surface& surface = parts.surface();
  MeanDistances mean = mean_distances(of_input, surface.welded, surface.representative);
  disagreeing += mean.disagreeing;
  for (std::size_t w = 0; w < mean.each.size() && !all_move; ++w)
    if (parts.part_vertex[w] == kNone || (border == Border::Fixed && parts.at_border[w])) mean.each[w] = 0;
  return {std::move(mean.each), {of_input.at_corner().begin(), of_input.at_corner().end()}};
}

Distances distances_of_input(const Surface& surface, const Distances& distances) {
  if (distances.uniform()) return distances;
  std::vector<double> each(surface.welded.size(), 0.0);
  for (std::size_t v = 0; v < each.size(); ++v)
    if (surface.welded[v] != kNone) each[v] = distances[surface.welded[v]];
  return {std::move(each), {distances.at_corner().begin(), distances.at_corner().end()}};
}

Distances distances_of_part(const MeshParts& parts, const Distances& of_all) {
  if (parts.part_vertex.empty() || of_all.uniform()) return of_all;
  std::vector<double> each(parts.moving_part.vertices.size(), 0.0);
  for (std::size_t w = 0; w < parts.part_vertex.size(); ++w)
    if (parts.part_vertex[w] != kNone) each[parts.part_vertex[w]] = of_all[w];
  return {std::move(each), {of_all.at_corner().begin(), of_all.at_corner().end()}};
}

}  // namespace vdb_offset
