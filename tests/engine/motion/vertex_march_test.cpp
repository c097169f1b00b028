// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/vertex_march.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "space/field/rasterise.h"
#include "space/field/sweep.h"
#include "support/oracles.h"
#include "support/solids.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// A mesh with its field, to `reach` on both sides.
struct MarchFixture {
  Polygons mesh;
  double h;
  Surface surface;
  ClosestQuery query;
  DistanceField field;
  DirectionField directions;

  MarchFixture(Polygons polygons, double voxel_size, double reach)
      : mesh(std::move(polygons)),
        h(voxel_size),
        surface(framed(mesh, h)),
        query(surface),
        field(sweep(rasterise(surface, {h, 1.01 * h}), surface, {Solver::Closest, {reach, reach}})),
        directions(make_directions(field, !surface.facts.closed())) {}

  static Surface framed(const Polygons& polygons, double voxel_size) {
    Surface made = build_surface(polygons.view(), {});
    to_local_frame(made, voxel_size);
    return made;
  }
  std::uint32_t vertex_nearest_to(const Vec3d& x) const {
    std::uint32_t nearest = 0;
    for (std::uint32_t v = 1; v < surface.vertices.size(); ++v)
      if ((world(surface.vertices[v]) - x).length() < (world(surface.vertices[nearest]) - x).length()) nearest = v;
    return nearest;
  }
  Vec3d world(const Vec3d& x) const { return x + surface.origin; }
  double exact(const Vec3d& x) const { return test::brute_force_distance(mesh.view(), x); }

  struct Told {
    std::vector<Vec3d> ends;  // in the order of the stops
    std::vector<Vec3d> trace;
    bool outside_field = false;
  };
  /// Where a vertex stops, world coordinates.
  Told march(std::uint32_t v, int side, std::initializer_list<double> distances, March how,
             const Obstacles* obstacles = nullptr) const {
    std::vector<StopDistance> stops;
    for (const double distance : distances) stops.push_back({distance, stops.size()});
    DirectionSampler sampler(directions);
    VertexMarch<ClosestQuery> march(query, directions, sampler, side, v, how, obstacles);
    march.keep_trace({});
    Told told;
    march.march(stops, [&](const StopDistance& stop, const Arrival& end) {
      CHECK(stop.set == told.ends.size());
      told.ends.push_back(world(end.position));
      told.outside_field = told.outside_field || end.outside_field;
    });
    told.trace = march.trace();
    REQUIRE(told.ends.size() == stops.size());
    return told;
  }
};

constexpr March kWays[] = {March::Exact, March::Fast};

}  // namespace

TEST_CASE("march: off a plane the path is straight, and ends at each distance", "[march][oracle]") {
  const MarchFixture plane(shapes::patch(2, 0, 20), 0.05, 0.5);
  for (const Vec3d& at : {Vec3d(0, 0, 0), Vec3d(0.3, -0.2, 0)})
    for (const int side : {1, -1})
      for (const March way : kWays) {
        const std::uint32_t v = plane.vertex_nearest_to(at);
        const Vec3d from = plane.world(plane.surface.vertices[v]);
        const auto told = plane.march(v, side, {0.003, 0.1, 0.1, 0.4}, way);
        const double expected[] = {0.003, 0.1, 0.1, 0.4};
        for (std::size_t i = 0; i < 4; ++i) {
          // phi is a float on the grid: its gradient is known to about 1e-6.
          CHECK((told.ends[i] - from - Vec3d(0, 0, side * expected[i])).length() < 1e-5 * expected[i]);
          CHECK(std::abs(told.ends[i][2]) == Approx(expected[i]).epsilon(kStopTolerance));
        }
        CHECK_FALSE(told.outside_field);
        REQUIRE(told.trace.size() > 1);
        for (std::size_t i = 0; i < told.trace.size(); ++i) {
          CHECK(std::hypot(told.trace[i][0], told.trace[i][1]) < 1e-5 * 0.4);
          if (i > 0) CHECK(std::abs(told.trace[i][2]) > std::abs(told.trace[i - 1][2]));
        }
      }
}

TEST_CASE("march: off a sphere the path is a radius, inward and outward", "[march][oracle]") {
  const MarchFixture sphere(shapes::icosphere(0.5, 4), 0.025, 0.3);
  for (const Vec3d& at : {Vec3d(1, 0, 0), Vec3d(0.3, -0.7, 0.5)})
    for (const int side : {1, -1})
      for (const March way : kWays)
        for (const double distance : {0.05, 0.25}) {
          const std::uint32_t v = sphere.vertex_nearest_to(at);
          const Vec3d from = sphere.world(sphere.surface.vertices[v]),
                      end = sphere.march(v, side, {distance}, way).ends[0];
          // Faces are up to 0.4 % of the radius inside of the sphere, and the gradient is smooth over two voxels.
          CHECK((end - from * (1 + side * distance / 0.5)).length() < 0.01 * distance);
          // Inward another face may be nearer than those that a fast march has looked at.
          if (way == March::Exact || side == 1) CHECK(sphere.exact(end) == Approx(distance).epsilon(1e-8));
          else CHECK(sphere.exact(end) <= distance * (1 + 1e-8));
        }
}

TEST_CASE("march: where the distance begins to fall the path ends: at the middle plane of a slab", "[march][oracle]") {
  constexpr double kThickness = 0.2, kVoxel = 0.02;
  const MarchFixture slab(shapes::box(Vec3d(1, 1, kThickness), 10, true), kVoxel, 0.2);
  const std::uint32_t v = slab.vertex_nearest_to(Vec3d(0.1, 0, kThickness / 2));
  const Vec3d from = slab.world(slab.surface.vertices[v]);
  const auto told = slab.march(v, -1, {0.05, 0.0999, 0.15, 0.18}, March::Exact);
  CHECK((told.ends[0] - from + Vec3d(0, 0, 0.05)).length() < 1e-6);
  CHECK((told.ends[1] - from + Vec3d(0, 0, 0.0999)).length() < 1e-6);
  for (const std::size_t i : {2u, 3u}) {
    // The two steps around the middle plane, of 0.75 voxels each, are narrowed down to a thousandth.
    CHECK((told.ends[i] - Vec3d(from[0], from[1], 0)).length() < 1e-3 * 2 * 0.75 * kVoxel);
    CHECK(slab.exact(told.ends[i]) == Approx(kThickness / 2).epsilon(1e-3));
  }
}

TEST_CASE("march: a path ends where it comes as near to an obstacle as it may", "[march][oracle]") {
  const MarchFixture plane(shapes::patch(2, 0, 20), 0.05, 0.5);
  constexpr double kPlateAt = 0.3, kClearance = 0.04;
  Polygons above = shapes::patch(2, 0, 4);
  for (Vec3d& p : above.positions) p[2] = kPlateAt;
  Surface plate = build_surface(above.view(), {});
  to_frame(plate, plane.surface.origin);
  const ClosestQuery to_plate(plate);
  const Obstacles obstacles{to_plate, kClearance};
  const std::uint32_t v = plane.vertex_nearest_to(Vec3d(0, 0, 0));
  for (const March way : kWays) {
    const auto told = plane.march(v, 1, {0.1, 0.25, 0.28, 0.4}, way, &obstacles);
    CHECK(told.ends[0][2] == Approx(0.1).epsilon(1e-8));
    CHECK(told.ends[1][2] == Approx(0.25).epsilon(1e-8));
    for (const std::size_t i : {2u, 3u}) CHECK(told.ends[i][2] == Approx(kPlateAt - kClearance).epsilon(1e-7));
    // Nothing is in the way on the other side.
    CHECK(plane.march(v, -1, {0.4}, way, &obstacles).ends[0][2] == Approx(-0.4).epsilon(1e-8));
  }
}

TEST_CASE("march: it goes on from a position on the path, but not from beyond a ridge", "[march][oracle]") {
  const MarchFixture slab(shapes::box(Vec3d(1, 1, 0.2), 10, true), 0.02, 0.2);
  const std::uint32_t v = slab.vertex_nearest_to(Vec3d(0.1, 0, 0.1));
  const Vec3d from = slab.surface.vertices[v];
  DirectionSampler sampler(slab.directions);
  const auto ends_from = [&](double depth, double distance) {
    VertexMarch<ClosestQuery> march(slab.query, slab.directions, sampler, -1, v, March::Fast);
    const Vec3d position = from - Vec3d(0, 0, depth);
    std::vector<Vec3d> ends;
    march.march_from(position, slab.query(position, 0).triangle, {distance, 0},
                     [&](const StopDistance&, const Arrival& end) { ends.push_back(end.position); });
    return ends;
  };
  const auto on = ends_from(0.05, 0.09);
  REQUIRE(on.size() == 1);
  CHECK((on[0] - from + Vec3d(0, 0, 0.09)).length() < 1e-6);
  CHECK(ends_from(0.12, 0.09).empty());
}

TEST_CASE("march: in a cube the ridges lead all vertices to the smaller cube", "[march][ridges][oracle]") {
  const MarchFixture cube(shapes::box(Vec3d(1), 8, true), 0.05, 0.3);
  DirectionSampler sampler(cube.directions);
  for (std::uint32_t v = 0; v < cube.surface.vertices.size(); ++v)
    for (const double distance : {0.1, 0.3}) {
      VertexMarch<ClosestQuery> march(cube.query, cube.directions, sampler, -1, v, March::Exact);
      const auto end = march.go_along_ridges(distance, 0);
      REQUIRE(end);
      const Vec3d x = cube.world(cube.surface.vertices[v]);
      Vec3d inside;
      for (int k = 0; k < 3; ++k) inside[k] = std::clamp(x[k], distance - 0.5, 0.5 - distance);
      CHECK((cube.world(end->position) - inside).length() < 1e-9);
      CHECK(end->distance == Approx(distance).epsilon(kStopTolerance));
    }
  // Faces that stand for a curved surface give no ridge to follow.
  const MarchFixture sphere(shapes::icosphere(0.5, 3), 0.05, 0.3);
  DirectionSampler of_sphere(sphere.directions);
  VertexMarch<ClosestQuery> march(sphere.query, sphere.directions, of_sphere, -1, 0, March::Exact);
  CHECK_FALSE(march.go_along_ridges(0.2, 0));
}

TEST_CASE("march: at the border of an open tube no path crosses the wall", "[march][border][oracle]") {
  const auto inside = [](const Vec3d& x) {
    return x[0] > 0 && x[1] > 0 && x[0] < 2 && x[1] < 2 && (x[0] < 1 || x[1] < 1);
  };
  const Polygons mesh = test::l_tube(10);
  for (const double distance : {0.15, 0.18, 0.2, 0.21, 0.25}) {
    const OffsetResult result = offset(mesh.view(), {.distance = -distance, .corners = Corners::Round});
    for (const Vec3d& end : result.positions) {
      CAPTURE(distance, end);
      CHECK(inside(end));
      CHECK(test::brute_force_distance(mesh.view(), end) == Approx(distance).epsilon(1e-8));
    }
  }
}
