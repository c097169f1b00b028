// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>

#include "support/oracles.h"
#include "support/solids.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

constexpr int kFacets = 32;

/// A tube around the z axis, from -half to half.
Polygons sleeve(double inner, double outer, double half) {
  Polygons mesh;
  for (int i = 0; i < kFacets; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFacets;
    for (const auto& [r, z] : {std::pair{inner, -half}, {outer, -half}, {outer, half}, {inner, half}})
      mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  const auto at = [](int i, int k) { return static_cast<std::uint32_t>(4 * (i % kFacets) + k % 4); };
  for (int i = 0; i < kFacets; ++i)
    for (int k = 0; k < 4; ++k) mesh.add_face({at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
  return mesh;
}

/// The least distance between faces, by trying all.
double gap_of(const Polygons& mesh, const std::vector<Vec3d>& positions, const Polygons& other) {
  const auto triangles = [](const Polygons& of, const std::vector<Vec3d>& at) {
    std::vector<TriangleCorners> all;
    for (std::size_t f = 0; f < of.face_count(); ++f) {
      const auto face = of.view().face(f);
      for (std::size_t k = 2; k < face.size(); ++k) all.push_back({at[face[0]], at[face[k - 1]], at[face[k]]});
    }
    return all;
  };
  double least = 1e300;
  const auto of_other = triangles(other, other.positions);
  for (const TriangleCorners& a : triangles(mesh, positions))
    for (const TriangleCorners& b : of_other) least = std::min(least, distance_between(a, b));
  return least;
}

/// The corner points of cells in x and in y, and which of them are of a plus.
constexpr std::array<double, 6> kCellEnds = {-4, 0, 6, 12, 18, 22};
constexpr bool is_in_plus(int i, int j) { return i >= 1 && i <= 3 && j >= 1 && j <= 3 && (i == 2 || j == 2); }

/// Whether a point is above a corner of a cell of the plus.
bool is_corner_of_plus(const Vec3d& p) {
  const auto index = [&](int k) {
    return static_cast<int>(std::find(kCellEnds.begin(), kCellEnds.end(), p[k]) - kCellEnds.begin());
  };
  const int i = index(0), j = index(1);
  return is_in_plus(i, j) || is_in_plus(i - 1, j) || is_in_plus(i, j - 1) || is_in_plus(i - 1, j - 1);
}

/// A block of those cells from z = bottom to top for which is_high(i, j) holds; the others end at z = floor, or are
/// left out where that is the bottom. Quads.
template <class IsHigh>
Polygons relief(double bottom, double floor, double top, IsHigh&& is_high) {
  Polygons mesh;
  std::map<std::array<double, 3>, std::uint32_t> at;
  const auto vertex = [&](int i, int j, double z) {
    const std::array<double, 3> p = {kCellEnds[static_cast<std::size_t>(i)], kCellEnds[static_cast<std::size_t>(j)], z};
    const auto [place, is_new] = at.try_emplace(p, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.emplace_back(p[0], p[1], p[2]);
    return place->second;
  };
  const auto height = [&](int i, int j) {
    return i < 0 || j < 0 || i > 4 || j > 4 ? bottom : is_high(i, j) ? top : floor;
  };
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const double z = height(i, j);
      if (z == bottom) continue;
      for (const double end : {z, bottom}) {
        const std::uint32_t a = vertex(i, j, end), b = vertex(i + 1, j, end), c = vertex(i + 1, j + 1, end),
                            d = vertex(i, j + 1, end);
        if (end == bottom) mesh.add_face({d, c, b, a});
        else mesh.add_face({a, b, c, d});
      }
      // Walls to lower neighbours, seen from outside: along each side of the cell, counter-clockwise.
      const std::array<std::array<int, 4>, 4> sides = {
          {{i, j, i + 1, j}, {i + 1, j, i + 1, j + 1}, {i + 1, j + 1, i, j + 1}, {i, j + 1, i, j}}};
      const std::array<double, 4> beyond = {height(i, j - 1), height(i + 1, j), height(i, j + 1), height(i - 1, j)};
      for (std::size_t k = 0; k < 4; ++k) {
        if (beyond[k] >= z) continue;
        const auto& [x0, y0, x1, y1] = sides[k];
        mesh.add_face({vertex(x0, y0, beyond[k]), vertex(x1, y1, beyond[k]), vertex(x1, y1, z), vertex(x0, y0, z)});
      }
    }
  return mesh;
}

double volume_of(const Polygons& mesh, const std::vector<Vec3d>& at) {
  double six = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k) six += at[face[0]].dot(at[face[k - 1]].cross(at[face[k]]));
  }
  return six / 6;
}

void require_valid(const Polygons& mesh, const OffsetResult& result) {
  CHECK(result.statistics.limit.left.total() == 0);
  CHECK(check_offset(mesh.view(), result.positions, {.distance = result.distances.farthest()}).faults.crossings == 0);
}

}  // namespace

TEST_CASE("fit: a peg gives way in its socket, and nowhere else", "[fit]") {
  const Polygons peg = shapes::cylinder(1, 4, kFacets, 16, 3), socket = sleeve(1, 2, 1);
  const double clearance = 0.1;
  const OffsetResult result = fit(peg.view(), socket.view(), clearance, {});
  REQUIRE(result.statistics.fit);
  const FitFacts& facts = *result.statistics.fit;
  CHECK(facts.starting_gap == Approx(0).margin(1e-12));
  CHECK(facts.near_at_start > 0);
  CHECK(facts.near == 0);
  CHECK(facts.is_signed);
  CHECK(facts.enclosed == 0);
  CHECK(facts.gap >= clearance * (1 - 1e-6));
  CHECK(facts.gap <= clearance * (1 + 1e-3));
  CHECK(gap_of(peg, result.positions, socket) == Approx(facts.gap).epsilon(1e-9));
  require_valid(peg, result);
  // Facets stand opposite each other: their apothems differ by the clearance.
  const double fitting = 1 - clearance / std::cos(std::numbers::pi / kFacets);
  for (std::size_t v = 0; v < peg.positions.size(); ++v) {
    const Vec3d& from = peg.positions[v];
    if (std::abs(from[2]) >= 1.5 || std::hypot(from[0], from[1]) < 0.99) CHECK(result.positions[v] == from);
    else if (std::abs(from[2]) < 0.7)
      CHECK(std::hypot(result.positions[v][0], result.positions[v][1]) == Approx(fitting).epsilon(1e-4));
  }
}

TEST_CASE("fit: a socket gives way to its peg", "[fit]") {
  Polygons socket = sleeve(1, 2, 1);
  const Polygons peg = shapes::cylinder(1.02, 4, kFacets, 8, 2);  // pressed in
  const OffsetResult result = fit(socket.view(), peg.view(), 0.05, {});
  const FitFacts& facts = *result.statistics.fit;
  CHECK(facts.starting_gap < 0);
  CHECK(facts.near == 0);
  CHECK(facts.gap >= 0.05 * (1 - 1e-6));
  CHECK(gap_of(socket, result.positions, peg) == Approx(facts.gap).epsilon(1e-9));
  require_valid(socket, result);
  for (std::size_t v = 0; v < socket.positions.size(); ++v)
    if (std::hypot(socket.positions[v][0], socket.positions[v][1]) > 1.5)
      CHECK(result.positions[v] == socket.positions[v]);
}

TEST_CASE("fit: what is inside a solid comes out of it", "[fit]") {
  const Polygons sphere = shapes::icosphere(1, 4);
  Polygons floor = shapes::box(Vec3d(4, 4, 1), 1, true);
  for (Vec3d& p : floor.positions) p[2] -= 1.4;              // its upper side at -0.9
  std::reverse(floor.corners.begin(), floor.corners.end());  // a solid, whichever way its faces point
  const OffsetResult result = fit(sphere.view(), floor.view(), 0.05, {});
  const FitFacts& facts = *result.statistics.fit;
  double lowest = 0;
  for (const Vec3d& p : sphere.positions) lowest = std::min(lowest, p[2]);
  CHECK(facts.starting_gap == Approx(lowest + 0.9).epsilon(1e-9));
  CHECK(facts.near == 0);
  for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
    CHECK(result.positions[v][2] >= -0.85 - 0.05 * 1e-6);
    if (sphere.positions[v][2] > -0.8) CHECK(result.positions[v] == sphere.positions[v]);
  }
  require_valid(sphere, result);
}

TEST_CASE("fit: faces give way between their vertices", "[fit]") {
  const Polygons cube = shapes::box(Vec3d(1, 1, 1), 1, true);
  Polygons spike = shapes::icosphere(0.1, 1);
  for (Vec3d& p : spike.positions) p += Vec3d(0.12, 0.05, 0.62);
  const OffsetResult result = fit(cube.view(), spike.view(), 0.05, {});
  const FitFacts& facts = *result.statistics.fit;
  CHECK(facts.near == 0);
  CHECK(facts.gap >= 0.05 * (1 - 1e-6));
  CHECK(facts.gap <= 0.05 * 1.2);
  CHECK(gap_of(cube, result.positions, spike) == Approx(facts.gap).epsilon(1e-9));
  for (std::size_t v = 0; v < cube.positions.size(); ++v)
    if (cube.positions[v][2] < 0) CHECK(result.positions[v] == cube.positions[v]);
  require_valid(cube, result);
}

TEST_CASE("fit: a pocket moves its walls and its floor, and all stay flat", "[fit]") {
  const Polygons pocket = relief(-3, 0, 5, [](int i, int j) { return !is_in_plus(i, j); });
  // The peg has no play; it ends in the pocket, flush with it, and beyond.
  for (const double end : {3.0, 5.0, 7.0}) {
    const Polygons peg = relief(0, 0, end, is_in_plus);
    const OffsetResult result = fit(pocket.view(), peg.view(), 0.2, {});
    CAPTURE(end);
    CHECK(result.statistics.fit->near == 0);
    CHECK(result.statistics.fit->gap == Approx(0.2).epsilon(1e-6));
    require_valid(pocket, result);
    for (std::size_t v = 0; v < pocket.positions.size(); ++v) {
      const Vec3d &from = pocket.positions[v], &to = result.positions[v];
      const bool is_at_pocket = from[2] > -3 && is_corner_of_plus(from);
      CHECK(to[2] == Approx(from[2] == 0 ? -0.2 : from[2]).margin(1e-6));
      for (const int k : {0, 1}) CHECK(std::abs(to[k] - from[k]) == Approx(is_at_pocket ? 0.2 : 0).margin(1e-6));
    }
    CHECK(volume_of(pocket, pocket.positions) - volume_of(pocket, result.positions) ==
          Approx(194.56 * 5.2 - 180 * 5).epsilon(1e-5));
  }
}

TEST_CASE("fit: the peg of a pocket gives way on its walls and its end", "[fit]") {
  const Polygons pocket = relief(-3, 0, 5, [](int i, int j) { return !is_in_plus(i, j); }),
                 peg = relief(0, 0, 7, is_in_plus);
  const OffsetResult result = fit(peg.view(), pocket.view(), 0.2, {});
  CHECK(result.statistics.fit->near == 0);
  require_valid(peg, result);
  for (std::size_t v = 0; v < peg.positions.size(); ++v) {
    CHECK(result.positions[v][2] == Approx(peg.positions[v][2] == 0 ? 0.2 : 7).margin(1e-6));
    for (const int k : {0, 1})
      CHECK(std::abs(result.positions[v][k] - peg.positions[v][k]) == Approx(0.2).margin(1e-6));
  }
}

TEST_CASE("fit: a groove moves its round walls and its floor", "[fit]") {
  constexpr std::array<std::array<double, 2>, 8> kWithGroove = {
      {{1, 0}, {6, 0}, {6, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {1, 3}}};
  constexpr std::array<std::array<double, 2>, 4> kRing = {{{3, 1}, {4, 1}, {4, 4}, {3, 4}}};
  const Polygons groove = test::lathe(kWithGroove, 64), ring = test::lathe(kRing, 64);
  const OffsetResult result = fit(groove.view(), ring.view(), 0.1, {});
  CHECK(result.statistics.fit->near == 0);
  require_valid(groove, result);
  // Facets of both stand opposite each other.
  const double at_corner = 0.1 / std::cos(std::numbers::pi / 64);
  for (std::size_t v = 0; v < groove.positions.size(); ++v) {
    const Vec3d &from = groove.positions[v], &to = result.positions[v];
    const double radius = std::hypot(from[0], from[1]);
    const double farther = std::abs(radius - 4) < 1e-9 ? at_corner : std::abs(radius - 3) < 1e-9 ? -at_corner : 0;
    CHECK(std::hypot(to[0], to[1]) == Approx(radius + farther).epsilon(1e-5));
    CHECK(to[2] == Approx(from[2] == 1 ? 0.9 : from[2]).margin(1e-5));
  }
}

TEST_CASE("fit: nothing moves where there is room, and what has none is told", "[fit]") {
  const Polygons sphere = shapes::icosphere(1, 2);
  Polygons far = shapes::icosphere(1, 2);
  for (Vec3d& p : far.positions) p += Vec3d(0, 0, 3);
  const OffsetResult room = fit(sphere.view(), far.view(), 0.2, {});
  CHECK(room.positions == sphere.positions);
  CHECK(room.statistics.fit->moved == 0);
  CHECK(room.statistics.fit->rounds == 0);
  CHECK(room.statistics.fit->gap == Approx(gap_of(sphere, sphere.positions, far)).epsilon(1e-12));
  // A plate between two others has no more than itself to give.
  const Polygons plate = shapes::box(Vec3d(1, 1, 0.2), 4, true);
  Polygons others = shapes::plates(2, 0.3, 0.3, 2);
  const OffsetResult thin = fit(plate.view(), others.view(), 0.2, {});
  CHECK(thin.statistics.fit->near > 0);
  CHECK(thin.statistics.fit->gap < 0.2);
  CHECK(thin.statistics.fit->gap >= 0.05 - 1e-12);
  require_valid(plate, thin);
  // Nothing can give way to what lies inside.
  const Polygons pin = shapes::icosphere(0.2, 1);
  CHECK(fit(sphere.view(), pin.view(), 0.1, {}).statistics.fit->enclosed == 1);
  CHECK_THROWS_AS(fit(sphere.view(), pin.view(), 0, {}), InvalidInput);
  CHECK_THROWS_AS(fit(sphere.view(), Polygons().view(), 0.1, {}), InvalidInput);
}

TEST_CASE("fit: an end that is just far enough stays flat", "[fit]") {
  // Its wall gives way, its end is at the clearance: what would lack is rounding.
  Polygons peg = shapes::cylinder(0.95, 3, kFacets, 24, 6), socket = sleeve(1, 2, 0.5);
  const double floor = std::min_element(peg.positions.begin(), peg.positions.end(), [](const Vec3d& a, const Vec3d& b) {
                         return a[2] < b[2];
                       })->z();
  Polygons plate = shapes::box(Vec3d(4, 4, 1), 1, true);
  for (Vec3d& p : plate.positions) p[2] += floor - 0.1 - 0.5;
  Polygons around = socket;
  const auto first = static_cast<std::uint32_t>(socket.positions.size());
  for (std::size_t f = 0; f < plate.face_count(); ++f) {
    for (const auto v : plate.view().face(f)) around.corners.push_back(v + first);
    around.face_begin.push_back(static_cast<std::uint32_t>(around.corners.size()));
  }
  around.positions.insert(around.positions.end(), plate.positions.begin(), plate.positions.end());
  const OffsetResult result = fit(peg.view(), around.view(), 0.1, {});
  CHECK(result.statistics.fit->near == 0);
  CHECK(result.statistics.fit->moved > 0);
  for (std::size_t v = 0; v < peg.positions.size(); ++v)
    if (peg.positions[v][2] == floor) CHECK(result.positions[v][2] == floor);
}

TEST_CASE("fit: the plan is that of the first round", "[fit]") {
  const Polygons peg = shapes::cylinder(1, 4, kFacets, 16, 3), socket = sleeve(1, 2, 1);
  const OffsetStatistics plan = plan_fit(peg.view(), socket.view(), 0.1, {});
  const OffsetResult result = fit(peg.view(), socket.view(), 0.1, {});
  REQUIRE(plan.fit);
  CHECK(plan.fit->starting_gap == result.statistics.fit->starting_gap);
  CHECK(plan.fit->near_at_start == result.statistics.fit->near_at_start);
  CHECK(plan.fit->deepest == Approx(0.1).epsilon(0.01));
  CHECK(plan.plan.voxel_size > 0);
  OffsetOptions alone;
  alone.distance = -0.1;
  CHECK(plan.plan.bytes > plan_offset(peg.view(), alone).plan.bytes);  // which holds no other mesh
  alone.max_memory = plan.plan.bytes;
  CHECK_NOTHROW(plan_fit(peg.view(), socket.view(), 0.1, alone));
  alone.max_memory = 15 << 20;
  CHECK_THROWS_AS(plan_fit(peg.view(), socket.view(), 0.1, alone), OutOfBudget);
  Polygons far = shapes::icosphere(1, 2);
  for (Vec3d& p : far.positions) p += Vec3d(0, 0, 9);
  const OffsetStatistics nothing = plan_fit(peg.view(), far.view(), 0.1, {});
  CHECK(nothing.fit->near_at_start == 0);
  CHECK(nothing.plan.voxel_size == 0);
  CHECK(nothing.plan.bytes > 0);
}

TEST_CASE("fit: the same for any number of threads", "[fit]") {
  const Polygons peg = shapes::cylinder(1, 4, kFacets, 16, 3), socket = sleeve(0.98, 2, 1);
  OffsetOptions one, all;
  one.threads = 1;
  CHECK(fit(peg.view(), socket.view(), 0.05, one).positions == fit(peg.view(), socket.view(), 0.05, all).positions);
}

TEST_CASE("fit: the deepest move is that of a vertex, whose faces go by different distances", "[fit]") {
  // A box whose lid lies 1 too high for a plate above it: its four corners move by 1.2, its sides stay.
  const Polygons box = shapes::box(Vec3d(10, 10, 10), 1, true);
  Polygons plate = shapes::box(Vec3d(20, 20, 10), 1, true);
  for (Vec3d& p : plate.positions) p[2] += 9;
  const OffsetResult result = fit(box.view(), plate.view(), 0.2, {});
  REQUIRE(result.statistics.fit);
  CHECK(result.statistics.fit->near == 0);
  CHECK(result.statistics.fit->moved == 4);
  CHECK(result.statistics.fit->deepest == Approx(1.2).epsilon(1e-5));
}
