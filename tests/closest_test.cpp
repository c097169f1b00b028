#include "vdb_offset/closest.h"

#include <tbb/task_arena.h>

#include <catch2/catch.hpp>
#include <random>

#include "oracles.h"
#include "vdb_offset/scene/shapes.h"

using namespace vdb_offset;

namespace {

/// Largest difference from brute force at random points in and around the mesh, with random hints.
double worst_difference(const Polygons& mesh, int points, double margin) {
  Surface surface = build_surface(mesh.view(), {});
  place(surface, surface.facts.diagonal / 50);
  const ClosestQuery query(surface);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    Vec3d x;
    for (int k = 0; k < 3; ++k)
      x[k] = surface.facts.lower[k] - margin +
             (surface.facts.upper[k] - surface.facts.lower[k] + 2 * margin) * unit(random);
    const auto hint = static_cast<std::uint32_t>(random() % surface.triangles.size());
    const Closest closest = query(x - surface.origin, hint);
    worst = std::max(worst, std::abs(closest.distance - test::brute_force_distance(mesh.view(), x)));
    worst = std::max(worst, std::abs((closest.point + surface.origin - x).length() - closest.distance));
  }
  return worst;
}

}  // namespace

TEST_CASE("closest: equals brute force", "[closest]") {
  // 1e-12 of the diagonal: rounding of coordinates of size 1 and a few operations on them.
  CHECK(worst_difference(scene::bumpy_sphere(1, 0.3, 1.5, 3, 4), 400, 0.5) < 4e-12);
  CHECK(worst_difference(scene::plates(1, 0.01, 0.001, 20), 400, 0.2) < 2e-12);
  CHECK(worst_difference(scene::naca_wing("0012", 1, 1, 40, 10), 400, 0.1) < 2e-12);
  CHECK(worst_difference(scene::box(Vec3d(1, 100, 0.001), 1, true), 400, 1) < 1e-10);
}

TEST_CASE("closest: equals brute force at any scale and place", "[closest]") {
  for (const double scale : {1e-30, 1e-6, 1e6, 1e30}) {
    Polygons mesh = scene::icosphere(scale, 3);
    CHECK(worst_difference(mesh, 100, scale) < 4e-12 * scale);
  }
  Polygons far = scene::icosphere(1, 3);
  for (Vec3d& p : far.positions) p += Vec3d(1e6, -2e6, 3e6);
  CHECK(worst_difference(far, 100, 1) < 1e-8);  // the coordinates themselves are rounded to 5e-10
}

TEST_CASE("closest: many points at once have the answers of one by one, for any number of threads", "[closest]") {
  Surface surface = build_surface(scene::bumpy_sphere(1, 0.3, 1.5, 3, 4).view(), {});
  place(surface, 0.05);
  const ClosestQuery query(surface);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 3);
  std::vector<Vec3d> points(3000);
  for (Vec3d& x : points) x = Vec3d(unit(random), unit(random), unit(random));
  const std::vector<Closest> all = closest_points(query, points);
  tbb::task_arena one(1);
  one.execute([&] {
    const std::vector<Closest> alone = closest_points(query, points);
    std::size_t different = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      different += alone[i].distance != all[i].distance || alone[i].triangle != all[i].triangle;
    CHECK(different == 0);
  });
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    worst = std::max(worst, std::abs(all[i].distance - query(points[i], 0).distance));
  CHECK(worst < 1e-14);
}

TEST_CASE("closest: points on ways up from the surface have the answers of one by one", "[closest]") {
  Surface surface = build_surface(scene::bumpy_sphere(1, 0.5, 2.5, 3, 4).view(), {});
  place(surface, 0.05);
  const ClosestQuery query(surface);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3d> points;
  std::vector<std::size_t> begin{0};
  std::vector<std::uint32_t> hints;
  for (std::uint32_t v = 0; v < surface.vertices.size(); v += 3) {
    // Some go straight up, in any order; some anywhere, and into hollows where another part of the surface is closest.
    const int count = 1 + static_cast<int>(random() % 5);
    const Vec3d n = surface.vertex_normals[v].unit(), aside = Vec3d(unit(random), unit(random), unit(random)) * 0.3;
    for (int i = 0; i < count; ++i)
      points.push_back(surface.vertices[v] + n * unit(random) + (v % 2 ? aside * unit(random) : Vec3d(0.0)));
    begin.push_back(points.size());
    hints.push_back(v % 5 ? surface.triangles_around(v).front() : 0);
  }
  std::vector<Closest> answers(points.size());
  query.answer_along_ways(points, begin, hints, answers);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [distance, triangle, feature, point] = answers[i];
    worst = std::max({worst, std::abs(distance - query(points[i], 0).distance),
                      std::abs((points[i] - point).length() - distance),
                      std::abs(std::sqrt(surface.closest_on(triangle, points[i]).squared_distance) - distance)});
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("closest: a triangle without area is its edges", "[closest]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.25, 0, 0}, {0, 1, 0}};
  mesh.add_face({0, 1, 2});
  CHECK(worst_difference(mesh, 200, 1) < 1e-12);
  mesh.add_face({0, 0, 3});
  CHECK(worst_difference(mesh, 200, 1) < 1e-12);
}

TEST_CASE("closest: the feature is the one that the point lies on", "[closest]") {
  const Vec3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  CHECK(closest_on_triangle({0.2, 0.2, 1}, a, b, c).feature == Feature::Face);
  CHECK(closest_on_triangle({0.5, -1, 0}, a, b, c).feature == Feature::Edge0);
  CHECK(closest_on_triangle({1, 1, 0.3}, a, b, c).feature == Feature::Edge1);
  CHECK(closest_on_triangle({-1, 0.5, 0}, a, b, c).feature == Feature::Edge2);
  CHECK(closest_on_triangle({-1, -1, 2}, a, b, c).feature == Feature::Vertex0);
  CHECK(closest_on_triangle({3, -0.5, 0}, a, b, c).feature == Feature::Vertex1);
  CHECK(closest_on_triangle({-0.5, 3, 0}, a, b, c).feature == Feature::Vertex2);
}

TEST_CASE("oracle: brute force rejects a wrong distance", "[closest][oracle]") {
  const Polygons cube = scene::box(Vec3d(2), 2, true);
  CHECK(test::brute_force_distance(cube.view(), {3, 0, 0}) == Approx(2).epsilon(1e-14));
  CHECK(test::brute_force_distance(cube.view(), {2, 2, 2}) == Approx(std::sqrt(3)).epsilon(1e-14));
  CHECK_FALSE(test::brute_force_distance(cube.view(), {3.001, 0, 0}) == Approx(2).epsilon(1e-6));
  CHECK(test::is_inside(cube.view(), {0.9, 0.1, 0.2}));
  CHECK_FALSE(test::is_inside(cube.view(), {1.1, 0.1, 0.2}));
}
