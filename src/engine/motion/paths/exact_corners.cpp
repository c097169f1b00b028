// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/exact_corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

// Of surfaces that bend by more than this share of 1 / distance, the offset of a vertex is not told from the triangles
// around it: its own surface may come nearer. Not measured.
constexpr double kMostBend = 0.9;

}  // namespace

ExactCorners::ExactCorners(const ExactSurface& exact, PolygonView mesh, std::span<const std::uint8_t> only,
                           const Surface& surface)
    : exact_(exact), surface_(surface), normals_(3 * surface.triangles.size(), Vec3d(0.0)) {
  VDB_OFFSET_ASSERT(exact.corner_normals().size() == mesh.corners.size());
  for (std::uint32_t f = 0; f < only.size(); ++f)
    if (only[f]) marked_.push_back(f);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const std::uint32_t f = face_of(t);
    for (std::uint32_t k = 0; k < 3; ++k)
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
        if (surface.welded[mesh.corners[c]] == surface.triangles[t][k])
          normals_[3 * t + k] = exact.corner_normals()[c] * (surface.is_turned(t) ? -1.0 : 1.0);
  }
  find_known(mesh);
}

void ExactCorners::find_known(PolygonView mesh) {
  known_.assign(surface_.vertices.size(), 1);
  for (std::uint32_t v = 0; v < known_.size(); ++v)
    for (const auto t : surface_.triangles_around(v))
      if (normal(t, v).lengthSqr() == 0 && surface_.triangle_normals[t].lengthSqr() > 0) known_[v] = 0;
  for (std::uint32_t v = 0; v < surface_.welded.size(); ++v)
    if (const auto w = surface_.welded[v]; w != kNone && surface_.representative[w] != v) known_[w] = 0;
  // Those at the edge of a part that moves are held by faces that stay.
  std::vector<std::uint8_t> moves(mesh.face_count(), 0);
  for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) moves[face_of(t)] = 1;
  for (std::size_t f = 0; f < moves.size(); ++f)
    for (const std::uint32_t v : mesh.face(f))
      if (const auto w = surface_.welded[v]; !moves[f] && w != kNone) known_[w] = 0;
}

bool ExactCorners::is_sharp(std::uint32_t vertex) const {
  const auto piece = exact_.piece_of_face();
  const auto around = surface_.triangles_around(vertex);
  return std::any_of(around.begin(), around.end(),
                     [&](auto t) { return piece[face_of(t)] != piece[face_of(around[0])]; });
}

const Vec3d& ExactCorners::normal(std::uint32_t triangle, std::uint32_t vertex) const {
  const auto& corners = surface_.triangles[triangle];
  return normals_[3 * triangle + (corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2)];
}

bool ExactCorners::is_own(std::uint32_t vertex, const Vec3d& end, double distance, std::uint32_t triangle,
                          const Vec3d& point) const {
  const auto piece = exact_.piece_of_face();
  const auto own = piece[face_of(triangle)];
  // With t across and h along the normal, and bend b of the surface: |t|^2 <= 2 d h where the point is nearer than d,
  // and h <= b |t|^2 / 2 + deflection.
  const double most = 2 * std::abs(distance) * exact_.deflection() / (1 - kMostBend);
  const auto around = surface_.triangles_around(vertex);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
    const Vec3d foot = end - normal(t, vertex) * distance;
    return piece[face_of(t)] == own && (point - foot).lengthSqr() <= most;
  });
}

void ExactCorners::bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                      std::span<const double> at_corner, std::span<Vec3d> points) const {
  std::vector<std::uint32_t> of_mesh(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    of_mesh[i] = surface_.representative[vertices[i]];
    points[i] += surface_.origin;
  }
  exact_.bring_to_distances(of_mesh, distances, at_corner, points);
  for (Vec3d& point : points) point -= surface_.origin;
}

}  // namespace vdb_offset
