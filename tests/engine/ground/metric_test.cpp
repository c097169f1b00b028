// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "ground/distances/in_metric.h"
#include "ground/numbers/rounding.h"
#include "products/iso/mend.h"
#include "space/surface/surface.h"
#include "support/oracles.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

Polygons in_space(const Polygons& mesh, const Metric& metric) {
  Polygons all = mesh;
  for (Vec3d& p : all.positions) p = metric.to(p);
  return all;
}

OffsetOptions axis_options(double xy, double z) {
  OffsetOptions options;
  options.distance = xy;
  options.metric = Metric::of_half_axes(xy, z);
  return options;
}

}  // namespace

TEST_CASE("metric: a cube goes to the box whose planes are as far as their axes", "[metric]") {
  const Polygons cube = shapes::box(Vec3d(1, 1, 1), 10, true);
  for (const Collision collision : {Collision::Merge, Collision::Limit}) {
    OffsetOptions options = axis_options(-0.1, -0.3);
    options.collision = collision;
    const OffsetResult in = offset(cube.view(), options);
    CHECK(test::share(in, VertexState::Reached) == 1);
    if (collision == Collision::Merge) {
      for (std::size_t v = 0; v < cube.positions.size(); ++v)
        for (int k = 0; k < 3; ++k) {
          const double side = k == 2 ? 0.2 : 0.4;
          CHECK(in.positions[v][k] == Approx(std::clamp(cube.positions[v][k], -side, side)).margin(1e-9));
        }
    }
    options = axis_options(0.1, 0.3);
    options.collision = collision;
    const OffsetResult mitered = offset(cube.view(), options);
    for (std::size_t v = 0; v < cube.positions.size(); ++v)
      for (int k = 0; k < 3; ++k)
        if (const double p = cube.positions[v][k]; std::abs(p) == 0.5)
          CHECK(mitered.positions[v][k] == Approx(p < 0 ? -0.5 - (k == 2 ? 0.3 : 0.1) : 0.5 + (k == 2 ? 0.3 : 0.1)));
    options.corners = Corners::Round;
    const OffsetResult out = offset(cube.view(), options);
    CHECK(test::share(out, VertexState::Reached) == 1);
    for (std::size_t v = 0; v < cube.positions.size(); ++v) {
      const Vec3d &p = cube.positions[v], &q = out.positions[v];
      for (int k = 0; k < 3; ++k) CHECK(std::abs(q[k]) <= 0.5 + (k == 2 ? 0.3 : 0.1) + 1e-9);
      const Vec3d beyond(std::abs(q[0]) - 0.5, std::abs(q[1]) - 0.5, std::abs(q[2]) - 0.5);
      const auto over = [](double x, double axis) { return std::max(x, 0.0) / axis; };
      const Vec3d share(over(beyond[0], 0.1), over(beyond[1], 0.1), over(beyond[2], 0.3));
      CHECK(share.length() == Approx(1).epsilon(2e-6));
      for (int k = 0; k < 3; ++k)
        if (std::abs(p[k]) == 0.5) CHECK(std::abs(q[k]) > 0.5);
    }
  }
}

TEST_CASE("metric: every vertex is on the ellipsoids around the surface", "[metric][oracle]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.1, 2, 5, 4);
  for (const auto& [xy, z] : {std::pair{0.05, 0.15}, {-0.06, -0.02}}) {
    OffsetOptions options = axis_options(xy, z);
    options.corners = Corners::Round;
    const OffsetResult result = offset(mesh.view(), options);
    CHECK(test::share(result, VertexState::Reached) > 0.99);
    CHECK(result.statistics.limit.left.total() == 0);
    const Polygons space = in_space(mesh, options.metric);
    for (std::size_t v = 0; v < mesh.positions.size(); v += 17) {
      const double distance = test::brute_force_distance(space.view(), options.metric.to(result.positions[v]));
      CHECK(distance == Approx(result.achieved[v]).epsilon(1e-6));
      if (result.states[v] == VertexState::Reached) CHECK(distance == Approx(std::abs(xy)).epsilon(2e-6));
    }
    // The mesh's own facts are told in its units.
    CHECK(result.statistics.facts.diagonal == Approx(used_diagonal(mesh.view())));
  }
}

TEST_CASE("metric: a run is valid as written, and check agrees", "[metric][no_races]") {
  const Polygons mesh = shapes::torus(1, 0.4, 24, 12);
  for (const auto kind : {Precision::Kind::Double, Precision::Kind::Single, Precision::Kind::Digits}) {
    for (const auto& [xy, z] : {std::pair{0.12, 0.04}, {-0.35, -0.1}, {-0.2, -0.39}}) {
      OffsetOptions options = axis_options(xy, z);
      options.precision = {kind, 6};
      const OffsetResult result = offset(mesh.view(), options);
      CHECK(result.statistics.limit.left.total() == 0);
      std::vector<Vec3d> written = result.positions;
      for (std::size_t v = 0; v < written.size(); ++v)
        if (written[v] != mesh.positions[v]) written[v] = Rounding(options.precision)(written[v]);
      const CheckResult found = check_offset(
          mesh.view(), written, {.distance = Distances(xy), .metric = options.metric, .precision = options.precision});
      CHECK(found.valid());
      CHECK(found.beyond == 0);
      const auto reached = [](const std::vector<VertexState>& states) {
        return std::count(states.begin(), states.end(), VertexState::Reached);
      };
      CHECK(reached(found.states) >= reached(result.states) * 0.999);
    }
  }
}

TEST_CASE("metric: what does not move along an axis keeps that coordinate's bits", "[metric]") {
  Polygons mesh = shapes::cylinder(1, 2, 32, 7, 2);
  for (Vec3d& p : mesh.positions) p[2] = p[2] * 0.3 + 0.1;
  const OffsetResult result = offset(mesh.view(), axis_options(0.1, 0.03));
  std::size_t walls = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d& p = mesh.positions[v];
    if (std::hypot(p[0], p[1]) < 0.99 || std::abs(p[2] - 0.1) > 0.29) continue;
    ++walls;
    CHECK(result.positions[v][2] == p[2]);
  }
  CHECK(walls == 32 * 6);
}

TEST_CASE("metric: an iso-surface is at ellipsoids, too, and valid as written", "[metric][iso]") {
  const Polygons mesh = shapes::box(Vec3d(1, 1, 1), 4, true);
  const Metric metric = Metric::of_half_axes(0.1, 0.2);
  IsoOptions options;
  options.distance = 0.1;
  options.precision = {Precision::Kind::Single};
  options.grid.voxel_size = 0.06;
  const IsoResult result = make_iso_surface_in_metric(mesh.view(), options, metric);
  CHECK(result.statistics.valid());
  const Polygons space = in_space(mesh, metric);
  double highest = 0;
  for (std::size_t v = 0; v < result.polygons.positions.size(); ++v) {
    const Vec3d& p = result.polygons.positions[v];
    highest = std::max(highest, p[2]);
    for (int k = 0; k < 3; ++k) CHECK(p[k] == static_cast<double>(static_cast<float>(p[k])));
    if (v % 50 == 0) CHECK(test::brute_force_distance(space.view(), metric.to(p)) == Approx(0.1).epsilon(1e-5));
  }
  CHECK(highest == Approx(0.7).epsilon(1e-6));
  CHECK(result.statistics.source.diagonal == Approx(std::sqrt(3.0)));
}

TEST_CASE("metric: what is told of an iso-surface is told of the file's coordinates", "[metric][iso][no_races]") {
  const Polygons mesh = shapes::torus(1, 0.4, 24, 12);
  const Metric metric = Metric::of_half_axes(0.1, 0.3);
  for (const auto kind : {Precision::Kind::Double, Precision::Kind::Single, Precision::Kind::Digits}) {
    IsoOptions options;
    options.distance = 0.1;
    options.precision = {kind, 3};
    options.grid.voxel_size = 0.05;
    const IsoResult result = make_iso_surface_in_metric(mesh.view(), options, metric);
    const Surface written = build_surface(result.polygons.view(), {});
    CHECK(result.statistics.valid());
    CHECK(written.facts.closed());
    CHECK(result.statistics.vertices == written.vertices.size());
    CHECK(result.statistics.components == written.facts.components);
    CHECK(find_faults(written).total() == result.statistics.mending.left.total());
    for (const Vec3d& p : result.polygons.positions) CHECK(Rounding(options.precision)(p) == p);
  }
}

TEST_CASE("metric: curves in an upright plane go by ellipses", "[metric][curves]") {
  Curves square;
  for (const auto& [x, z] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {0.0, 0.0}}) {
    square.corners.push_back(static_cast<std::uint32_t>(square.positions.size()));
    square.positions.emplace_back(x, 0.5, z);
  }
  square.close_face();
  const Distances distance(-0.1);
  const OffsetOptions options = axis_options(-0.1, -0.4);
  OffsetResult result = offset_curves(square.view(), {&distance, 1}, options).front();
  // Which way round is outward depends on the side that the plane is seen from.
  if (result.positions[0][0] < 0) {
    const Distances other(0.1);
    result = offset_curves(square.view(), {&other, 1}, axis_options(0.1, 0.4)).front();
  }
  // The curves' own facts are told in their units.
  const MeshFacts& facts = result.statistics.facts;
  CHECK(facts.median_edge == Approx(2));
  CHECK(facts.diagonal == Approx(std::sqrt(8.0)));
  CHECK(plan_curves(square.view(), {&distance, 1}, options).facts.median_edge == Approx(2));
  for (std::size_t p = 0; p < square.positions.size(); ++p) {
    const Vec3d& from = square.positions[p];
    CHECK(result.positions[p][0] == Approx(from[0] == 0 ? 0.1 : 1.9).margin(1e-9));
    CHECK(result.positions[p][1] == 0.5);
    CHECK(result.positions[p][2] == Approx(from[2] == 0 ? 0.4 : 1.6).margin(1e-9));
  }
}

TEST_CASE("metric: what is a length in the file is refused", "[metric]") {
  const Polygons mesh = shapes::icosphere(1, 1);
  OffsetOptions options = axis_options(0.1, 0.2);
  const std::vector<Distances> heights = {Distances(0.1)};
  CHECK_THROWS_WITH(grow_layers(mesh.view(), heights, options), Catch::Contains("metric"));
  options.obstacles = mesh.view();
  CHECK_THROWS_WITH(offset(mesh.view(), options), Catch::Contains("metric"));
  options = axis_options(0.1, -0.2);
  CHECK_THROWS_WITH(offset(mesh.view(), options), Catch::Contains("above 0"));
}
