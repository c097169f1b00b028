// SPDX-License-Identifier: Apache-2.0
// Finds the points of the source that an iso-surface takes its attributes from. A vertex takes those of its closest
// point, with barycentric weights that are exactly 0 off the feature that this lies on. A triangle takes those of the
// face that is closest to its centre. If the source is cut into charts (triangles that share an edge and the values at
// both of its ends), a corner whose closest point is in another chart than its triangle's walks over the triangle's
// chart, as long as a triangle with a common corner is nearer: so no seam runs inside of a triangle. That walk ends at
// a local minimum, and does not search the whole chart. Values are looked up and interpolated elsewhere
// (files/derived).
#include "products/iso/source_lookup.h"

#include <algorithm>
#include <numeric>

#include "ground/mesh/point_triangle.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "space/query/closest_query.h"

namespace vdb_offset {
namespace {

/// The barycentric coordinates of a triangle's closest point, which has zeros according to the feature that it lies on.
std::array<double, 3> weights_of(const TrianglePoint& closest, const std::array<Vec3d, 3>& corner) {
  std::array<double, 3> weight{};
  const auto feature = static_cast<std::size_t>(closest.feature);
  if (feature < 3) {
    weight[feature] = 1;
  } else if (closest.feature != Feature::Face) {
    const std::size_t from = feature - 3, to = (from + 1) % 3;
    const Vec3d edge = corner[to] - corner[from];
    const double share = std::clamp((closest.point - corner[from]).dot(edge) / edge.lengthSqr(), 0.0, 1.0);
    weight[from] = 1 - share;
    weight[to] = share;
  } else {
    const Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
      weight[k] = std::max(0.0, normal.dot((b - a).cross(closest.point - a)));
      sum += weight[k];
    }
    for (double& w : weight) w /= sum;
  }
  return weight;
}

}  // namespace

SourceLookup::SourceLookup(const IsoResult& iso, PolygonView mesh) : iso_(iso), mesh_(mesh) {
  const auto& corners = iso.polygons.corners;
  std::vector<Vec3d> centres(iso.polygons.face_count());
  for_each_index(centres.size(), [&](std::size_t t) {
    centres[t] = (local(corners[3 * t]) + local(corners[3 * t + 1]) + local(corners[3 * t + 2])) / 3.0;
  });
  const std::vector<Closest> closest = closest_points(iso.source->query, centres);
  home_.resize(centres.size());
  for_each_index(home_.size(), [&](std::size_t t) { home_[t] = iso.source->given(closest[t].triangle); });
}

/// The corner of the mesh's face that corner k of a triangle of the source comes from.
std::uint32_t SourceLookup::corner_at(std::uint32_t triangle, std::size_t k) const {
  const std::uint32_t face = source().face[triangle], vertex = source().triangles[triangle][k];
  std::uint32_t corner = mesh_.face_begin[face];
  while (source().welded[mesh_.corners[corner]] != vertex) ++corner;
  return corner;
}

void SourceLookup::cut_into_charts(std::span<const std::uint32_t> value_of_corner) {
  VDB_OFFSET_ASSERT(value_of_corner.size() == mesh_.corners.size());
  DisjointSets charts(source().triangles.size());
  for (std::uint32_t edge = 0; edge < source().next_around_edge.size(); ++edge) {
    const std::uint32_t t = edge / 3, k = edge % 3;
    const std::uint32_t at_from = value_of_corner[corner_at(t, k)], at_to = value_of_corner[corner_at(t, (k + 1) % 3)];
    for (std::uint32_t other = source().next_around_edge[edge]; other != edge;
         other = source().next_around_edge[other]) {
      if (other < edge) continue;  // seen from there
      std::uint32_t there = value_of_corner[corner_at(other / 3, other % 3)],
                    there_to = value_of_corner[corner_at(other / 3, (other % 3 + 1) % 3)];
      if (source().from(other) != source().from(edge)) std::swap(there, there_to);
      if (there == at_from && there_to == at_to) charts.join(other / 3, t);
    }
  }
  chart_ = std::move(charts).firsts();
}

SourcePoint SourceLookup::point_on(std::uint32_t triangle, const Vec3d& x) const {
  std::array<Vec3d, 3> corner;
  SourcePoint point{source().face[triangle]};
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = source().vertices[source().triangles[triangle][k]];
    point.corner[k] = corner_at(triangle, k);
  }
  point.weight = weights_of(source().closest_on(triangle, x), corner);
  return point;
}

SourcePoint SourceLookup::at_vertex(std::uint32_t vertex) const {
  return point_on(iso_.closest[vertex], local(vertex));
}

/// Goes over the chart from triangle to triangle, as long as one with a common corner is nearer.
std::uint32_t SourceLookup::closest_in_chart(const Vec3d& x, std::uint32_t start) const {
  std::uint32_t best = start;
  double least = source().closest_on(start, x).squared_distance;
  for (bool moved = true; moved;) {
    moved = false;
    const std::array around = source().triangles[best];
    for (const auto v : around)
      for (const auto t : source().triangles_around(v)) {
        if (chart_[t] != chart_[start]) continue;
        const double squared = source().closest_on(t, x).squared_distance;
        if (squared >= least) continue;
        least = squared;
        best = t;
        moved = true;
      }
  }
  return best;
}

SourcePoint SourceLookup::at_corner(std::size_t triangle, std::size_t k) const {
  const std::uint32_t vertex = iso_.polygons.corners[3 * triangle + k], home = home_[triangle],
                      closest = iso_.closest[vertex];
  const Vec3d x = local(vertex);
  const bool across_seam = !chart_.empty() && chart_[closest] != chart_[home];
  return point_on(across_seam ? closest_in_chart(x, home) : closest, x);
}

}  // namespace vdb_offset
