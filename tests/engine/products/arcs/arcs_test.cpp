// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "products/arcs/round_patch.h"
#include "products/arcs/slerp.h"
#include "space/surface/surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

constexpr double kPi = std::numbers::pi;

RefinedOffset with_arcs(const Polygons& mesh, double distance, double share = 0.01, int threads = 0) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = Corners::Arc;
  options.threads = threads;
  Tolerance tolerance;
  tolerance.share = share;
  return offset_to_tolerance(mesh.view(), options, tolerance);
}

Polygons moved(const RefinedOffset& made) {
  Polygons result = made.refinement.polygons;
  result.positions = made.result.positions;
  return result;
}

double volume_of(const Polygons& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : split_polygons(mesh.view()))
    six += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c]));
  return six / 6;
}

CheckResult check(const RefinedOffset& made, double distance, std::span<const Vec3d> positions) {
  CheckOptions options;
  options.distance = distance;
  options.corners = Corners::Arc;
  options.tolerance_share = 0.01;
  return check_offset(made.refinement.polygons.view(), positions, options);
}

/// All of it is proven to be at the distance, it is closed, and the check finds no fault.
void require_whole(const RefinedOffset& made, double distance) {
  CHECK(made.result.statistics.certified.value().certified == Approx(1).epsilon(1e-9));
  CHECK(made.result.statistics.limit.source_crossings == 0);
  const MeshFacts facts = build_surface(moved(made).view(), {}).facts;
  CHECK((facts.closed() && facts.oriented()));
  const CheckResult found = check(made, distance, made.result.positions);
  CHECK(found.valid());
  CHECK(found.certified.value().certified == Approx(1).epsilon(1e-9));
}

/// An L of three unit squares, 1 high.
Polygons l_prism() {
  const std::vector<std::pair<double, double>> outline{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  Polygons mesh;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh.positions.emplace_back(x, y, z);
  mesh.add_face({5, 4, 3, 2, 1, 0});
  mesh.add_face({6, 7, 8, 9, 10, 11});
  for (std::uint32_t i = 0; i < 6; ++i) mesh.add_face({i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6});
  return mesh;
}

}  // namespace

TEST_CASE("arcs: the offset of a box has the volume of its sum with a ball") {
  const Polygons mesh = shapes::box({1, 2, 3}, 1, false);
  const double d = 0.4;
  const RefinedOffset made = with_arcs(mesh, d, 0.001);
  require_whole(made, d);
  // Steiner's formula.
  const double exact = 6 + 22 * d + 6 * kPi * d * d + 4.0 / 3 * kPi * d * d * d, volume = volume_of(moved(made));
  CHECK(volume < exact);
  CHECK(volume > exact - 0.001 * d * 30);  // a thousandth of the distance over an area of about 30
  for (const VertexState state : made.result.states) CHECK(state == VertexState::Reached);
}

TEST_CASE("arcs: the faces of the source come first, in their planes, then strips, then patches") {
  const Polygons mesh = shapes::box({1, 1, 1}, 1, false);
  const RefinedOffset made = with_arcs(mesh, 0.2);
  const auto& [polygons, parent, added, over_ridges, over_corners] = made.refinement;
  REQUIRE(made.refinement.source_vertices() == 8);
  REQUIRE(made.refinement.faces_in_place() == 6);
  CHECK(std::equal(mesh.positions.begin(), mesh.positions.end(), polygons.positions.begin()));
  for (std::size_t f = 0; f < 6; ++f) {
    CHECK(parent[f] == f);
    const auto face = polygons.view().face(f), before = mesh.view().face(f);
    REQUIRE(face.size() == before.size());
    const Vec3d normal = (mesh.positions[before[1]] - mesh.positions[before[0]])
                             .cross(mesh.positions[before[2]] - mesh.positions[before[0]])
                             .unit();
    for (std::size_t k = 0; k < face.size(); ++k) {
      CHECK(polygons.positions[face[k]] == mesh.positions[before[k]]);
      const Vec3d displacement = made.result.positions[face[k]] - mesh.positions[before[k]];
      CHECK((displacement - normal * 0.2).length() < 0.2e-9);
    }
  }
  // Strips of 12 edges: quads between quads, each in 7 steps of a right angle; 8 patches alike.
  CHECK(over_ridges - over_corners == 12 * 7);
  CHECK(over_corners % 8 == 0);
  for (std::size_t f = 6; f < parent.size(); ++f)
    CHECK((polygons.view().face(f).size() == 4) == (f < parent.size() - over_corners));
  const auto first = parent.begin() + 6, corners = parent.end() - static_cast<std::ptrdiff_t>(over_corners);
  CHECK(std::is_sorted(first, corners));
  CHECK(std::is_sorted(corners, parent.end()));
  for (const VertexOrigin& origin : added) {
    CHECK(origin.share == std::array<double, 3>{1, 0, 0});
    CHECK(origin.vertex[0] < 8);
  }
}

TEST_CASE("arcs: inward, a concave edge is a ridge, and its strip ends on the flanks") {
  const Polygons mesh = l_prism();
  const double d = 0.1;
  const RefinedOffset made = with_arcs(mesh, -d);
  require_whole(made, -d);
  CHECK(made.refinement.over_ridges > 0);
  const double side = 2 - 2 * d, exact = (side * side - 1 + (1 - kPi / 4) * d * d) * (1 - 2 * d);
  CHECK(volume_of(moved(made)) == Approx(exact).epsilon(1e-4));
}

TEST_CASE("arcs: outward, strips meet over the end of a concave edge") {
  const double d = 0.1;
  const RefinedOffset made = with_arcs(l_prism(), d);
  require_whole(made, d);
  // Of the outline: its area, length times d, and a fan at each of five corners of a right angle, less the square that
  // both sides of the concave one ask for. The round rims of both caps by Pappus are checked by the certificate.
  const Polygons result = moved(made);
  double most = 0;
  for (const Vec3d& position : result.positions) most = std::max(most, position[2]);
  CHECK(most == Approx(1 + d).epsilon(1e-9));
}

TEST_CASE("arcs: the tip of a cone of narrow faces is opened, though no edge there is a ridge") {
  Polygons mesh;
  constexpr std::uint32_t kSides = 64;
  for (std::uint32_t i = 0; i < kSides; ++i)
    mesh.positions.emplace_back(std::cos(2 * kPi * i / kSides), std::sin(2 * kPi * i / kSides), 0.0);
  mesh.positions.emplace_back(0.0, 0.0, 3.0);
  std::vector<std::uint32_t> base;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    mesh.add_face({i, (i + 1) % kSides, kSides});
    base.insert(base.begin(), i);
  }
  mesh.corners.insert(mesh.corners.end(), base.begin(), base.end());
  mesh.close_face();
  const RefinedOffset made = with_arcs(mesh, 0.2);
  require_whole(made, 0.2);
  double most = 0;
  for (const Vec3d& position : made.result.positions) most = std::max(most, position[2]);
  CHECK(most == Approx(3.2).epsilon(1e-6));
}

TEST_CASE("arcs: where nothing is a ridge, the result is that of miters") {
  const Polygons mesh = shapes::icosphere(1, 3);
  const RefinedOffset made = with_arcs(mesh, 0.1);
  OffsetOptions options;
  options.distance = 0.1;
  const OffsetResult mitered = offset(mesh.view(), options);
  CHECK(made.refinement.over_ridges == 0);
  CHECK(made.refinement.added.empty());
  CHECK(made.result.positions == mitered.positions);
  CHECK(made.result.states == mitered.states);
}

TEST_CASE("arcs: the result does not depend on the number of threads") {
  const Polygons mesh = shapes::gear(12, 0.8, 1, 0.3, 0.2, 6);
  const RefinedOffset one = with_arcs(mesh, 0.03, 0.01, 1), four = with_arcs(mesh, 0.03, 0.01, 4);
  CHECK(one.refinement.polygons.corners == four.refinement.polygons.corners);
  CHECK(one.result.positions == four.result.positions);
  CHECK(one.result.statistics.certified->certified == four.result.statistics.certified->certified);
}

TEST_CASE("arcs: a check finds what is wrong with them") {
  const RefinedOffset made = with_arcs(shapes::box({1, 1, 1}, 1, true), 0.2);
  std::vector<Vec3d> positions = made.result.positions;
  REQUIRE(check(made, 0.2, positions).valid());
  const std::size_t last = positions.size() - 1;  // inside of a patch
  positions[last] *= 0.9;
  const CheckResult nearer = check(made, 0.2, positions);
  CHECK(nearer.states[last] == VertexState::Limited);
  CHECK(nearer.certified->certified < 0.9999);
  positions[last] = Vec3d(0.5);
  CHECK_FALSE(check(made, 0.2, positions).valid());
}

TEST_CASE("arcs: an offset that may not have more faces refuses them") {
  const Polygons mesh = shapes::box({1, 1, 1}, 1, true);
  OffsetOptions options;
  options.distance = 0.1;
  options.corners = Corners::Arc;
  CHECK_THROWS_AS(offset(mesh.view(), options), InvalidInput);
}

TEST_CASE("arcs: a tolerance that asks for too many faces is refused before they are made") {
  const Polygons mesh = shapes::gear(40, 0.8, 1, 0.3, 0.2, 6);
  CHECK_THROWS_AS(with_arcs(mesh, 0.001, 1e-5), OutOfBudget);
  OffsetOptions options;
  options.distance = 0.2;
  options.corners = Corners::Arc;
  Tolerance tolerance;
  tolerance.share = 0.01;
  tolerance.most_faces = 500;
  const Polygons cube = shapes::box({1, 1, 1}, 1, true);
  CHECK_THROWS_AS(offset_to_tolerance(cube.view(), options, tolerance), OutOfBudget);
  tolerance.most_faces = 5000;
  CHECK(offset_to_tolerance(cube.view(), options, tolerance).refinement.parent.size() < 5000);
}

TEST_CASE("arcs: patches are as near to the sphere as the arcs around them") {
  const double tolerance = GENERATE(0.01, 0.001), step = 0.92 * 2 * std::acos(1 - tolerance);
  const std::array<std::array<Vec3d, 3>, 3> corners{{{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)},
                                                     {Vec3d(1, 0, 0.2), Vec3d(-0.5, 0.8, 0.2), Vec3d(-0.5, -0.8, 0.2)},
                                                     {Vec3d(1, 0, 0), Vec3d(0.02, 1, 0), Vec3d(0.7, 0.7, 0.15)}}};
  for (const auto& triangle : corners) {
    std::vector<Vec3d> loop;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d a = triangle[k].unit(), b = triangle[(k + 1) % 3].unit();
      const auto count = static_cast<int>(std::ceil(angle_between(a, b) / step));
      for (int i = 0; i < count; ++i) loop.push_back(slerp(a, b, static_cast<double>(i) / count));
    }
    const auto patch = round_patch(loop, step, 1);
    REQUIRE(patch.has_value());
    const auto at = [&](std::uint32_t i) { return i < loop.size() ? loop[i] : patch->inner[i - loop.size()]; };
    CHECK(patch->triangles.size() == loop.size() + 2 * patch->inner.size() - 2);
    for (const auto& [a, b, c] : patch->triangles) {
      CHECK((at(b) - at(a)).cross(at(c) - at(a)).dot(at(a)) > 0);
      constexpr int kRows = 10;
      for (int i = 0; i <= kRows; ++i)
        for (int k = 0; i + k <= kRows; ++k)
          CHECK((at(a) * i + at(b) * k + at(c) * (kRows - i - k)).length() / kRows > 1 - tolerance);
    }
    std::vector<Vec3d> reversed(loop.rbegin(), loop.rend());
    CHECK_FALSE(round_patch(reversed, step, 1).has_value());
    CHECK(round_patch(reversed, step, -1).has_value());
  }
}
