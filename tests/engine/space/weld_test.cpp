// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <limits>

#include "space/surface/surface.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

using Firsts = std::vector<std::uint32_t>;

/// A triangle over each three of the positions.
Polygons triangles(std::vector<Vec3d> positions) {
  Polygons mesh;
  mesh.positions = std::move(positions);
  for (std::uint32_t v = 0; v + 2 < mesh.positions.size(); v += 3) mesh.add_face({v, v + 1, v + 2});
  return mesh;
}

Firsts firsts(const Polygons& mesh, const WeldOptions& options) { return find_welding(mesh.view(), options).first; }

constexpr WeldOptions kExact{}, kNever{.enabled = false};

WeldOptions within(double tolerance) { return {.tolerance = tolerance}; }

}  // namespace

TEST_CASE("weld: vertices with the same bits are the first of them", "[weld]") {
  const Polygons mesh = triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(firsts(mesh, kExact) == Firsts{0, 1, 2, 1, 4, 2});
  CHECK(firsts(mesh, kNever) == Firsts{0, 1, 2, 3, 4, 5});
}

TEST_CASE("weld: 0 and -0 are one, the next number is another", "[weld]") {
  const double next = std::nextafter(1.0, 2.0);
  const Polygons mesh = triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {next, 0, 0}, {0, 1, 0}});
  CHECK(firsts(mesh, kExact) == Firsts{0, 1, 2, 0, 4, 2});
}

TEST_CASE("weld: a vertex that no face uses is none, and none is welded with it", "[weld]") {
  Polygons mesh;
  mesh.positions = {{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.add_face({1, 2, 3});
  CHECK(firsts(mesh, kExact) == Firsts{kNone, 1, 2, 3});
  CHECK(firsts(mesh, within(0.1)) == Firsts{kNone, 1, 2, 3});
}

TEST_CASE("weld: a tolerance counts from the first vertex, not along a chain", "[weld]") {
  // Each is 0.08 from the one before; the third is 0.16 from the first.
  const Polygons mesh = triangles({{0, 0, 0}, {5, 0, 0}, {0, 5, 0}, {0.08, 0, 0}, {9, 0, 0}, {0.16, 0, 0}});
  CHECK(firsts(mesh, within(0.1)) == Firsts{0, 1, 2, 0, 4, 5});
  CHECK(firsts(mesh, within(0.2)) == Firsts{0, 1, 2, 0, 4, 0});
  CHECK(firsts(mesh, within(0.0)) == Firsts{0, 1, 2, 3, 4, 5});
}

TEST_CASE("weld: a tolerance holds across the cells of its hash, also below zero", "[weld]") {
  const Polygons mesh =
      triangles({{-0.01, -0.01, -0.01}, {5, 0, 0}, {0, 5, 0}, {0.01, 0.01, 0.01}, {5, 0, 9}, {0, 5, 9}});
  CHECK(firsts(mesh, within(0.05))[3] == 0);
  CHECK(firsts(mesh, within(0.03))[3] == 3);  // 0.0346 apart
}

TEST_CASE("weld: tolerances that cannot be used are refused", "[weld]") {
  const Polygons mesh = triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (const double tolerance :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(find_welding(mesh.view(), within(tolerance)), InvalidInput);
}

TEST_CASE("weld: a surface has a vertex for each position in use", "[weld]") {
  const Polygons mesh = triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const Surface surface = build_surface(mesh.view(), kExact);
  REQUIRE(surface.vertices.size() == 4);
  CHECK(surface.facts.welded_vertices == 4);
  CHECK(surface.facts.boundary_edges == 4);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    CHECK(surface.vertices[surface.welded[v]] == mesh.positions[v]);
    CHECK(surface.welded[v] == surface.welded[firsts(mesh, kExact)[v]]);
  }
  CHECK(build_surface(mesh.view(), kNever).facts.boundary_edges == 6);
}
