// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/fills.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/periodic.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::test {
namespace {

/// A period of a tube about the x axis: one of `periods` around it, of quads, whose radius varies along the tube and
/// around it.
Polygons sector(int periods, double bumps, int around = 12, int along = 16) {
  Polygons wall;
  for (int i = 0; i <= along; ++i)
    for (int j = 0; j <= around; ++j) {
      const double x = 2.0 * i / along, t = 0.3 + 2 * std::numbers::pi / periods * j / around;
      const double r = 1 + 0.08 * std::sin(std::numbers::pi * x) + bumps * std::cos(periods * t + 0.7);
      wall.positions.emplace_back(x, r * std::cos(t), r * std::sin(t));
    }
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < around; ++j) {
      const auto p = static_cast<std::uint32_t>(i * (around + 1) + j), q = p + static_cast<std::uint32_t>(around) + 1;
      wall.add_face({p, p + 1, q + 1, q});
    }
  return wall;
}

PeriodicMotion turn(double angle) { return {.axis = {1, 0, 0}, .angle = angle}; }

/// The most by which layers differ from what the motion makes of their pairs'.
double most_apart(const LayersResult& layers) {
  const PeriodicPairs& pairs = layers.periodic.value();
  double most = 0;
  for (std::uint32_t v = 0; v < pairs.image.size(); ++v) {
    if (pairs.image[v] == kNone) continue;
    const auto from = layers.stacks.of(v), to = layers.stacks.of(pairs.image[v]);
    for (std::size_t k = 0; k < to.size(); ++k) most = std::max(most, (pairs.motion(from[k]) - to[k]).length());
  }
  return most;
}

}  // namespace

TEST_CASE("layers on periodic borders are copies of each other, at their heights") {
  const Polygons wall = sector(6, 0.05);
  const std::vector<Distances> heights{-0.05, -0.1};
  const LayersResult layers = grow_periodic_layers(wall.view(), heights, {}, turn(60));
  CHECK(layers.periodic->facts.pairs == 17);
  CHECK(layers.periodic->facts.apart < 1e-5);
  CHECK(most_apart(layers) < 1e-12);
  for (std::size_t v = 0; v < wall.positions.size(); ++v) CHECK(layers.states[v] == VertexState::Reached);
  // What is said is said of the mesh, and not of the copies that layers were grown with.
  const OffsetStatistics& statistics = layers.statistics;
  CHECK(statistics.facts.welded_vertices == wall.positions.size());
  CHECK(statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)] == wall.positions.size());
  CHECK(statistics.borders.planes.size() == 2);
  CHECK(statistics.borders.held_vertices == 2 * 13);
  // Without the motion both borders go where their own faces lead them, which is not to each other.
  const LayersResult alone = grow_layers(wall.view(), heights, {});
  CHECK((turn(60)(alone.stacks.of(0)[2]) - alone.stacks.of(12)[2]).length() > 1e-3);
}

TEST_CASE("as many copies are grown with as layers can feel") {
  const Polygons part = sector(6, 0.05);
  const LayersResult layers = grow_periodic_layers(part.view(), std::vector<Distances>{-0.05, -0.1}, {}, turn(60));
  CHECK(layers.periodic->facts.copies == 3);
  // Wider than half of the radius: what is across the axis counts, and all of the circle is there.
  const LayersResult thick = grow_periodic_layers(part.view(), std::vector<Distances>{-0.3, -0.6}, {}, turn(60));
  CHECK(thick.periodic->facts.copies == 6);
  CHECK(most_apart(thick) < 1e-12);
}

TEST_CASE("where layers are thinned, both borders keep the lesser share") {
  // A ridge near one border alone, up to which layers from the other border reach beyond it.
  Polygons wall = sector(6, 0, 12, 16);
  for (Vec3d& x : wall.positions) {
    const double t = std::atan2(x[2], x[1]) - 0.3;
    const double in = std::abs(t - 0.15) < 0.1 && std::abs(x[0] - 1) < 0.3 ? 0.6 : 1;
    x = {x[0], x[1] * in, x[2] * in};
  }
  const LayersResult layers = grow_periodic_layers(wall.view(), std::vector<Distances>{-0.1, -0.3}, {}, turn(60));
  CHECK(layers.layer_statistics.thinned_vertices > 0);
  CHECK(most_apart(layers) < 1e-12);
  for (std::uint32_t v = 0; v < wall.positions.size(); ++v)
    if (const auto w = layers.periodic->image[v]; w != kNone) CHECK(layers.share[v] == layers.share[w]);
}

TEST_CASE("the rest of a period is filled, and the faces of its periodic patches are in one order") {
  const Polygons wall = sector(4, 0.01);
  const LayersResult layers = grow_periodic_layers(wall.view(), std::vector<Distances>{-0.05, -0.1}, {}, turn(90));
  LayerCellFacts facts;
  VolumeMesh cells = make_cells(wall.view(), layers, {}, &facts);
  const VolumeMesh mesh = fill_volume(wall.view(), layers, facts, {}, std::move(cells), {}, fill_from_middle);
  CHECK_NOTHROW(VolumeFaces(mesh));
  const BoundaryPatch *first = patch_of(mesh, "periodic_1"), *second = patch_of(mesh, "periodic_2");
  REQUIRE(first != nullptr);
  REQUIRE(second != nullptr);
  REQUIRE(first->face_count() == second->face_count());
  CHECK(first->face_count() > 32);
  for (std::size_t f = 0; f < first->face_count(); ++f) {
    const auto a = first->face(f), b = second->face(f);
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      CHECK((turn(90)(mesh.points[a[k]]) - mesh.points[b[(b.size() - k) % b.size()]]).length() < 1e-9);
  }
}

TEST_CASE("a border that is another one, turned, is found") {
  const auto turn_of = [](const Polygons& wall) { return likely_turn(wall.view()); };
  REQUIRE(turn_of(sector(6, 0.05)));
  CHECK(turn_of(sector(6, 0.05))->angle == 60);
  CHECK(turn_of(sector(6, 0.05))->axis == Vec3d(1, 0, 0));
  CHECK(turn_of(sector(12, 0))->angle == 30);
  // Neither a quarter between planes across axes, nor what is closed, nor what has no such border.
  Polygons quarter = sector(4, 0);
  for (Vec3d& x : quarter.positions) {
    const double t = std::atan2(x[2], x[1]) - 0.3, r = std::hypot(x[1], x[2]);
    x = {x[0], r * std::cos(t), r * std::sin(t)};
  }
  CHECK_FALSE(turn_of(quarter));
  CHECK_FALSE(turn_of(shapes::icosphere(1, 2)));
  CHECK_FALSE(turn_of(shapes::hemisphere(1, 12, 3)));
  Polygons bent = sector(6, 0);
  bent.positions[0] += Vec3d(0, 0.01, 0.02), bent.positions[26] *= 1.01, bent.positions[39] *= 1.02;
  for (std::size_t v = 12; v < bent.positions.size(); v += 13) bent.positions[v] *= 1.003;
  CHECK_FALSE(turn_of(bent));
}

TEST_CASE("what is no period is refused") {
  const Polygons wall = sector(6, 0.05);
  const std::vector<Distances> heights{-0.05};
  const auto grow = [&](const PeriodicMotion& motion) {
    return grow_periodic_layers(wall.view(), heights, {}, motion);
  };
  CHECK_THROWS_AS(grow({}), InvalidInput);
  CHECK_THROWS_AS(grow(turn(59)), InvalidInput);
  CHECK_THROWS_AS(grow({.shift = {1, 0, 0}}), InvalidInput);
  const Polygons seventh = sector(5, 0.05);
  CHECK_NOTHROW(grow_periodic_layers(seventh.view(), heights, {}, turn(72)));
  Polygons bent = sector(6, 0.05);
  for (Vec3d& x : bent.positions) {
    const double t = std::atan2(x[2], x[1]), r = std::hypot(x[1], x[2]);
    x = {x[0], r * std::cos(t * 0.95), r * std::sin(t * 0.95)};
  }
  // 57 degrees, which no circle is a multiple of.
  CHECK_THROWS_AS(grow_periodic_layers(bent.view(), heights, {}, turn(57)), InvalidInput);
}

}  // namespace vdb_offset::test
