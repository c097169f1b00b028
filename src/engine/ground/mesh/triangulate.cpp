// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/triangulate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ground/mesh/ear_clipper.h"

namespace vdb_offset {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

bool fan_turns_one_way(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, const Vec3d& area) {
  const Vec3d base = positions[polygon[0]];
  for (std::size_t k = 2; k < polygon.size(); ++k)
    if ((positions[polygon[k - 1]] - base).cross(positions[polygon[k]] - base).dot(area) < 0) return false;
  return true;
}

/// True if no corner is farther from the plane of the area vector than a thousandth of the polygon's size.
bool is_flat(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, const Vec3d& area) {
  double lowest = 0, highest = 0;
  for (const auto v : polygon) {
    const double height = (positions[v] - positions[polygon[0]]).dot(area);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  // Largest distance from the plane, as a share of the polygon's size: far above rounding, far below a visible bend.
  // Not measured.
  constexpr double kFlat = 1e-3;
  return highest - lowest <= kFlat * area.length() * std::sqrt(area.length());
}

/// The corners projected along the axis in which the area vector is largest, counter-clockwise.
std::vector<Point2> project(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                            const Vec3d& area) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(area[k]) > std::abs(area[axis])) axis = k;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (area[axis] < 0) std::swap(u, v);
  std::vector<Point2> flat;
  flat.reserve(polygon.size());
  for (const auto i : polygon) {
    const Vec3d p = positions[i] - positions[polygon[0]];
    flat.push_back({p[u], p[v]});
  }
  return flat;
}

/// Splits a flat polygon by clipping ears.
void clip(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, std::vector<Triangle>& triangles) {
  for (const auto& [a, b, c] : clip_ears(project(positions, polygon, area_vector(positions, polygon))))
    triangles.push_back({polygon[a], polygon[b], polygon[c]});
}

/// The least height of triangles, each as a share of its longest side; below 0 of one that faces against `area`.
double least_height(std::span<const Vec3d> positions, std::span<const Triangle> triangles, const Vec3d& area) {
  const double whole = area.length();
  double least = 1;
  for (const auto& [a, b, c] : triangles) {
    const Vec3d ab = positions[b] - positions[a], bc = positions[c] - positions[b], ca = positions[a] - positions[c];
    const double longest = std::max({ab.lengthSqr(), bc.lengthSqr(), ca.lengthSqr()});
    least = std::min(least, longest > 0 && whole > 0 ? ab.cross(bc).dot(area) / (whole * longest) : 0);
  }
  return least;
}

/// The fan around the first corner, or ears where that does not cover a flat polygon once.
void split(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, const Vec3d& area,
           std::vector<Triangle>& triangles) {
  const auto is_fan = [&] {
    return !is_flat(positions, polygon, area) ||
           (polygon.size() <= kLargePolygon && fan_turns_one_way(positions, polygon, area));
  };
  if (polygon.size() > 4 && !is_fan()) return clip(positions, polygon, triangles);
  for (std::size_t k = 2; k < polygon.size(); ++k) triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
}

}  // namespace

Vec3d area_vector(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon) {
  Vec3d sum(0.0);
  const Vec3d base = positions[polygon[0]];
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += (positions[polygon[k - 1]] - base).cross(positions[polygon[k]] - base);
  return sum;
}

void triangulate(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                 std::vector<Triangle>& triangles) {
  // Height, as a share of the longest side, below which a triangle is a line, as in is_needle(). Other programs take
  // the fan: where its triangles have an area, faces that are valid here have to be valid there.
  constexpr double kLine = 1e-12;
  if (polygon.size() == 3) return triangles.push_back({polygon[0], polygon[1], polygon[2]});
  const auto first = static_cast<std::ptrdiff_t>(triangles.size());
  const Vec3d area = area_vector(positions, polygon);
  split(positions, polygon, area, triangles);
  const double height = least_height(positions, std::span(triangles).subspan(static_cast<std::size_t>(first)), area);
  if (std::abs(height) >= kLine || !is_flat(positions, polygon, area)) return;
  std::vector<Triangle> others;
  if (polygon.size() > 4) clip(positions, polygon, others);
  else others = {{polygon[1], polygon[2], polygon[3]}, {polygon[1], polygon[3], polygon[0]}};
  if (!(least_height(positions, others, area) > std::max(0.0, height))) return;
  triangles.erase(triangles.begin() + first, triangles.end());
  triangles.insert(triangles.end(), others.begin(), others.end());
}

void append_triangles(PolygonView mesh, std::size_t face, std::vector<Triangle>& triangles) {
  if (mesh.triangles.empty()) return triangulate(mesh.positions, mesh.face(face), triangles);
  const auto given = mesh.triangles_of(face);
  triangles.insert(triangles.end(), given.begin(), given.end());
}

std::vector<Triangle> split_polygons(PolygonView mesh) {
  std::vector<Triangle> triangles(mesh.corners.size() - 2 * mesh.face_count());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.face_count(), 1024), [&](const auto& range) {
    std::vector<Triangle> of_face;
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      of_face.clear();
      append_triangles(mesh, f, of_face);
      std::copy(of_face.begin(), of_face.end(),
                triangles.begin() + static_cast<std::ptrdiff_t>(mesh.face_begin[f] - 2 * f));
    }
  });
  return triangles;
}

}  // namespace vdb_offset
