// SPDX-License-Identifier: Apache-2.0
#include "products/fill/check_front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ground/mesh/exact_predicates.h"
#include "ground/numbers/disjoint_sets.h"
#include "space/surface/surface.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

double six_volumes_below(std::span<const Vec3d> points, const FrontTriangle& triangle, const Vec3d& origin) {
  const auto& [a, b, c] = triangle.corners;
  return (points[a] - origin).dot((points[b] - origin).cross(points[c] - origin));
}

}  // namespace

std::vector<TrianglePair> crossings_of(std::span<const Vec3d> points, std::span<const FrontTriangle> front) {
  Surface surface;
  for (const FrontTriangle& triangle : front) surface.triangles.push_back(triangle.corners);
  return CrossingFinder(surface, points).listed().pairs;
}

std::vector<std::array<std::uint32_t, 2>> open_edges(std::span<const FrontTriangle> front) {
  struct Side {
    std::array<std::uint32_t, 2> ends;  // the smaller one first
    bool is_forwards;
  };
  std::vector<Side> sides;
  sides.reserve(3 * front.size());
  for (const FrontTriangle& triangle : front)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle.corners[k], to = triangle.corners[(k + 1) % 3];
      sides.push_back({{std::min(from, to), std::max(from, to)}, from < to});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.ends < b.ends; });
  std::vector<std::array<std::uint32_t, 2>> open;
  for (std::size_t i = 0, next; i < sides.size(); i = next) {
    // Shells that touch along an edge have two pairs there.
    int surplus = 0;
    for (next = i; next < sides.size() && sides[next].ends == sides[i].ends; ++next)
      surplus += sides[next].is_forwards ? 1 : -1;
    const auto [a, b] = sides[i].ends;
    for (; surplus > 0; --surplus) open.push_back({b, a});
    for (; surplus < 0; ++surplus) open.push_back({a, b});
  }
  return open;
}

double six_volumes_inside(std::span<const Vec3d> points, std::span<const FrontTriangle> front) {
  double sum = 0;
  const Vec3d origin = front.empty() ? Vec3d(0.0) : points[front[0].corners[0]];
  for (const FrontTriangle& triangle : front) sum += six_volumes_below(points, triangle, origin);
  return sum;
}

bool is_enclosed(std::span<const Vec3d> points, std::span<const FrontTriangle> front) {
  DisjointSets shells(points.size());
  for (const FrontTriangle& triangle : front)
    for (std::size_t k = 0; k < 2; ++k) shells.join(triangle.corners[k], triangle.corners[k + 1]);
  std::vector<double> volume(points.size(), 0);
  for (const FrontTriangle& triangle : front)
    volume[shells.first(triangle.corners[0])] += six_volumes_below(points, triangle, points[front[0].corners[0]]);
  const auto largest =
      std::max_element(volume.begin(), volume.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return largest != volume.end() && *largest > 0;
}

void require_sound(std::span<const Vec3d> points, std::span<const FrontTriangle> front) {
  const auto place = [&](std::size_t triangle) {
    const auto& [a, b, c] = front[triangle].corners;
    const Vec3d middle = (points[a] + points[b] + points[c]) / 3;
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", middle[0], middle[1], middle[2]);
  };
  for (std::size_t t = 0; t < front.size(); ++t) {
    const auto& [a, b, c] = front[t].corners;
    if (has_no_area({points[a], points[b], points[c]}))
      throw FillFailed(fmt::format(
          "fill: expected faces with an area, got one without at {} (layers have no height there: remesh the "
          "wall, whose faces have none)",
          place(t)));
  }
  const std::vector<TrianglePair> crossings = crossings_of(points, front);
  if (crossings.empty()) return;
  throw FillFailed(fmt::format(
      "fill: expected a domain whose border does not cross itself, got {} pairs of faces that do, the first "
      "at {} and {} (where the input itself does so, --mode iso makes one that does not)",
      crossings.size(), place(crossings[0].first), place(crossings[0].second)));
}

}  // namespace vdb_offset
