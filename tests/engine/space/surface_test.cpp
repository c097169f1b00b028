// SPDX-License-Identifier: Apache-2.0
#include "space/surface/surface.h"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "ground/mesh/triangulate.h"
#include "support/oracles.h"
#include "vdb_offset/openmesh.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

double area_of(const std::vector<Vec3d>& p, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += (p[b] - p[a]).cross(p[c] - p[a])[2] / 2;
  return sum;
}

}  // namespace

TEST_CASE("triangulate: a convex polygon becomes the fan around its first corner", "[surface]") {
  const std::vector<Vec3d> p = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(p, std::vector<std::uint32_t>{0, 1, 2, 3}, triangles);
  CHECK(triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("triangulate: a concave polygon is covered once", "[surface]") {
  // An L of area 3 whose fan around corner 0 would turn both ways.
  const std::vector<Vec3d> p = {{1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}, {2, 1, 0}};
  const std::vector<std::uint32_t> corners = {1, 2, 3, 4, 5, 0};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(p, corners, triangles);
  REQUIRE(triangles.size() == 4);
  for (const auto& t : triangles) CHECK(area_of(p, {t}) > 0);
  CHECK(area_of(p, triangles) == Approx(3));
}

TEST_CASE("triangulate: a corner on a straight side is one of triangles with an area", "[surface]") {
  // A triangle with corners on its sides, begun at each of its corners.
  const std::vector<Vec3d> p = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1.5, 2, 0}, {0, 4, 0}, {0, 1, 0}};
  const auto check = [&](std::vector<std::uint32_t> corners) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      std::vector<std::array<std::uint32_t, 3>> triangles;
      triangulate(p, corners, triangles);
      REQUIRE(triangles.size() == corners.size() - 2);
      for (const auto& t : triangles) CHECK(area_of(p, {t}) > 0.1);
      CHECK(area_of(p, triangles) == Approx(6));
    }
  };
  check({0, 1, 2, 4});
  check({0, 2, 3, 4});
  check({0, 2, 4, 5});
  check({0, 1, 2, 3, 4});
  check({0, 1, 2, 3, 4, 5});
}

TEST_CASE("triangulate: a spike, which has no area, does not turn a triangle over", "[surface]") {
  // From the first corner to the second, and back to the third, which is on the way.
  const std::vector<Vec3d> p = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(p, std::vector<std::uint32_t>{0, 1, 2, 3}, triangles);
  CHECK(triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("triangulate: a polygon with a bridge to a hole leaves the hole open", "[surface]") {
  // A square of side 3 with a hole of side 1, joined by a bridge that is run through twice.
  const std::vector<Vec3d> p = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(p, std::vector<std::uint32_t>{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}, triangles);
  REQUIRE(triangles.size() == 8);
  for (const auto& t : triangles) CHECK(area_of(p, {t}) >= 0);
  CHECK(area_of(p, triangles) == Approx(8));
}

TEST_CASE("triangulate: of a large polygon no corner gets more than a few triangles", "[surface]") {
  // A star, and what is left of it without its tips, of which all fans would do.
  for (const std::size_t step : {1, 2}) {
    constexpr std::size_t kCorners = 4000;
    std::vector<Vec3d> p;
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < kCorners; ++i) {
      const double angle = 2 * M_PI * static_cast<double>(i) / kCorners, radius = i % 2 == 0 ? 0.5 : 1;
      p.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
      if (i % step == 0) corners.push_back(static_cast<std::uint32_t>(i));
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangulate(p, corners, triangles);
    REQUIRE(triangles.size() == corners.size() - 2);
    std::vector<std::size_t> around(p.size(), 0);
    double least = 1;
    for (const auto& t : triangles) {
      least = std::min(least, area_of(p, {t}));
      for (const auto v : t) ++around[v];
    }
    CHECK(least > 0);
    // Twice the area of a triangle between neighbouring corners and the middle, so many times.
    const double side = step == 1 ? 0.5 * std::sin(2 * M_PI / kCorners) : 0.25 * std::sin(4 * M_PI / kCorners);
    CHECK(area_of(p, triangles) == Approx(static_cast<double>(corners.size()) * side / 2));
    CHECK(*std::max_element(around.begin(), around.end()) <= 2 * std::bit_width(kCorners));
  }
}

TEST_CASE("triangulate: a large polygon that crosses itself gets as many triangles", "[surface]") {
  // Eleven times around.
  std::vector<Vec3d> p;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const double angle = 22 * M_PI * i / 2000, radius = 1 + 0.1 * std::sin(angle / 11);
    p.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    corners.push_back(i);
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(p, corners, triangles);
  CHECK(triangles.size() == 1998);
}

TEST_CASE("surface: facts of known shapes", "[surface]") {
  SECTION("closed") {
    const Surface cube = build_surface(shapes::box(Vec3d(1), 4, false).view(), {});
    CHECK(cube.facts.closed());
    CHECK(cube.facts.oriented());
    CHECK(cube.facts.components == 1);
    CHECK(cube.facts.faces_by_corners == std::map<std::size_t, std::size_t>{{4, 96}});
    CHECK(cube.facts.area == Approx(6));
    CHECK(cube.facts.diagonal == Approx(std::sqrt(3)));
    CHECK(cube.triangles.size() == 192);
  }
  SECTION("open") {
    const Surface patch = build_surface(shapes::patch(1, 0, 8).view(), {});
    CHECK(patch.facts.boundary_edges == 32);
    CHECK_FALSE(patch.facts.closed());
  }
  SECTION("two components") { CHECK(build_surface(shapes::plates(1, 0.1, 0.1, 3).view(), {}).facts.components == 2); }
  SECTION("three faces on an edge, and one turned against its neighbour") {
    Polygons fins;
    fins.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    fins.add_face({0, 1, 2});
    fins.add_face({0, 1, 3});
    const MeshFacts pair = build_surface(fins.view(), {}).facts;
    CHECK(pair.orientation_conflicts == 1);
    CHECK(pair.turned_triangles == 1);
    CHECK(pair.unsettled_conflicts == 0);
    fins.add_face({0, 1, 4});
    const MeshFacts facts = build_surface(fins.view(), {}).facts;
    CHECK(facts.non_manifold_edges == 1);
    CHECK(facts.boundary_edges == 6);
  }
  SECTION("degenerate faces and unused vertices") {
    Polygons mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {9, 9, 9}};
    mesh.add_face({0, 1, 2});
    mesh.add_face({0, 1, 1});
    mesh.add_face({0, 1, 3});
    const MeshFacts facts = build_surface(mesh.view(), {}).facts;
    CHECK(facts.degenerate_faces == 2);
    CHECK(facts.unused_vertices == 1);
    CHECK(facts.upper == Vec3d(2, 1, 0));  // the unused vertex does not count
  }
}

TEST_CASE("surface: welding joins a torn mesh, and only when asked", "[surface]") {
  const Polygons soup = test::torn(shapes::box(Vec3d(1), 3, true));
  CHECK(build_surface(soup.view(), {}).facts.closed());
  CHECK(build_surface(soup.view(), {}).facts.welded_vertices == 56);
  CHECK(build_surface(soup.view(), {false, 0}).facts.boundary_edges == 3 * soup.face_count());

  Polygons shaken = soup;
  for (std::size_t v = 0; v < shaken.positions.size(); ++v)
    shaken.positions[v][static_cast<int>(v % 3)] += 1e-7 * (v % 5);
  CHECK_FALSE(build_surface(shaken.view(), {}).facts.closed());
  CHECK(build_surface(shaken.view(), {true, 1e-6}).facts.closed());
}

TEST_CASE("surface: minus zero stands where zero stands", "[surface]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, 0}, {0, 1, -0.0}, {-1, 0, 0}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({3, 4, 5});
  CHECK(build_surface(mesh.view(), {}).facts.welded_vertices == 4);
}

TEST_CASE("surface: every broken precondition is told", "[surface]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK_THROWS_WITH(build_surface(mesh.view(), {}), Catch::Contains("at least one face"));
  mesh.add_face({0, 1, 3});
  CHECK_THROWS_WITH(build_surface(mesh.view(), {}), Catch::Contains("below 3, got 3"));
  mesh.corners[2] = 2;
  CHECK_THROWS_WITH(build_surface(mesh.view(), {true, -1}), Catch::Contains("tolerance"));
  CHECK_THROWS_WITH(build_surface(mesh.view(), {true, 1e-300}), Catch::Contains("above the rounding"));
  mesh.positions[1][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(build_surface(mesh.view(), {}),
                    Catch::Contains("finite coordinates") && Catch::Contains("vertex 1"));
  mesh.positions[1][1] = 0;
  mesh.add_face({0, 1});
  CHECK_THROWS_WITH(build_surface(mesh.view(), {}), Catch::Contains("3 corners in face 1"));
}

TEST_CASE("surface: a few faces turned the wrong way are turned back, inside only", "[surface]") {
  const Polygons cube = shapes::box(Vec3d(1), 4, true);
  Polygons muddled = cube;
  for (std::size_t f = 0; f < cube.face_count(); f += 5) std::swap(muddled.corners[3 * f], muddled.corners[3 * f + 1]);
  Surface good = build_surface(cube.view(), {}), mended = build_surface(muddled.view(), {});
  CHECK(mended.facts.orientation_conflicts > 0);
  CHECK(mended.facts.turned_triangles == (cube.face_count() + 4) / 5);
  CHECK(mended.facts.oriented());
  to_local_frame(good, 0.1);
  to_local_frame(mended, 0.1);
  for (std::size_t t = 0; t < good.triangles.size(); ++t)
    CHECK((good.triangle_normals[t] - mended.triangle_normals[t]).length() < 1e-12);
  for (std::uint32_t e = 0; e < mended.next_around_edge.size(); ++e) {
    const std::uint32_t twin = mended.next_around_edge[e];
    CHECK(mended.next_around_edge[twin] == e);
    CHECK(mended.triangles[e / 3][e % 3] == mended.triangles[twin / 3][(twin % 3 + 1) % 3]);
  }
}

TEST_CASE("surface: a strip with one side only is left as it is, and told", "[surface]") {
  Polygons moebius;
  const int steps = 40;
  for (int i = 0; i < steps; ++i) {
    const double angle = 2 * 3.14159265358979 * i / steps;
    for (const double w : {-0.3, 0.3})
      moebius.positions.push_back(Vec3d(std::cos(angle) * (1 + w * std::cos(angle / 2)),
                                        std::sin(angle) * (1 + w * std::cos(angle / 2)), w * std::sin(angle / 2)));
  }
  for (std::uint32_t i = 0; i < steps; ++i) {
    const std::uint32_t next = (i + 1) % steps, a = 2 * i, b = a + 1, crossed = next == 0;
    moebius.add_face({a, 2 * next + crossed, 2 * next + 1 - crossed, b});
  }
  const MeshFacts facts = build_surface(moebius.view(), {}).facts;
  CHECK(facts.boundary_edges == 2 * steps);
  CHECK(facts.unsettled_conflicts == 1);
  CHECK(facts.turned_triangles == 0);
  CHECK_FALSE(facts.oriented());
}

TEST_CASE("surface: a face over the corners of an earlier one counts once inside", "[surface]") {
  const Polygons cube = shapes::box(Vec3d(1), 3, false);
  const Surface once = build_surface(cube.view(), {});
  Polygons doubled = cube;
  for (std::size_t f = 0; f < cube.face_count(); ++f) {
    const auto face = cube.view().face(f);
    std::vector<std::uint32_t> copy(face.begin(), face.end());
    std::rotate(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(f % 4), copy.end());
    if (f % 3 != 0) std::reverse(copy.begin(), copy.end());
    doubled.corners.insert(doubled.corners.end(), copy.begin(), copy.end());
    doubled.close_face();
  }
  const Surface twice = build_surface(doubled.view(), {});
  CHECK(twice.facts.repeated_faces == cube.face_count());
  CHECK(twice.facts.non_manifold_edges >= 2 * cube.face_count());  // and diagonals where both have the same
  CHECK(twice.facts.non_manifold_left == 0);
  CHECK(twice.facts.closed());
  CHECK(twice.facts.oriented());
  CHECK(twice.triangles.size() == once.triangles.size());
  CHECK(once.facts.repeated_faces == 0);
}

TEST_CASE("surface: other faces over the same corners are no repetition", "[surface]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.add_face({0, 1, 2, 3});
  mesh.add_face({0, 2, 1, 3});
  mesh.add_face({0, 1, 2, 4});
  CHECK(build_surface(mesh.view(), {}).facts.repeated_faces == 0);
}

TEST_CASE("surface: of two bent faces that share three corners in a row, one is folded over", "[surface]") {
  // Corner 1 has two edges only; the second quad is bent there, and its fan lies on the first's.
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, -0.1, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}};
  mesh.add_face({0, 1, 2, 3});
  mesh.add_face({2, 1, 0, 4});
  const Surface surface = build_surface(mesh.view(), {});
  CHECK(surface.facts.repeated_faces == 0);
  CHECK(surface.facts.folded_triangles == 1);
  CHECK(surface.triangles.size() == 3);
}

TEST_CASE("surface: faces with a repeated corner leave a closed mesh closed", "[surface]") {
  Polygons mesh = shapes::box(Vec3d(1), 2, true);
  mesh.add_face({0, 1, 1});
  mesh.add_face({3, 3, 3});
  const Surface surface = build_surface(mesh.view(), {});
  CHECK(surface.facts.degenerate_faces == 2);
  CHECK(surface.facts.closed());
  CHECK(surface.facts.components == 1);
  CHECK(surface.triangles.size() == mesh.face_count() - 2);
  // One that holds a vertex of no other face stays, so that every vertex in use has a triangle.
  mesh.positions.push_back({5, 5, 5});
  const auto lonely = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.add_face({lonely, lonely, 0});
  const Surface with = build_surface(mesh.view(), {});
  CHECK_FALSE(with.triangles_around(with.welded[lonely]).empty());
  CHECK_FALSE(with.facts.closed());
}

TEST_CASE("surface: pseudonormals tell the side at faces, edges and vertices", "[surface]") {
  Surface cube = build_surface(shapes::box(Vec3d(2), 2, true).view(), {});
  to_local_frame(cube, 0.1);
  for (const Vec3d& outside : {Vec3d(3, 0.1, 0.2), Vec3d(2, 2, 0.1), Vec3d(2, 2, 2), Vec3d(1.1, -1.1, 1.05)})
    for (const double scale : {1.0, 0.3}) {  // outside, and the same direction inside
      const Vec3d x = outside * scale - cube.origin;
      std::uint32_t best = 0;
      for (std::uint32_t t = 1; t < cube.triangles.size(); ++t)
        if (cube.closest_on(t, x).squared_distance < cube.closest_on(best, x).squared_distance) best = t;
      const TrianglePoint at = cube.closest_on(best, x);
      CHECK((cube.pseudonormal(best, at.feature).dot(x - at.point) > 0) == (scale == 1.0));
    }
}

TEST_CASE("mesh: a half-edge mesh goes there and back unchanged", "[surface]") {
  const Polygons cube = shapes::box(Vec3d(1), 3, false);
  const Polygons back = to_polygons(to_mesh(cube.view()));
  CHECK(back.positions == cube.positions);
  CHECK(back.corners == cube.corners);
  CHECK(back.face_begin == cube.face_begin);
  Polygons fins;
  fins.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  for (const std::uint32_t tip : {2u, 3u, 4u}) fins.add_face({0, 1, tip});
  CHECK_THROWS_AS(to_mesh(fins.view()), InvalidInput);
}
