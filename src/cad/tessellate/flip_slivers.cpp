// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <unordered_map>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

// A triangle whose height is this share of its longest side has a direction of its own no more.
constexpr double kFlat = 1e-8;
constexpr int kMostPasses = 8;

/// Height over the longest side, as a share of that side; which side that is.
struct Shape {
  double height;
  std::size_t longest;
};

Shape shape_of(const BodyMesh& mesh, const FaceMesh& face, const Triangle& t) {
  const auto at = [&](std::size_t k) { return mesh.positions[face.nodes[t[k % 3]].vertex]; };
  double most = 0;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double length = at(k).SquareDistance(at(k + 1)); length > most) most = length, longest = k;
  const double area = gp_Vec(at(0), at(1)).Crossed(gp_Vec(at(0), at(2))).Magnitude();
  return {most > 0 ? area / most : 0, longest};
}

/// Whether a triangle looks to the face's outside, at each of its corners.
bool looks_outward(const BodyMesh& mesh, const FaceMesh& face, const Triangle& t) {
  const auto at = [&](std::size_t k) { return mesh.positions[face.nodes[t[k]].vertex]; };
  const gp_Vec across = gp_Vec(at(0), at(1)).Crossed(gp_Vec(at(0), at(2)));
  for (std::size_t k = 0; k < 3; ++k)
    if (!(across.Dot(corner_normal(mesh, face, t, k)) > 0)) return false;
  return true;
}

/// Whether a triangle can take the place of a flat one.
bool is_better(const BodyMesh& mesh, const FaceMesh& face, const Triangle& t) {
  return shape_of(mesh, face, t).height > kFlat && looks_outward(mesh, face, t);
}

/// One pass over a face; whether it changed anything.
bool flip_once(const BodyMesh& mesh, FaceMesh& face) {
  std::vector<std::size_t> flat;
  for (std::size_t t = 0; t < face.triangles.size(); ++t)
    if (shape_of(mesh, face, face.triangles[t]).height <= kFlat) flat.push_back(t);
  if (flat.empty()) return false;
  std::unordered_map<std::uint64_t, std::size_t> beside;  // triangles by their sides in their own direction
  const auto way = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; };
  for (std::size_t t = 0; t < face.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) beside[way(face.triangles[t][k], face.triangles[t][(k + 1) % 3])] = t;
  std::vector<std::uint8_t> is_changed(face.triangles.size(), 0);
  bool is_any = false;
  for (const std::size_t t : flat) {
    const Triangle own = face.triangles[t];
    const std::size_t k = shape_of(mesh, face, own).longest;
    const std::uint32_t c = own[k], a = own[(k + 1) % 3], b = own[(k + 2) % 3];
    const auto other = beside.find(way(a, c));
    if (other == beside.end() || is_changed[t] || is_changed[other->second]) continue;
    const Triangle& next = face.triangles[other->second];
    const auto d = std::find_if(next.begin(), next.end(), [&](std::uint32_t node) { return node != a && node != c; });
    const Triangle first{a, b, *d}, second{b, c, *d};
    const bool is_one = face.nodes[b].vertex == face.nodes[*d].vertex;
    if (is_one || !is_better(mesh, face, first) || !is_better(mesh, face, second)) continue;
    is_changed[t] = is_changed[other->second] = 1;
    face.triangles[other->second] = second;
    face.triangles[t] = first;
    is_any = true;
  }
  return is_any;
}

}  // namespace

void flip_slivers(BodyMesh& mesh) {
  for (FaceMesh& face : mesh.faces)
    for (int pass = 0; pass < kMostPasses && flip_once(mesh, face); ++pass) {
    }
}

}  // namespace vdb_offset::cad
