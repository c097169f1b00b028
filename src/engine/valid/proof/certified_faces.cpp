// SPDX-License-Identifier: Apache-2.0
#include "valid/proof/certified_faces.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

/// What became of one face.
struct Verdict {
  double area = 0;  // in the source; 0 of a face that stays as a whole
  bool is_there = false, is_proven = false;
  double error = 0;  // beyond its tolerance, relative to the distance, of one that is not proven; 0: none was found
};

/// The largest error of a face that is beyond its tolerance, at points evenly spread over the face, relative to the
/// distance. 0 if there is none.
double largest_error(const CertifiedMesh& mesh, const OffsetTriangle& triangle) {
  constexpr int kRows = 12;  // of points; not measured
  double largest = 0;
  std::uint32_t hint = 0;
  for (int i = 0; i <= kRows; ++i)
    for (int j = 0; i + j <= kRows; ++j) {
      const std::array<int, 3> share{i, j, kRows - i - j};
      Vec3d x(0.0);
      double asked = 0, tolerance = 0, over_plane = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        x += triangle.corners[k] * (share[k] / static_cast<double>(kRows));
        asked += triangle.asked[k] * share[k] / kRows;
        tolerance += triangle.tolerance[k] * share[k] / kRows;
        over_plane += triangle.over_plane[k] * share[k] / kRows;
      }
      const Closest closest = mesh.query(x, hint);
      hint = closest.triangle;
      double off = closest.distance - asked;
      if (off > 0 && triangle.may_keep_to_plane) off = std::min(off, std::abs(over_plane - asked));
      if (std::abs(off) > tolerance) largest = std::max(largest, std::abs(off) / asked);
    }
  return largest;
}

Verdict judge(const CertifiedMesh& mesh, const OffsetProver& prover, const OffsetFace& face) {
  const auto of_corners = [&](auto&& predicate) {
    return std::all_of(face.vertex.begin(), face.vertex.end(), predicate);
  };
  if (of_corners([&](std::uint32_t v) { return mesh.asked[v] == 0; })) return {};
  Verdict verdict;
  const std::span<const Vec3d> measured = mesh.by_area_moved ? mesh.positions : mesh.source;
  const Vec3d& first = measured[face.vertex[0]];
  verdict.area = (measured[face.vertex[1]] - first).cross(measured[face.vertex[2]] - first).length() / 2;
  verdict.is_there = of_corners([&](std::uint32_t v) { return is_there(mesh.states[v]); });
  // Where the side changes no tolerance is given, as the distance is 0 somewhere.
  if (!of_corners([&](std::uint32_t v) { return mesh.asked[v] * mesh.asked[face.vertex[0]] > 0; })) return verdict;
  const OffsetTriangle triangle = offset_triangle(mesh, face);
  verdict.is_proven = verdict.is_there && face.source != kNone && prover(triangle).certainty == Certainty::Proven;
  if (!verdict.is_proven) verdict.error = largest_error(mesh, triangle);
  return verdict;
}

}  // namespace

OffsetTriangle offset_triangle(const CertifiedMesh& mesh, const OffsetFace& face) {
  OffsetTriangle triangle;
  const Vec3d normal = face.source == kNone ? Vec3d(0.0) : mesh.surface.triangle_normals[face.source];
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

CertifiedFaces certify(const CertifiedMesh& mesh, Progress* progress) {
  const OffsetProver prover(mesh.query);
  std::vector<Verdict> verdicts(mesh.faces.size());
  // Faces between two times that progress is reported: milliseconds. Not measured.
  constexpr std::size_t kFacesTold = 64;
  for_each_index((verdicts.size() + kFacesTold - 1) / kFacesTold,
                 [&](std::size_t block) {
                   const std::size_t begin = block * kFacesTold, end = std::min(verdicts.size(), begin + kFacesTold);
                   for (std::size_t f = begin; f < end; ++f) verdicts[f] = judge(mesh, prover, mesh.faces[f]);
                   if (progress) progress->advance(end - begin);
                 },
                 1);
  CertifiedFaces result;
  double area = 0;
  for (const Verdict& verdict : verdicts) {
    area += verdict.area;
    if (verdict.is_there) result.there += verdict.area;
    if (verdict.is_proven) result.certified += verdict.area;
    if (verdict.is_there) result.worst_left = std::max(result.worst_left, verdict.error);
    result.worst = std::max(result.worst, verdict.error);
  }
  if (!(area > 0)) return result;
  result.there /= area;
  result.certified /= area;
  return result;
}

}  // namespace vdb_offset
