// SPDX-License-Identifier: Apache-2.0
#include "valid/proof/offset_prover.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/proved_mesh.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using test::even_triangle;
using test::ProvedMesh;

TEST_CASE("prover: a plane over a plane is proven at once, whatever the tolerance", "[prover]") {
  Polygons plane;
  plane.positions = {{-30, -20, 0}, {30, -20, 0}, {0, 30, 0}, {0, -60, 0}};
  plane.add_face({0, 1, 2});
  plane.add_face({1, 0, 3});
  const ProvedMesh on(plane);
  // By samples alone, each of which tells of what is around it as far as the tolerance, these would need 1e18 of them.
  const std::array<Vec3d, 3> corners = {Vec3d(-20, -10, 0.5), Vec3d(20, -10, 0.5), Vec3d(0, 17, 0.5)};
  CHECK(on.prove(even_triangle(corners, 0.5, 1e-10)).certainty == Certainty::Proven);
  // A slope, as where one corner was asked to go farther.
  std::array<Vec3d, 3> sloping = corners;
  sloping[1][2] = 0.75;
  OffsetTriangle uneven = even_triangle(sloping, 0.5, 1e-8);
  const Proof flat = on.prove(uneven);
  CHECK(flat.certainty == Certainty::Off);
  CHECK(flat.error <= 0.25);
  uneven.asked[1] = 0.75;
  CHECK(on.prove(uneven).certainty == Certainty::Proven);
}

TEST_CASE("prover: a facet of a sphere is proven just above its sag, and off just below", "[prover]") {
  // All is nearest to the tip of a pyramid.
  Polygons pyramid;
  pyramid.positions = {{0, 0, 0}, {0.2, -0.2, -1}, {0.2, 0.2, -1}, {-0.2, 0.2, -1}, {-0.2, -0.2, -1}};
  for (std::uint32_t k = 1; k <= 4; ++k) pyramid.add_face({0, k, k % 4 + 1});
  const ProvedMesh on(pyramid);
  for (const double polar : {0.01, 0.1, 0.5})
    for (const auto& turns : {std::array{0.0, 120.0, 240.0}, {0.0, 100.0, 220.0}, {0.0, 60.0, 200.0}}) {
      CAPTURE(polar, turns[1]);
      std::array<Vec3d, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = turns[k] / 180 * std::numbers::pi;
        corners[k] = Vec3d(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)) * 0.3;
      }
      const double sag = 0.3 * (1 - std::cos(polar));
      CHECK(on.prove(even_triangle(corners, 0.3, sag * 1.0001)).certainty == Certainty::Proven);
      const Proof below = on.prove(even_triangle(corners, 0.3, sag * 0.9999));
      CHECK(below.certainty == Certainty::Off);
      CHECK((below.error > sag * 0.9999 && below.error < sag * (1 + 1e-9)));
    }
}

TEST_CASE("prover: a facet across a valley is too far in the middle", "[prover]") {
  Polygons valley;  // floor z = 0 and wall x = 0
  valley.positions = {{0, -5, 0}, {0, 5, 0}, {9, -5, 0}, {9, 5, 0}, {0, -5, 9}, {0, 5, 9}};
  valley.add_face({0, 2, 3, 1});
  valley.add_face({0, 1, 5, 4});
  const ProvedMesh on(valley);
  const double asked = 0.5, across = 1;
  const std::array<Vec3d, 3> corners = {Vec3d(asked + across, -1, asked), Vec3d(asked, 0, asked + across),
                                        Vec3d(asked + across, 1, asked)};
  // Half way across, it is as far from both.
  CHECK(on.prove(even_triangle(corners, asked, 0.55 * across)).certainty == Certainty::Proven);
  const Proof proof = on.prove(even_triangle(corners, asked, 0.499 * across));
  CHECK(proof.certainty == Certainty::Off);
  CHECK((proof.error > 0.499 * across && proof.error < (0.5 + 1e-9) * across));
}

TEST_CASE("prover: miters may be farther where they keep to their plane, and not nearer", "[prover]") {
  Polygons cube = shapes::box(Vec3d(2), 1, true);
  const double d = 0.1, out = 1 + d;
  OffsetTriangle top = even_triangle({Vec3d(out, out, out), Vec3d(0, out, out), Vec3d(out, 0, out)}, d, 1e-6 * d);
  top.over_plane = {d, d, d};
  {
    const ProvedMesh on(cube);
    const Proof round = on.prove(top);
    CHECK(round.certainty == Certainty::Off);
    CHECK((round.error > 1e-6 * d && round.error < (std::sqrt(3) - 1) * d));
    top.may_keep_to_plane = true;
    CHECK(on.prove(top).certainty == Certainty::Proven);
    // Beyond the plane, as much as the tolerance allows.
    OffsetTriangle tilted = top;
    tilted.corners[0][2] += 0.1 * d;
    tilted.over_plane[0] += 0.1 * d;
    tilted.tolerance = {0.101 * d, 0.101 * d, 0.101 * d};
    CHECK(on.prove(tilted).certainty == Certainty::Proven);
    tilted.tolerance = {0.09 * d, 0.09 * d, 0.09 * d};
    const Proof off = on.prove(tilted);
    CHECK(off.certainty == Certainty::Off);
    CHECK((off.error > 0.09 * d && off.error <= 0.1 * d));
    tilted.asked[0] += 0.1 * d;
    CHECK(on.prove(tilted).certainty == Certainty::Proven);
  }
  // Something else above the corner.
  const auto first = static_cast<std::uint32_t>(cube.positions.size());
  for (const double x : {0.4, 0.8}) cube.positions.emplace_back(1 + x * d, 1 + 0.5 * d, out + 0.5 * d);
  cube.positions.emplace_back(1 + 0.5 * d, 1 + 0.8 * d, out + 0.5 * d);
  cube.add_face({first, first + 1, first + 2});
  const ProvedMesh on(cube);
  const Proof near = on.prove(top);
  CHECK(near.certainty == Certainty::Off);
  CHECK((near.error > 1e-6 * d && near.error <= (0.5 + 1e-9) * d));
}

namespace {

/// Triangles that are hardly more than a point.
Polygons dots_at(const std::vector<Vec3d>& points) {
  Polygons dots;
  for (const Vec3d& p : points) {
    const auto first = static_cast<std::uint32_t>(dots.positions.size());
    for (const Vec3d& corner : {Vec3d(0, 0, 0), Vec3d(1e-6, 0, 0), Vec3d(0, 1e-6, 0)})
      dots.positions.push_back(p + corner);
    dots.add_face({first, first + 1, first + 2});
  }
  return dots;
}

std::array<Vec3d, 3> strip_of(double length) {
  return {Vec3d(0, 0, 1), Vec3d(length, 1e-6, 1), Vec3d(length, -1e-6, 1)};
}

}  // namespace

TEST_CASE("prover: what is too far from each corner may be near enough in between", "[prover]") {
  // Three dots under a strip, each of which is near enough to a part of it: the first to where the least is asked, the
  // last to where the most is. The dot between them is lower than the one end asks for, and too far away from the
  // other.
  const double tolerance = 0.01, unit = std::sqrt(2 * tolerance);
  const ProvedMesh on(dots_at({Vec3d(0, 0, 1.5 * tolerance), Vec3d(1.3 * unit, 0, 0), Vec3d(3 * unit, 0, 0)}));
  OffsetTriangle strip = even_triangle(strip_of(3 * unit), 1, tolerance);
  strip.asked = {1 - 1.5 * tolerance, 1 + 0.5 * tolerance, 1 + 0.5 * tolerance};
  CHECK(on.prove(strip).certainty == Certainty::Proven);
}

TEST_CASE("prover: the error that is told is that of a point, where all is too far", "[prover]") {
  // A part is over dots that are too far down. The last one before is nearest of those that are near enough to
  // anything.
  std::vector<Vec3d> points;
  for (int i = 0; i <= 30; ++i) points.emplace_back(0.1 * i, 0, i <= 20 ? 0 : -0.05);
  const ProvedMesh on(dots_at(points));
  const Proof proof = on.prove(even_triangle(strip_of(3), 1, 0.01));
  CHECK(proof.certainty == Certainty::Off);
  CHECK(proof.error > 0.01);
  CHECK(proof.error < std::hypot(1.05, 0.1) - 1);
}
