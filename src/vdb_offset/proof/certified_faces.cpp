// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/proof/certified_faces.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

/// What became of one face.
struct Verdict {
  double area = 0;  // in the source; 0 of a face that stays as a whole
  bool is_there = false, is_proven = false;
  double error = 0;  // relative to the distance, of one that is there and not proven
};

Verdict judge(const CertifiedMesh& mesh, const OffsetProver& prover, const OffsetFace& face) {
  const auto& [a, b, c] = face.vertex;
  const auto of_corners = [&](auto&& predicate) {
    return std::all_of(face.vertex.begin(), face.vertex.end(), predicate);
  };
  if (of_corners([&](std::uint32_t v) { return mesh.asked[v] == 0; })) return {};
  Verdict verdict;
  const auto& at = mesh.source;
  verdict.area = (at[b] - at[a]).cross(at[c] - at[a]).length() / 2;
  verdict.is_there = of_corners([&](std::uint32_t v) { return is_there(mesh.states[v]); });
  // Where the side changes no tolerance is told, as the distance is 0 somewhere.
  if (!verdict.is_there || !of_corners([&](std::uint32_t v) { return mesh.asked[v] * mesh.asked[a] > 0; }))
    return verdict;
  const OffsetTriangle triangle = offset_triangle(mesh, face);
  const Proof proof = prover(triangle);
  verdict.is_proven = proof.certainty == Certainty::Proven;
  verdict.error = proof.error / *std::max_element(triangle.asked.begin(), triangle.asked.end());
  return verdict;
}

}  // namespace

OffsetTriangle offset_triangle(const CertifiedMesh& mesh, const OffsetFace& face) {
  OffsetTriangle triangle;
  const Vec3d& normal = mesh.surface.triangle_normals[face.source];
  triangle.may_keep_to_plane = mesh.corners == Corners::Miter && normal.lengthSqr() > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = face.vertex[k];
    triangle.corners[k] = mesh.positions[v] - mesh.surface.origin;
    triangle.asked[k] = std::abs(mesh.asked[v]);
    triangle.tolerance[k] = mesh.tolerance[v];
    triangle.over_plane[k] = normal.dot(mesh.positions[v] - mesh.source[face.vertex[0]]) * (mesh.asked[v] < 0 ? -1 : 1);
  }
  return triangle;
}

CertifiedFaces certify(const CertifiedMesh& mesh) {
  const OffsetProver prover(mesh.query);
  std::vector<Verdict> verdicts(mesh.faces.size());
  for_each_index(
      verdicts.size(), [&](std::size_t f) { verdicts[f] = judge(mesh, prover, mesh.faces[f]); }, 16);
  CertifiedFaces result;
  double area = 0;
  for (const Verdict& verdict : verdicts) {
    area += verdict.area;
    if (verdict.is_there) result.there += verdict.area;
    if (verdict.is_proven) result.certified += verdict.area;
    result.worst_left = std::max(result.worst_left, verdict.error);
  }
  if (!(area > 0)) return result;
  result.there /= area;
  result.certified /= area;
  return result;
}

}  // namespace vdb_offset
