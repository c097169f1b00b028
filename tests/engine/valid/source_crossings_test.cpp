// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/source_crossings.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "vdb_offset/polygons.h"

using namespace vdb_offset;

namespace {

constexpr int kSheetCells = 12;

/// Two square sheets of kSheetCells by kSheetCells cells of size 1, no vertex of which is on the other: one in the
/// plane z = 0, one in the plane x = kSheetCells / 2 + 0.3, which cross at right angles along a line.
Polygons crossing_sheets() {
  Polygons mesh;
  for (const bool upright : {false, true}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (kSheetCells + 1) + j); };
    for (int i = 0; i <= kSheetCells; ++i)
      for (int j = 0; j <= kSheetCells; ++j)
        mesh.positions.push_back(upright ? Vec3d(kSheetCells / 2 + 0.3, i + 0.2, j - kSheetCells / 2 + 0.4)
                                         : Vec3d(i, j, 0));
    for (int i = 0; i < kSheetCells; ++i)
      for (int j = 0; j < kSheetCells; ++j) {
        mesh.add_face({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh.add_face({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return mesh;
}

/// Of each triangle whether it is within two rings of one: shares a corner with one that shares a corner with it.
std::vector<std::uint8_t> two_rings(const Surface& surface, std::uint32_t around) {
  std::vector<std::uint8_t> near(surface.triangles.size(), 0), corner(surface.vertices.size(), 0);
  for (const auto v : surface.triangles[around]) corner[v] = 1;
  for (int ring = 0; ring < 3; ++ring) {
    for (std::size_t t = 0; t < near.size(); ++t)
      for (const auto v : surface.triangles[t]) near[t] = near[t] || corner[v];
    for (std::size_t t = 0; t < near.size(); ++t)
      if (near[t])
        for (const auto v : surface.triangles[t]) corner[v] = 1;
  }
  return near;
}

}  // namespace

TEST_CASE("source crossings: two sheets that cross, against brute force", "[source_crossings][oracle]") {
  const Polygons mesh = crossing_sheets();
  const Surface surface = build_surface(mesh.view(), {});
  const auto count = static_cast<std::uint32_t>(surface.triangles.size());
  const SourceCrossings crossings(surface, CrossingFinder(surface, surface.vertices).listed());
  const auto is_upright = [&](std::uint32_t t) { return surface.face[t] >= 2 * kSheetCells * kSheetCells; };
  REQUIRE_FALSE(crossings.has_more());
  // The line crosses the diagonal and one edge of each of the cells in its column: two triangles of each sheet's cell.
  CHECK(crossings.count() >= 2 * (kSheetCells - 1));
  for (const auto& [s, t] : crossings.pairs()) CHECK(is_upright(s) != is_upright(t));

  std::vector<std::vector<std::uint8_t>> near;  // of each pair's triangles
  std::vector<std::uint8_t> expected(count, 0);
  for (const auto& pair : crossings.pairs())
    for (const auto triangle : {pair.first, pair.second}) {
      near.push_back(two_rings(surface, triangle));
      for (std::uint32_t t = 0; t < count; ++t) expected[t] = expected[t] || near.back()[t];
    }
  std::size_t apart = 0, crossed = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    CHECK(crossings.is_near(t) == static_cast<bool>(expected[t]));
    apart += !crossings.is_near(t);
  }
  CHECK(apart > 0);
  for (std::uint32_t s = 0; s < count; s += 7)
    for (std::uint32_t t = 0; t < count; t += 5) {
      bool meet = false;
      for (std::size_t p = 0; p < near.size(); p += 2)
        meet = meet || (near[p][s] && near[p + 1][t]) || (near[p + 1][s] && near[p][t]);
      crossed += meet;
      if (crossings.sheets_cross(s, t) != meet || crossings.sheets_cross(t, s) != meet) FAIL_CHECK(s << ' ' << t);
      if (meet) CHECK(is_upright(s) != is_upright(t));
    }
  CHECK(crossed > 0);
}

TEST_CASE("source crossings: a sheet alone has none, and nothing is near", "[source_crossings]") {
  Polygons mesh = crossing_sheets();
  mesh.corners.resize(mesh.corners.size() / 2);
  mesh.face_begin.resize(mesh.face_begin.size() / 2 + 1);
  const Surface surface = build_surface(mesh.view(), {});
  const SourceCrossings crossings(surface, CrossingFinder(surface, surface.vertices).listed());
  CHECK(crossings.count() == 0);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) CHECK_FALSE(crossings.is_near(t));
  CHECK_FALSE(crossings.sheets_cross(0, 1));
}

TEST_CASE("source crossings: with more pairs than are listed, it is enough to be near", "[source_crossings]") {
  const Polygons mesh = crossing_sheets();
  const Surface surface = build_surface(mesh.view(), {});
  const SelfCrossings listed = CrossingFinder(surface, surface.vertices).listed();
  SelfCrossings more{{}, true, std::vector<std::uint8_t>(surface.triangles.size(), 0)};
  for (const auto& [s, t] : listed.pairs) more.crossed[s] = more.crossed[t] = 1;
  const SourceCrossings exact(surface, listed), rough(surface, more);
  CHECK(rough.has_more());
  CHECK(rough.count() == kMostListedPairs);
  for (std::uint32_t s = 0; s < surface.triangles.size(); ++s) {
    CHECK(rough.is_near(s) == exact.is_near(s));
    for (std::uint32_t t = 0; t < surface.triangles.size(); t += 11)
      if (rough.sheets_cross(s, t) != (rough.is_near(s) && rough.is_near(t))) FAIL_CHECK(s << ' ' << t);
  }
}
