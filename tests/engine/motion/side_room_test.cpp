// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/curve_oracles.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// An open tube of radius 1 around the z axis, whose faces point in or out.
Polygons round_tube(bool inward) {
  constexpr std::uint32_t kSides = 40, kStacks = 10;
  Polygons mesh;
  for (std::uint32_t j = 0; j <= kStacks; ++j)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double a = 2 * std::numbers::pi * i / kSides;
      mesh.positions.emplace_back(std::cos(a), std::sin(a), 0.3 * j);
    }
  for (std::uint32_t j = 0; j < kStacks; ++j)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = j * kSides + i, b = j * kSides + (i + 1) % kSides;
      if (inward) mesh.add_face({b, a, a + kSides, b + kSides});
      else mesh.add_face({a, b, b + kSides, a + kSides});
    }
  return mesh;
}

SideRoom room_of(const Polygons& mesh, double height) {
  const Distances heights(height);
  return grow_layers(mesh.view(), {&heights, 1}, {}).statistics.room;
}

}  // namespace

TEST_CASE("room: layers into a tube that its faces point to the inside of are told of the other side", "[room]") {
  const SideRoom inside = room_of(round_tube(true), 1.5);
  REQUIRE(inside.known);
  CHECK(inside.here < 0.2);
  CHECK(inside.there == 1);
  CHECK(inside.suggests_other());
  // Faces that point outward and a negative distance suggest the other side, too. Nothing is known where all vertices
  // reach their distance.
  CHECK(room_of(round_tube(false), -1.5).suggests_other());
  CHECK_FALSE(room_of(round_tube(false), 1.5).known);
  CHECK_FALSE(room_of(round_tube(true), 0.3).known);
}

TEST_CASE("room: what is closed has an outside of its own, but for walls of layers", "[room]") {
  const Polygons ball = shapes::icosphere(1, 2);
  OffsetOptions options;
  options.distance = -1.5;
  CHECK_FALSE(offset(ball.view(), options).statistics.room.known);
  CHECK(room_of(ball, -1.5).suggests_other());
  CHECK_FALSE(room_of(ball, 1.5).known);
}

TEST_CASE("room: of an open curve", "[room][curves]") {
  std::vector<Vec3d> points;
  for (int i = 0; i < 38; ++i) {
    const double a = test::kTurn * i / 40;
    points.emplace_back(std::cos(a), -std::sin(a), 0);
  }
  const Curves curve = test::curve_through(points, false);
  const Distances in(1.5), out(-1.5);
  CHECK(offset_curves(curve.view(), {&in, 1}, {}).front().statistics.room.suggests_other());
  CHECK_FALSE(offset_curves(curve.view(), {&out, 1}, {}).front().statistics.room.suggests_other());
}
