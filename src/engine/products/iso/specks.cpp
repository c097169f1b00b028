// SPDX-License-Identifier: Apache-2.0
#include "products/iso/specks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset {
namespace {

/// For each vertex the vertex that stands for its piece.
std::vector<std::uint32_t> find_pieces(PolygonView mesh) {
  DisjointSets pieces(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (const auto v : mesh.face(f).subspan(1)) pieces.join(mesh.face(f)[0], v);
  return std::move(pieces).firsts();
}

/// The volume of each piece, by the vertex that stands for it; measured relative to that, so that specks far from the
/// origin lose no digits.
std::vector<double> find_volumes(PolygonView mesh, const std::vector<std::uint32_t>& piece) {
  std::vector<double> volume(mesh.positions.size(), 0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const Vec3d &origin = mesh.positions[piece[face[0]]], a = mesh.positions[face[0]] - origin;
    for (std::size_t k = 2; k < face.size(); ++k)
      volume[piece[face[0]]] +=
          a.dot((mesh.positions[face[k - 1]] - origin).cross(mesh.positions[face[k]] - origin)) / 6;
  }
  for (double& v : volume) v = std::abs(v);
  return volume;
}

}  // namespace

std::size_t drop_specks(Polygons& mesh, double volume) {
  const std::vector<std::uint32_t> piece = find_pieces(mesh.view());
  const std::vector<double> volumes = find_volumes(mesh.view(), piece);
  const auto largest = std::max_element(volumes.begin(), volumes.end()) - volumes.begin();
  const auto is_speck = [&](std::size_t v) { return volumes[v] < volume && static_cast<std::ptrdiff_t>(v) != largest; };
  std::vector<std::uint8_t> dropped(mesh.positions.size(), 0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    if (const std::uint32_t of = piece[mesh.corners[mesh.face_begin[f]]]; is_speck(of)) dropped[of] = 1;
  const auto count = static_cast<std::size_t>(std::count(dropped.begin(), dropped.end(), 1));
  if (count == 0) return 0;
  Polygons kept;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    if (dropped[piece[face[0]]]) continue;
    kept.corners.insert(kept.corners.end(), face.begin(), face.end());
    kept.close_face();
  }
  kept.positions = std::move(mesh.positions);
  mesh = std::move(kept);
  return count;
}

}  // namespace vdb_offset
