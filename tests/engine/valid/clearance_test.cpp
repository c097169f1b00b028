// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "support/oracles.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// A slab whose upper side lies in the plane z = top.
Polygons slab(double top, int divisions) {
  Polygons mesh = shapes::box(Vec3d(4, 4, 1), divisions, true);
  for (Vec3d& p : mesh.positions) p[2] = p[2] > 0 ? top : top - 1;
  return mesh;
}

double lowest(const std::vector<Vec3d>& positions) {
  double least = positions[0][2];
  for (const Vec3d& p : positions) least = std::min(least, p[2]);
  return least;
}

double least_distance(const Polygons& mesh, const std::vector<Vec3d>& positions, const Polygons& other) {
  double least = 1e300;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::size_t g = 0; g < other.face_count(); ++g) {
      const auto a = mesh.view().face(f), b = other.view().face(g);
      least = std::min(least, distance_between({positions[a[0]], positions[a[1]], positions[a[2]]},
                                               {other.positions[b[0]], other.positions[b[1]], other.positions[b[2]]}));
    }
  return least;
}

/// What a run says of what it made is what is found in it.
void check_as_found(const Polygons& mesh, const OffsetResult& result, const OffsetOptions& options) {
  const CheckResult found =
      check_offset(mesh.view(), result.positions,
                   {.distance = options.distance, .obstacles = options.obstacles, .clearance = options.clearance});
  CHECK(found.faults.total() == result.statistics.limit.left.total());
  CHECK(found.source_crossings == result.statistics.limit.source_crossings);
  REQUIRE(found.obstacles);
  CHECK(found.obstacles->gap == result.statistics.obstacles->gap);
  CHECK(found.obstacles->starting_gap == result.statistics.obstacles->starting_gap);
  CHECK(found.obstacles->near == result.statistics.obstacles->near);
}

}  // namespace

TEST_CASE("clearance: what moves away from an obstacle that is too near is free", "[clearance]") {
  const Polygons sphere = shapes::icosphere(0.5, 3);
  const double pole = lowest(sphere.positions), start = 0.02;
  const Polygons below = slab(pole - start, 3);
  OffsetOptions options;
  options.obstacles = below.view();
  options.clearance = 0.1;
  options.distance = -0.05;
  const OffsetResult in = offset(sphere.view(), options);
  CHECK(test::share(in, VertexState::Reached) == 1);
  REQUIRE(in.statistics.obstacles);
  CHECK(in.statistics.obstacles->starting_gap == Approx(start).epsilon(1e-9));
  CHECK(in.statistics.obstacles->gap == Approx(lowest(in.positions) - pole + start).epsilon(1e-9));
  CHECK(in.statistics.obstacles->gap > start + 0.04);
  CHECK(in.statistics.obstacles->near > 0);
  check_as_found(sphere, in, options);
  // Outward, what is too near already stays, and all that has room goes.
  options.distance = 0.3;
  const OffsetResult out = offset(sphere.view(), options);
  CHECK(out.statistics.obstacles->gap == Approx(start).epsilon(1e-9));
  CHECK(out.statistics.limit.left.total() == 0);
  for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
    const double gap = sphere.positions[v][2] - pole + start;
    CHECK(out.positions[v][2] - pole + start >= std::min(gap, 0.1) * (1 - 1e-6));
    if (sphere.positions[v][2] > 0) CHECK(out.states[v] == VertexState::Reached);
  }
  check_as_found(sphere, out, options);
}

TEST_CASE("clearance: what rests on an obstacle may shrink off it, and does not grow through it", "[clearance]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 6, true), bed = slab(-0.5, 5);
  OffsetOptions options;
  options.obstacles = bed.view();
  for (const double clearance : {0.0, 0.05}) {
    INFO(clearance);
    options.clearance = clearance;
    options.distance = -0.1;
    const OffsetResult in = offset(box.view(), options);
    CHECK(test::share(in, VertexState::Reached) == 1);
    CHECK(in.statistics.obstacles->touching > 0);
    CHECK(in.statistics.obstacles->crossing == 0);
    CHECK(in.statistics.obstacles->starting_gap == 0);
    CHECK(in.statistics.obstacles->gap == Approx(0.1));
    CHECK(in.statistics.obstacles->near == 0);
    CHECK(in.statistics.limit.source_crossings == 0);
    for (std::size_t v = 0; v < box.positions.size(); ++v)
      for (int k = 0; k < 3; ++k)
        CHECK(in.positions[v][k] == Approx(std::clamp(box.positions[v][k], -0.4, 0.4)).margin(1e-9));
    check_as_found(box, in, options);
    options.distance = 0.1;
    const OffsetResult out = offset(box.view(), options);
    CHECK(out.statistics.limit.left.total() == 0);
    CHECK(lowest(out.positions) == -0.5);
    CHECK(out.statistics.obstacles->gap == 0);
    CHECK(out.statistics.obstacles->near > 0);
    for (std::size_t v = 0; v < box.positions.size(); ++v)
      if (box.positions[v][2] == 0.5) CHECK(out.positions[v][2] == Approx(0.6).epsilon(1e-9));
    check_as_found(box, out, options);
  }
}

TEST_CASE("clearance: what goes through an obstacle is told as that, at any distance", "[clearance]") {
  const Polygons sphere = shapes::icosphere(0.5, 3), through = slab(0.1, 7);
  OffsetOptions options;
  options.obstacles = through.view();
  for (const double distance : {0.0, 0.02}) {
    INFO(distance);
    options.distance = distance;
    const OffsetResult result = offset(sphere.view(), options);
    REQUIRE(result.statistics.obstacles);
    CHECK(result.statistics.obstacles->crossing > 0);
    CHECK(result.statistics.obstacles->gap == 0);
    CHECK(result.statistics.obstacles->near > 0);
    CHECK(result.statistics.limit.source_crossings == 0);
  }
}

TEST_CASE("clearance: at distance 0 the gap is told, too", "[clearance]") {
  const Polygons sphere = shapes::icosphere(0.5, 3), below = slab(-0.6, 2);
  OffsetOptions options;
  options.obstacles = below.view();
  options.distance = 0;
  for (const double clearance : {0.05, 0.2}) {
    options.clearance = clearance;
    const OffsetResult result = offset(sphere.view(), options);
    REQUIRE(result.statistics.obstacles);
    CHECK(result.statistics.obstacles->gap == Approx(lowest(sphere.positions) + 0.6).epsilon(1e-12));
    CHECK(result.statistics.obstacles->starting_gap == result.statistics.obstacles->gap);
    CHECK((result.statistics.obstacles->near > 0) == (clearance > 0.1));
    CHECK(result.positions == sphere.positions);
  }
}

TEST_CASE("clearance: the part of a box stands on a bed and slides along it", "[clearance]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 6, true), bed = slab(-0.5, 9);
  OffsetOptions options;
  options.obstacles = bed.view();
  options.clearance = 0.02;
  options.distance = -0.05;
  for (std::size_t f = 0; f < box.face_count(); ++f) {
    const auto corners = box.view().face(f);
    options.only.push_back(std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
      return std::any_of(corners.begin(), corners.end(),
                         [&](std::uint32_t w) { return box.positions[w][2] != box.positions[v][2]; });
    }));
  }
  const OffsetResult result = offset(box.view(), options);
  CHECK(result.statistics.limit.left.total() == 0);
  CHECK(test::share(result, VertexState::Reached) == 1);
  for (std::size_t v = 0; v < box.positions.size(); ++v)
    CHECK(result.positions[v][2] == Approx(box.positions[v][2]).margin(1e-12));
}

TEST_CASE("clearance: gaps of triangles are those of brute force", "[clearance][oracle]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.2, 3, 7, 2);
  std::mt19937 random(3);
  for (int i = 0; i < 6; ++i) {
    Polygons other = shapes::icosphere(0.3 + 0.1 * i, 2);
    const auto number = [&] { return std::uniform_real_distribution<double>(-2, 2)(random); };
    const Vec3d shift(number(), number(), number());
    for (Vec3d& p : other.positions) p += shift;
    OffsetOptions options;
    options.obstacles = other.view();
    options.distance = 0;
    const OffsetResult result = offset(mesh.view(), options);
    CHECK(result.statistics.obstacles->gap == Approx(least_distance(mesh, mesh.positions, other)).margin(1e-12));
  }
}
