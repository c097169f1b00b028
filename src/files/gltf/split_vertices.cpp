// SPDX-License-Identifier: Apache-2.0
#include "gltf/split_vertices.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ground/mesh/triangulate.h"

namespace vdb_offset::io::gltf {
namespace {

// How far from 1 the length of a normal may be to be kept as it is. Reasoned: far above the rounding of single
// precision, and below what is seen.
constexpr double kOffLength = 1e-4;

Vec3d of_unit_length(const Vec3d& normal) {
  const double length = normal.length();
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1};
  return std::abs(length - 1) <= kOffLength ? normal : normal / length;
}

Vec3d face_normal(PolygonView mesh, std::size_t f) {
  const auto face = mesh.face(f);
  Vec3d sum(0.0);
  for (std::size_t k = 2; k < face.size(); ++k)
    sum += (mesh.positions[face[k - 1]] - mesh.positions[face[0]])
               .cross(mesh.positions[face[k]] - mesh.positions[face[0]]);
  return of_unit_length(sum);
}

/// What a corner needs its vertex to have.
struct Wanted {
  Vec3d normal{0.0};
  Vec2d uv{0.0};
  bool operator==(const Wanted& other) const { return normal == other.normal && uv == other.uv; }
};

class Splitting {
 public:
  Splitting(const Content& content, SplitVertices& made)
      : mesh_(content.mesh),
        with_(content.with),
        made_(made),
        known_(mesh_.positions.size(), 0),
        next_(known_.size(), kNone) {
    for (std::uint32_t v = 0; v < known_.size(); ++v) made_.origin.push_back(v);
    if (!with_.normals.empty()) made_.normals.assign(known_.size(), Vec3d(0, 0, 1));
    if (!with_.texture.empty()) made_.texture.assign(known_.size(), Vec2d(0.0));
  }

  /// The vertex for a corner of a face: the mesh's own for the first, then one that has what the corner has, or a copy.
  std::uint32_t vertex_of(std::size_t face, std::size_t corner) {
    const std::uint32_t v = mesh_.corners[corner];
    const Wanted wanted = wanted_at(face, corner);
    if (!known_[v]) {
      known_[v] = 1;
      return set(v, wanted);
    }
    std::uint32_t at = v;
    for (; !(has(at) == wanted); at = next_[at])
      if (next_[at] == kNone) return copy(at, v, wanted);
    return at;
  }

 private:
  Wanted wanted_at(std::size_t face, std::size_t corner) const {
    Wanted wanted;
    const std::uint32_t v = mesh_.corners[corner];
    if (!with_.normals.empty()) {
      const std::uint32_t n = with_.normals.index(corner, v);
      wanted.normal = n == kNoNormal ? face_normal(mesh_, face) : of_unit_length(with_.normals.value[n]);
    }
    if (!with_.texture.empty())
      if (const std::uint32_t t = with_.texture.index(corner, v); t != kNoNormal) wanted.uv = with_.texture.value[t];
    return wanted;
  }

  Wanted has(std::uint32_t at) const {
    return {made_.normals.empty() ? Vec3d(0.0) : made_.normals[at],
            made_.texture.empty() ? Vec2d(0.0) : made_.texture[at]};
  }

  std::uint32_t set(std::uint32_t at, const Wanted& wanted) {
    if (!made_.normals.empty()) made_.normals[at] = wanted.normal;
    if (!made_.texture.empty()) made_.texture[at] = wanted.uv;
    return at;
  }

  std::uint32_t copy(std::uint32_t last, std::uint32_t v, const Wanted& wanted) {
    const auto at = static_cast<std::uint32_t>(made_.origin.size());
    next_[last] = at;
    next_.push_back(kNone);
    made_.origin.push_back(v);
    if (!made_.normals.empty()) made_.normals.emplace_back();
    if (!made_.texture.empty()) made_.texture.emplace_back();
    return set(at, wanted);
  }

  PolygonView mesh_;
  const Attributes& with_;
  SplitVertices& made_;
  std::vector<std::uint8_t> known_;  ///< Of the mesh's vertices, whether a corner has said what they have.
  std::vector<std::uint32_t> next_;  ///< The next copy of the same vertex.
};

}  // namespace

SplitVertices::SplitVertices(const Content& content) {
  const PolygonView mesh = content.mesh;
  Splitting splitting(content, *this);
  std::vector<std::array<std::uint32_t, 3>> pieces;
  std::vector<std::uint32_t> made;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    triangle_begin.push_back(static_cast<std::uint32_t>(triangles.size()));
    const auto face = mesh.face(f);
    made.clear();
    for (std::size_t k = 0; k < face.size(); ++k) made.push_back(splitting.vertex_of(f, mesh.face_begin[f] + k));
    pieces.clear();
    append_triangles(mesh, f, pieces);
    for (const auto& piece : pieces) {
      auto& triangle = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = made[static_cast<std::size_t>(std::find(face.begin(), face.end(), piece[k]) - face.begin())];
    }
  }
  triangle_begin.push_back(static_cast<std::uint32_t>(triangles.size()));
}

}  // namespace vdb_offset::io::gltf
