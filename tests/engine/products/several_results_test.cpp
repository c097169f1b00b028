// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <vector>

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// Two squares beside each other, each with four vertices of its own: two positions have two vertices each.
Polygons two_squares() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
  mesh.add_face({0, 1, 2, 3});
  mesh.add_face({4, 5, 6, 7});
  return mesh;
}

/// 0.1 everywhere, but 0.2 at the vertex 2, which shares its position with the vertex 7.
Distances one_apart() { return Distances(std::vector<double>{0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.1, 0.1}); }

std::vector<std::size_t> disagreeing(const std::vector<OffsetResult>& results) {
  std::vector<std::size_t> counts;
  for (const OffsetResult& result : results) counts.push_back(result.statistics.disagreeing_distances);
  return counts;
}

}  // namespace

TEST_CASE("several: each result counts its own distances that disagree, in any order", "[offset]") {
  const Polygons mesh = two_squares();
  const Distances apart = one_apart(), even(0.1), none(0);
  CHECK(disagreeing(offset_several(mesh.view(), std::array{apart, even}, {})) == std::vector<std::size_t>{1, 0});
  CHECK(disagreeing(offset_several(mesh.view(), std::array{even, apart}, {})) == std::vector<std::size_t>{0, 1});
  CHECK(disagreeing(offset_several(mesh.view(), std::array{none, apart, even}, {})) ==
        std::vector<std::size_t>{0, 1, 0});
  const std::vector<OffsetResult> results = offset_several(mesh.view(), std::array{apart, even}, {});
  CHECK(results[0].distances[2] == Approx(0.15));
  CHECK(results[0].distances[7] == Approx(0.15));
  CHECK(results[1].distances[2] == 0.1);
}

TEST_CASE("several: each result of curves counts its own distances that disagree", "[curves]") {
  Curves curves;
  curves.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 1, 0}};
  curves.add_face({0, 1});
  curves.add_face({2, 3});
  const Distances apart(std::vector<double>{0.1, 0.2, 0.1, 0.1}), even(0.1);
  CHECK(disagreeing(offset_curves(curves.view(), std::array{apart, even}, {})) == std::vector<std::size_t>{1, 0});
  CHECK(disagreeing(offset_curves(curves.view(), std::array{even, apart}, {})) == std::vector<std::size_t>{0, 1});
}

TEST_CASE("several: layers count the vertices of the height at which most disagree", "[layers]") {
  const Polygons mesh = two_squares();
  const Distances apart(std::vector<double>{0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.1, 0.1}), even(0.3);
  CHECK(grow_layers(mesh.view(), std::array{apart, even}, {}).statistics.disagreeing_distances == 1);
}

TEST_CASE("several: what is bound at one distance is not at another", "[offset]") {
  // A sheet that lies on its obstacle with half of it: its vertices there are bound if they are to move into that,
  // and free if they are not to move at all.
  Polygons sheet, floor;
  constexpr std::uint32_t kAcross = 9;
  for (std::uint32_t j = 0; j < kAcross; ++j)
    for (std::uint32_t i = 0; i < kAcross; ++i)
      sheet.positions.emplace_back(i, j, i < kAcross / 2 ? 0.0 : 0.5 * (i - kAcross / 2 + 1));
  for (std::uint32_t j = 0; j + 1 < kAcross; ++j)
    for (std::uint32_t i = 0; i + 1 < kAcross; ++i) {
      const std::uint32_t a = j * kAcross + i;
      sheet.add_face({a, a + 1, a + kAcross + 1, a + kAcross});
    }
  floor.positions = {{-9, -9, 0}, {19, -9, 0}, {19, 19, 0}, {-9, 19, 0}};
  floor.add_face({0, 1, 2, 3});
  std::vector<double> far_half(sheet.positions.size(), 0.0);
  for (std::size_t v = 0; v < far_half.size(); ++v) far_half[v] = sheet.positions[v][0] > kAcross / 2 + 1 ? 0.2 : 0;
  OffsetOptions options;
  options.obstacles = floor.view();
  const InMetric space(sheet.view(), {});
  const auto bound = [&](std::vector<Distances> wanted) {
    PreparedMesh mesh(space, options, 1, farthest_of(wanted), {.results = wanted.size()});
    std::vector<Distances> of_all;
    std::size_t disagreeing = 0;
    for (const Distances& each : wanted) of_all.push_back(mesh.distances_of_all(each, disagreeing));
    std::vector<std::size_t> counts;
    for (const PreparedMesh::Marched& each : mesh.march(of_all, Ridges::Smooth))
      counts.push_back(static_cast<std::size_t>(std::count(each.bound.begin(), each.bound.end(), 1)));
    return counts;
  };
  const Distances all(0.2), some(far_half);
  const std::size_t many = bound({all}).front(), few = bound({some}).front();
  CHECK(many > 0);
  CHECK(few < many);
  CHECK(bound({all, some}) == std::vector<std::size_t>{many, few});
  CHECK(bound({some, all}) == std::vector<std::size_t>{few, many});
}
