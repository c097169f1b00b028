// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/ridge_path.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/oracles.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

OffsetResult merged(PolygonView mesh, double distance, double voxel_size) {
  OffsetOptions options;
  options.distance = distance;
  options.collision = Collision::Merge;
  options.corners = Corners::Round;
  options.grid.voxel_size = voxel_size;
  return offset(mesh, options);
}

Vec3d clamped(const Vec3d& x, double half) {
  return {std::clamp(x[0], -half, half), std::clamp(x[1], -half, half), std::clamp(x[2], -half, half)};
}

double worst_apart(std::span<const Vec3d> a, std::span<const Vec3d> b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).length());
  return worst;
}

struct Tetrahedron {
  std::array<Vec3d, 4> corner;

  Vec3d normal(std::size_t k) const {  // of the face across from corner k, outward
    const Vec3d &a = corner[(k + 1) % 4], &b = corner[(k + 2) % 4], &c = corner[(k + 3) % 4];
    const Vec3d n = (b - a).cross(c - a).unit();
    return n.dot(corner[k] - a) > 0 ? -n : n;
  }
  /// The tetrahedron with each face moved inward by a distance.
  Tetrahedron inset(double distance) const {
    Tetrahedron inner;
    for (std::size_t k = 0; k < 4; ++k) {
      // Where the planes of the other three faces meet.
      const Vec3d a = normal((k + 1) % 4), b = normal((k + 2) % 4), c = normal((k + 3) % 4);
      const double volume = a.dot(b.cross(c));
      const auto height = [&](const Vec3d& n) { return n.dot(corner[k]) - distance; };
      inner.corner[k] = (b.cross(c) * height(a) + c.cross(a) * height(b) + a.cross(b) * height(c)) / volume;
    }
    return inner;
  }
  Polygons mesh(int n) const {
    Polygons mesh;
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<std::size_t, 3> of{(k + 1) % 4, (k + 2) % 4, (k + 3) % 4};
      std::sort(of.begin(), of.end());  // so that points on edges have the same bytes on both sides
      const bool turned = (corner[of[1]] - corner[of[0]]).cross(corner[of[2]] - corner[of[0]]).dot(normal(k)) < 0;
      const auto add = [&](std::array<std::array<int, 2>, 3> at) {
        if (turned) std::swap(at[1], at[2]);
        for (const auto& [i, j] : at) {
          mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
          mesh.positions.push_back((corner[of[0]] * (n - i - j) + corner[of[1]] * i + corner[of[2]] * j) / n);
        }
        mesh.close_face();
      };
      for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
          add({{{i, j}, {i + 1, j}, {i, j + 1}}});
          if (i + j + 1 < n) add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
        }
    }
    return mesh;
  }
};

}  // namespace

TEST_CASE("ridges: whatever the grid, the cube's vertices arrive where the smaller cube is closest",
          "[ridges][no_races]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 20, true);
  for (const double h : {0.1, 0.025, 0.004}) {
    const OffsetResult result = merged(cube.view(), -0.1, h);
    CHECK(test::share(result, VertexState::Reached) == 1);
    CHECK(test::position_errors(cube.view(), result, [](const Vec3d& x) { return clamped(x, 0.15); }).worst < 1e-11);
  }
}

TEST_CASE("ridges: a tetrahedron's corners and edges arrive on those of the smaller one", "[ridges]") {
  const Tetrahedron outer{{Vec3d(0, 0, 0), Vec3d(1, 0.1, 0), Vec3d(0.2, 0.9, 0.1), Vec3d(0.3, 0.3, 0.8)}};
  constexpr double kDistance = 0.08;
  const Tetrahedron inner = outer.inset(kDistance);
  const Polygons mesh = outer.mesh(12);
  const OffsetResult result = merged(mesh.view(), -kDistance, 0.02);
  CHECK(test::share(result, VertexState::Reached) == 1);
  int corners = 0, on_edges = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d &from = mesh.positions[v], &to = result.positions[v];
    for (std::size_t k = 0; k < 4; ++k) {
      if ((from - outer.corner[k]).length() < 1e-12) {
        ++corners;
        CHECK((to - inner.corner[k]).length() < 1e-11);
      }
      for (std::size_t i = k + 1; i < 4; ++i) {
        const Vec3d along = (outer.corner[i] - outer.corner[k]).unit();
        const double at = along.dot(from - inner.corner[k]);
        const bool on_edge = (from - outer.corner[k]).cross(along).length() < 1e-12;
        if (!on_edge || at < 0 || at > along.dot(inner.corner[i] - inner.corner[k])) continue;
        ++on_edges;
        CHECK((to - inner.corner[k] - along * at).length() < 1e-11);
      }
    }
  }
  CHECK(corners >= 12);
  CHECK(on_edges > 60);
  CHECK(worst_apart(result.positions, merged(mesh.view(), -kDistance, 0.1).positions) < 1e-11);
}

TEST_CASE("ridges: from a corner whose third face falls behind, the way goes along the other two", "[ridges]") {
  const std::array<Vec3d, 3> inward{Vec3d(std::sqrt(0.75), 0.5, 0), Vec3d(-std::sqrt(0.75), 0.5, 0),
                                    Vec3d(0, 0.684, 0.729).unit()};
  Tetrahedron solid{{Vec3d(0.0)}};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d along = inward[(k + 1) % 3].cross(inward[(k + 2) % 3]).unit();
    solid.corner[k + 1] = along.dot(inward[k]) < 0 ? -along : along;
  }
  const Polygons mesh = solid.mesh(6);
  for (const double h : {0.1, 0.02, 0.005}) {
    const OffsetResult result = merged(mesh.view(), -0.02, h);
    int corners = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (mesh.positions[v].length() > 1e-12) continue;
      ++corners;
      CHECK((result.positions[v] - Vec3d(0, 0.04, 0)).length() < 1e-11);
    }
    CHECK(corners == 3);
  }
}

TEST_CASE("ridges: planes may be as rough as seven digits leave them", "[ridges][no_races]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 10, true);
  const Vec3d axis = Vec3d(1, 2, 3).unit();
  const auto turned = [&](const Vec3d& p, double angle) {
    return p * std::cos(angle) + axis.cross(p) * std::sin(angle) + axis * (axis.dot(p) * (1 - std::cos(angle)));
  };
  for (const double distance : {-0.1, -0.02, -0.3})
    for (const double h : {0.05, 0.0125}) {
      Polygons rough = cube;
      for (Vec3d& p : rough.positions) {
        p = turned(p, 0.5);
        for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(p[k]);
      }
      const OffsetResult result = merged(rough.view(), distance, h);
      const double inner = std::max(0.0, 0.25 + distance);
      for (std::size_t v = 0; v < cube.positions.size(); ++v)
        CHECK((turned(result.positions[v], -0.5) - clamped(cube.positions[v], inner)).length() < 1e-6);
      CHECK(test::share(result, inner > 0 ? VertexState::Reached : VertexState::Collision) == 1);
      CHECK(test::judge(rough.view(), result, distance, 7, true).worst_reached <= 1e-6);
    }
}

TEST_CASE("ridges: a component beside it that is curved goes its own way", "[ridges]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 10, true), sphere = shapes::bumpy_sphere(0.5, 0.2, 2, 3, 3);
  Polygons both = cube;
  for (const Vec3d& p : sphere.positions) both.positions.push_back(p + Vec3d(4, 0, 0));
  for (std::size_t f = 0; f < sphere.face_count(); ++f) {
    for (const auto v : sphere.view().face(f))
      both.corners.push_back(v + static_cast<std::uint32_t>(cube.positions.size()));
    both.close_face();
  }
  const OffsetResult result = merged(both.view(), -0.1, 0.05);
  for (std::size_t v = 0; v < cube.positions.size(); ++v)
    CHECK((result.positions[v] - clamped(cube.positions[v], 0.15)).length() < 1e-11);
  CHECK(result.statistics.straight_vertices == 0);
  CHECK(test::judge(both.view(), result, -0.1, 17, true).worst_reached <= 1e-6);
}

TEST_CASE("ridges: where the distance rises no further ways end, whatever the grid", "[ridges]") {
  const Polygons slab = shapes::box(Vec3d(1, 1, 0.1), 10, true), cube = shapes::box(Vec3d(0.5), 10, true);
  for (const double h : {0.08, 0.02}) {
    const OffsetResult flat = merged(slab.view(), -0.08, h);
    CHECK(test::share(flat, VertexState::Collision) == 1);
    for (std::size_t v = 0; v < slab.positions.size(); ++v) {
      const Vec3d in = clamped(slab.positions[v], 0.45);
      CHECK((flat.positions[v] - Vec3d(in[0], in[1], 0)).length() < 1e-11);
      CHECK(flat.achieved[v] == Approx(0.05).epsilon(1e-9));
    }
    const OffsetResult point = merged(cube.view(), -0.3, h);
    CHECK(test::share(point, VertexState::Collision) == 1);
    for (const Vec3d& p : point.positions) CHECK(p.length() < 1e-11);
  }
}

TEST_CASE("ridges: what is told of solids with plane faces is so, however they lie", "[ridges][property][no_races]") {
  const Polygons solids[] = {
      shapes::hollow_box(1, 0.15, 8), shapes::gear(7, 0.3, 0.5, 0.1, 0.2, 3), shapes::box(Vec3d(1, 0.4, 0.2), 9, true),
      shapes::box(Vec3d(0.3, 0.7, 1.1), 7, false),
      Tetrahedron{{Vec3d(0, 0, 0), Vec3d(1, 0, 0.1), Vec3d(0.3, 0.2, 0.9), Vec3d(0.2, 1, 0)}}.mesh(9)};
  const Vec3d axis = Vec3d(1, 2, 3).unit();
  const auto turned = [&](const Vec3d& p) {  // by half a radian
    return p * std::cos(0.5) + axis.cross(p) * std::sin(0.5) + axis * (axis.dot(p) * (1 - std::cos(0.5)));
  };
  for (const Polygons& solid : solids)
    for (const double distance : {-0.02, -0.06, -0.14, 0.03, 0.2}) {
      INFO(solid.positions.size() << " points, " << distance);
      Polygons mesh = solid;
      for (Vec3d& p : mesh.positions) p = turned(p);
      const OffsetResult result = merged(mesh.view(), distance, 0.04);
      const auto errors = test::judge(mesh.view(), result, distance, 3, true);
      CHECK(errors.worst_reached <= 1e-6);
      CHECK(errors.worst_beyond <= 1e-6);
      CHECK(errors.worst_told <= 1e-9);
      CHECK(errors.wrong_side == 0);
    }
}

TEST_CASE("ridges: obstacles are met as on any way", "[ridges]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 10, true);
  const Polygons inside = shapes::icosphere(0.2, 3);
  OffsetOptions options;
  options.distance = -0.1;
  options.collision = Collision::Merge;
  options.corners = Corners::Round;
  options.obstacles = inside.view();
  const OffsetResult result = offset(cube.view(), options);
  for (const Vec3d& p : result.positions) CHECK(p.length() >= 0.2 * 0.98);
  CHECK(test::share(result, VertexState::Reached) < 1);
}

TEST_CASE("ridges: a square's points arrive on the smaller square, open or closed", "[ridges]") {
  const auto square = [](bool closed) {
    Polygons curve;
    constexpr int kSide = 10;
    const double corner[][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int s = 0; s < 4; ++s)
      for (int i = 0; i < kSide; ++i) {
        const double u = static_cast<double>(i) / kSide;
        const auto &a = corner[s], &b = corner[(s + 1) % 4];
        curve.positions.emplace_back(a[0] + (b[0] - a[0]) * u, a[1] + (b[1] - a[1]) * u, 0);
      }
    for (std::uint32_t i = 0; i < curve.positions.size(); ++i) curve.corners.push_back(i);
    if (closed) curve.corners.push_back(0);
    curve.close_face();
    return curve;
  };
  OffsetOptions options;
  options.collision = Collision::Merge;
  options.corners = Corners::Round;
  const Distances distance(-0.3);
  const Polygons closed = square(true);
  const OffsetResult result = std::move(offset_curves(closed.view(), {&distance, 1}, options).front());
  for (std::size_t v = 0; v < closed.positions.size(); ++v) {
    const Vec3d& x = closed.positions[v];
    CHECK((result.positions[v] - Vec3d(std::clamp(x[0], -0.7, 0.7), std::clamp(x[1], -0.7, 0.7), 0)).length() < 1e-11);
  }
  CHECK(test::share(offset_curves(square(false).view(), {&distance, 1}, options).front(), VertexState::Reached) > 0.9);
}
