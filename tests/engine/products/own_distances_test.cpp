// SPDX-License-Identifier: Apache-2.0
// Faces that have distances of their own, at sharp edges.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/polygons.h"

using namespace vdb_offset;

namespace {

/// A cube from 0 to 4, with faces in the order -x, +x, -y, +y, -z, +z, each divided into `n` by `n` quads.
Polygons divided_cube(int n) {
  Polygons cube;
  const auto vertex = [&](const Vec3d& p) {
    const auto at = std::find(cube.positions.begin(), cube.positions.end(), p);
    if (at != cube.positions.end()) return static_cast<std::uint32_t>(at - cube.positions.begin());
    cube.positions.push_back(p);
    return static_cast<std::uint32_t>(cube.positions.size() - 1);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1})
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          std::vector<std::uint32_t> corners;
          for (const auto& [a, b] : {std::array{i, k}, {i + 1, k}, {i + 1, k + 1}, {i, k + 1}}) {
            Vec3d p;
            p[axis] = 4.0 * side;
            p[(axis + 1) % 3] = 4.0 * a / n;
            p[(axis + 2) % 3] = 4.0 * b / n;
            corners.push_back(vertex(p));
          }
          if (side == 0) std::reverse(corners.begin(), corners.end());
          cube.add_face({corners[0], corners[1], corners[2], corners[3]});
        }
  return cube;
}

Distances of_sides(const Polygons& cube, const std::array<double, 6>& of_side) {
  FaceDistances faces;
  const std::size_t quads = cube.face_count() / 6;
  for (std::size_t f = 0; f < cube.face_count(); ++f) {
    faces.part.push_back(static_cast<std::uint32_t>(f / quads));
    faces.at_corner.insert(faces.at_corner.end(), 4, of_side[f / quads]);
  }
  return vertex_distances(cube.view(), faces);
}

/// How far the vertices of the sides are from the planes that these move to, at most.
double off_planes(const Polygons& cube, std::span<const Vec3d> positions, const std::array<double, 6>& of_side) {
  double worst = 0;
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (std::size_t side = 0; side < 6; ++side) {
      const auto axis = static_cast<int>(side / 2);
      const double plane = side % 2 ? 4 : 0, outward = side % 2 ? 1 : -1;
      if (cube.positions[v][axis] != plane) continue;
      worst = std::max(worst, std::abs(positions[v][axis] - plane - outward * of_side[side]));
    }
  return worst;
}

}  // namespace

TEST_CASE("own distances: each face of a cube goes to its own plane, and others may stay") {
  for (const int n : {1, 3})
    for (const auto& sides : {std::array{0.5, 0.5, 0.5, 0.5, 0.5, 1.0},
                              {0.3, 0.4, 0.5, 0.6, 0.7, 0.8},
                              {-0.3, -0.4, -0.2, -0.6, -0.7, -0.8},
                              {0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
                              {0.2, 0.0, 0.3, 0.0, 0.4, 0.0}}) {
      const Polygons cube = divided_cube(n);
      OffsetOptions options;
      options.corners = Corners::Miter;
      options.distance = of_sides(cube, sides);
      const OffsetResult result = offset(cube.view(), options);
      CHECK(off_planes(cube, result.positions, sides) < 1e-9);
      CHECK(result.statistics.faces.mean < 1e-9);
      CHECK(result.statistics.limit.left.total() == 0);
      CheckOptions checking;
      checking.corners = Corners::Miter;
      checking.distance = options.distance;
      const CheckResult checked = check_offset(cube.view(), result.positions, checking);
      CHECK(checked.valid());
      CHECK(checked.faces.mean < 1e-9);
    }
}

TEST_CASE("own distances: with round corners, and with distances of both signs, vertices have the mean") {
  const Polygons cube = divided_cube(1);
  OffsetOptions options;
  options.corners = Corners::Round;
  options.distance = of_sides(cube, {0.5, 0.5, 0.5, 0.5, 0.5, 1.1});
  const OffsetResult round = offset(cube.view(), options);
  for (std::size_t v = 0; v < cube.positions.size(); ++v)
    CHECK(round.achieved[v] == Approx(cube.positions[v].z() == 4 ? 0.7 : 0.5));
  options.corners = Corners::Miter;
  options.distance = of_sides(cube, {0.5, 0.5, 0.5, 0.5, 0.5, -0.1});
  const OffsetResult both = offset(cube.view(), options);
  CHECK(both.statistics.limit.left.total() == 0);
  for (std::size_t v = 0; v < cube.positions.size(); ++v)
    if (cube.positions[v].z() == 4) CHECK(both.achieved[v] == Approx(0.3));
}
