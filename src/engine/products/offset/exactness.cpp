// SPDX-License-Identifier: Apache-2.0
#include "products/offset/exactness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace vdb_offset {
namespace {

/// Whether a place on a triangle is on a sharp edge of the model, or at a corner of it.
bool is_on_sharp_edge(const Surface& surface, const ExactCorners& exact, std::uint32_t triangle, Feature feature) {
  const auto& corners = surface.triangles[triangle];
  if (feature == Feature::Face) return false;
  if (feature < Feature::Edge0) return exact.is_sharp(corners[static_cast<std::size_t>(feature)]);
  const auto e = static_cast<std::size_t>(feature) - static_cast<std::size_t>(Feature::Edge0);
  return exact.is_sharp(corners[e]) && exact.is_sharp(corners[(e + 1) % 3]);
}

/// Whether the way from an edge of the part goes along its normal, as far as flat triangles show. Where it does not, as
/// over a face beside the part that leaves it at another angle, its end is at the distance from the edge alone.
bool is_across(const Vec3d& normal, const Vec3d& way) {
  constexpr double kLeastCosine = 0.97;  // 14 degrees: normals of neighbours differ by 15
  return std::abs(normal.dot(way)) >= kLeastCosine * way.length();
}

/// Points of a result, and where on the model each belongs.
struct Measured {
  std::vector<std::uint32_t> of;  // vertices, or faces of the mesh
  std::vector<Vec3d> feet;        // on those faces
  std::vector<double> distances;
  std::vector<Vec3d> points;
};

void add(const std::vector<double>& errors, ExactFacts& facts) {
  facts.vertices += errors.size();
  for (const double error : errors) {
    facts.mean += error;
    facts.worst = std::max(facts.worst, error);
  }
}

}  // namespace

ExactFacts measure_exactness(const PreparedMesh& mesh, const PreparedMesh::Marched& marched,
                             const OffsetResult& result) {
  const ExactCorners& exact = *mesh.exact();
  const Surface& part = mesh.parts().moving_part;
  Measured along, near;
  for (std::uint32_t v = 0; v < result.states.size(); ++v) {
    if (result.distances[v] == 0 ||
        (result.states[v] != VertexState::Reached && result.states[v] != VertexState::Mitered))
      continue;
    const std::uint32_t w = mesh.surface().welded[v];
    Measured* to = &along;
    // Not from the faces that stay: those beside the part go on from where they are.
    const bool is_at_rim = !mesh.parts().at_border.empty() && mesh.parts().at_border[w];
    if (is_at_rim || !marched.mitered.is_miter(w, marched.paths.displacement[w])) {
      const std::uint32_t t = marched.paths.closest[w];
      const Vec3d point = result.positions[v] - part.origin;
      const TrianglePoint foot = part.closest_on(t, point);
      if (is_on_sharp_edge(part, exact, t, foot.feature)) continue;
      if (is_at_rim && foot.feature != Feature::Face && !is_across(part.triangle_normals[t], point - foot.point))
        continue;
      to = &near;
      near.feet.push_back(foot.point + part.origin);
      near.of.push_back(exact.face_of(t));
    } else {
      along.of.push_back(v);
    }
    to->distances.push_back(result.distances[v]);
    to->points.push_back(result.positions[v]);
  }
  const ExactSurface& surface = *mesh.options().exact;
  ExactFacts facts;
  add(surface.distance_errors(along.of, along.distances, result.distances.at_corner(), along.points), facts);
  add(surface.distance_errors_near(near.of, near.feet, near.distances, near.points), facts);
  facts.mean /= static_cast<double>(std::max<std::size_t>(1, facts.vertices));
  return facts;
}

}  // namespace vdb_offset
