// SPDX-License-Identifier: Apache-2.0
#include "space/query/closest_query.h"

#include <tbb/task_arena.h>

#include <catch2/catch.hpp>
#include <random>

#include "space/query/vertex_fan.h"
#include "support/oracles.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// Largest difference from brute force at random points in and around the mesh, with random hints.
double worst_difference(const Polygons& mesh, int points, double margin) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, surface.facts.diagonal / 50);
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

TEST_CASE("closest: points beyond all that floats can square have an answer", "[query]") {
  const Polygons box = shapes::box({1, 1, 1}, 1, true);  // of 12 triangles, in lowest boxes of 8
  Surface surface = build_surface(box.view(), {});
  to_local_frame(surface, surface.facts.diagonal / 50);
  const ClosestQuery query(surface);
  for (const double far : {1e12, 1e18, 1e25, 1e100}) {
    const std::vector<Vec3d> points(3, Vec3d(far, 0.25, 0.25) - surface.origin);
    const std::vector<std::uint32_t> hints(points.size(), 0);
    std::vector<Closest> answers(points.size());
    query.answer_together(points, hints, answers);
    answers.push_back(query(points.front(), 0));
    for (const Closest& closest : answers) {
      CHECK(closest.triangle < surface.triangles.size());
      CHECK(closest.distance == Approx(far));
    }
  }
}

TEST_CASE("closest: equals brute force", "[closest]") {
  // 1e-12 of the diagonal: rounding of coordinates of size 1 and a few operations on them.
  CHECK(worst_difference(shapes::bumpy_sphere(1, 0.3, 1.5, 3, 4), 400, 0.5) < 4e-12);
  CHECK(worst_difference(shapes::plates(1, 0.01, 0.001, 20), 400, 0.2) < 2e-12);
  CHECK(worst_difference(shapes::naca_wing("0012", 1, 1, 40, 10), 400, 0.1) < 2e-12);
  CHECK(worst_difference(shapes::box(Vec3d(1, 100, 0.001), 1, true), 400, 1) < 1e-10);
}

TEST_CASE("closest: equals brute force at any scale and position", "[closest]") {
  for (const double scale : {1e-30, 1e-6, 1e6, 1e30}) {
    Polygons mesh = shapes::icosphere(scale, 3);
    CHECK(worst_difference(mesh, 100, scale) < 4e-12 * scale);
  }
  Polygons far = shapes::icosphere(1, 3);
  for (Vec3d& p : far.positions) p += Vec3d(1e6, -2e6, 3e6);
  CHECK(worst_difference(far, 100, 1) < 1e-8);  // the coordinates themselves are rounded to 5e-10
}

TEST_CASE("closest: many points at once have the answers of one by one, for any number of threads", "[closest]") {
  Surface surface = build_surface(shapes::bumpy_sphere(1, 0.3, 1.5, 3, 4).view(), {});
  to_local_frame(surface, 0.05);
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
  Surface surface = build_surface(shapes::bumpy_sphere(1, 0.5, 2.5, 3, 4).view(), {});
  to_local_frame(surface, 0.05);
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
    for (int i = 0; i < count; ++i) {
      points.push_back(surface.vertices[v] + n * unit(random) + (v % 2 ? aside * unit(random) : Vec3d(0.0)));
      hints.push_back(v % 5 ? surface.triangles_around(v).front() : 0);
    }
    begin.push_back(points.size());
  }
  std::vector<Closest> answers(points.size());
  query.answer_along_paths(points, begin, hints, answers);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [distance, triangle, feature, tied, point] = answers[i];
    worst = std::max({worst, std::abs(distance - query(points[i], 0).distance),
                      std::abs((points[i] - point).length() - distance),
                      std::abs(std::sqrt(surface.closest_on(triangle, points[i]).squared_distance) - distance)});
  }
  CHECK(worst < 1e-14);
}

namespace {

/// Counts the triangles that collect_together() misses of those that meet random balls near the mesh, and
/// visit_nearer() of those that are nearer than a distance, before and after planes have been moved; the triangles that
/// are visited; and those of them that are not nearer.
struct Planes {
  std::size_t missed = 0, visited = 0, needless = 0;
};
Planes try_planes(const Polygons& mesh, double size) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, surface.facts.diagonal / 50);
  const ClosestQuery query(surface);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> signed_unit(-1, 1);
  const auto somewhere = [&] { return Vec3d(signed_unit(random), signed_unit(random), signed_unit(random)); };
  const auto distance = [&](std::size_t t, const Vec3d& x) {
    return std::sqrt(surface.closest_on(static_cast<std::uint32_t>(t), x).squared_distance);
  };
  std::vector<ClosestQuery::Ball> balls;
  for (int i = 0; i < 40; ++i) {
    const Vec3d x = surface.vertices[random() % surface.vertices.size()] + somewhere() * size;
    balls.push_back({x, query(x, 0).distance * (1.01 + std::abs(signed_unit(random)))});
  }
  Planes found;
  query.collect_together(balls, [&](std::size_t i, NearTriangles& near) {
    const auto& [centre, radius] = balls[i];
    std::vector<std::uint8_t> held(surface.triangles.size(), 0);
    for (std::size_t n = 0; n < near.size(); ++n) held[near.triangle(n)] = 1;
    for (std::size_t t = 0; t < held.size(); ++t) found.missed += held[t] == 0 && distance(t, centre) < radius;
    for (int k = 0; k < 12; ++k) {
      const Vec3d x = centre + somewhere() * (0.4 * radius);
      const double limit = query(x, 0).distance * (1 + 0.2 * std::abs(signed_unit(random)));
      std::vector<std::uint8_t> visited(near.size(), 0);
      near.visit_nearer(x, limit, [&](std::size_t n) {
        visited[n] = 1;
        return limit;
      });
      for (std::size_t n = 0; n < near.size(); ++n) {
        const TrianglePoint point = surface.closest_on(near.triangle(n), x);
        const double at = std::sqrt(point.squared_distance);
        found.missed += visited[n] == 0 && at < limit;
        found.visited += visited[n];
        found.needless += visited[n] != 0 && at > 1.1 * limit;
        if (random() % 3 == 0) near.hold_back(n, x, x - point.point, at);
      }
    }
    std::vector<std::uint32_t> left;
    for (std::size_t n = 0; n < near.size(); ++n)
      if (near.triangle(n) % 3 != 0) left.push_back(near.triangle(n));
    near.remove_if([](std::uint32_t t) { return t % 3 == 0; });
    std::vector<std::uint32_t> kept;
    near.visit_nearer(centre, 2 * surface.facts.diagonal, [&](std::size_t n) {
      kept.push_back(near.triangle(n));
      return 2 * surface.facts.diagonal;
    });
    found.missed += kept != left;
  });
  return found;
}

/// The worst difference, relative to the mesh's diagonal, of distances to vertices' fans from those to their triangles;
/// how many triangles around vertices were in no fan, and how often it was wrong about which are.
struct Fans {
  double worst = 0;
  std::size_t left_out = 0, wrong = 0;
};
Fans try_fans(const Polygons& mesh) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, surface.facts.diagonal / 50);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> signed_unit(-1, 1);
  VertexFan fan;
  Fans found;
  for (std::uint32_t v = 0; v < surface.vertices.size(); ++v) {
    fan.begin(surface, v);
    const auto around = surface.triangles_around(v);
    for (const auto t : around) found.left_out += !fan.has(t);
    for (std::uint32_t t = 0; t < std::min<std::size_t>(surface.triangles.size(), 200); ++t)
      found.wrong += fan.has(t) && std::find(around.begin(), around.end(), t) == around.end();
    for (const double size : {1e-6, 1e-3, 1.0}) {
      const auto near = [&] {
        const Vec3d way(signed_unit(random), signed_unit(random), signed_unit(random));
        return surface.vertices[v] + way * (size * surface.facts.diagonal);
      };
      const Vec3d x = near(), next = x + (near() - surface.vertices[v]) * 1e-3;
      double closest = around.empty() ? 0 : (x - surface.vertices[v]).length();
      double closest_to_next = around.empty() ? 0 : (next - surface.vertices[v]).length();
      for (const auto t : around) {
        if (!fan.has(t)) continue;
        closest = std::min(closest, std::sqrt(surface.closest_on(t, x).squared_distance));
        closest_to_next = std::min(closest_to_next, std::sqrt(surface.closest_on(t, next).squared_distance));
      }
      if (around.empty()) continue;
      const double rounding = 1e-15 * surface.facts.diagonal;
      found.worst = std::max(found.worst, (std::abs(fan.find_away_from(x).length() - closest) - rounding) / closest);
      found.wrong += fan.away_from(x) != fan.find_away_from(x);
      found.wrong += fan.away_from(next).length() < closest_to_next * (1 - 1e-9) - rounding;
    }
  }
  return found;
}

}  // namespace

TEST_CASE("closest: a vertex's triangles seen all at once", "[closest]") {
  for (const double scale : {1e-30, 1.0, 1e30}) {
    const Fans sphere = try_fans(shapes::icosphere(scale, 3));
    CHECK(sphere.worst < 1e-9);
    CHECK(sphere.left_out == 0);
    CHECK(sphere.wrong == 0);
  }
  // Borders, sharp and reflex edges, corners of one triangle, and needles of 1 to 1e5, which are not among them.
  for (const Polygons& mesh : {shapes::hemisphere(1, 12, 4), shapes::box(Vec3d(1), 1, true), shapes::room_corner(1, 3),
                               shapes::gear(9, 0.8, 1, 0.3, 0.2, 2), shapes::bumpy_sphere(1, 0.3, 1.5, 3, 3),
                               shapes::box(Vec3d(1, 1e5, 1), 1, true)}) {
    const Fans fans = try_fans(mesh);
    CHECK(fans.worst < 1e-9);
    CHECK(fans.wrong == 0);
  }
  CHECK(try_fans(shapes::box(Vec3d(1, 1e5, 1), 1, true)).left_out > 0);
}

TEST_CASE("closest: triangles near a ball stay behind their planes", "[closest]") {
  for (const double scale : {1e-30, 1.0, 1e30}) {
    const Planes found = try_planes(shapes::icosphere(scale, 4), 0.1 * scale);
    CHECK(found.missed == 0);
    CHECK(found.visited > 1000);
    CHECK(found.needless < found.visited / 2);
  }
  CHECK(try_planes(shapes::bumpy_sphere(1, 0.3, 1.5, 3, 4), 0.3).missed == 0);
  CHECK(try_planes(shapes::plates(1, 0.01, 0.001, 20), 0.01).missed == 0);
  CHECK(try_planes(shapes::naca_wing("0012", 1, 1, 40, 10), 0.01).missed == 0);
  CHECK(try_planes(shapes::box(Vec3d(1, 100, 0.001), 1, true), 0.01).missed == 0);
  CHECK(try_planes(shapes::box(Vec3d(1), 1, true), 0.01).missed == 0);
  Polygons far = shapes::icosphere(1, 4);
  for (Vec3d& p : far.positions) p += Vec3d(1e6, -2e6, 3e6);
  CHECK(try_planes(far, 0.1).missed == 0);
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
  const Polygons cube = shapes::box(Vec3d(2), 2, true);
  CHECK(test::brute_force_distance(cube.view(), {3, 0, 0}) == Approx(2).epsilon(1e-14));
  CHECK(test::brute_force_distance(cube.view(), {2, 2, 2}) == Approx(std::sqrt(3)).epsilon(1e-14));
  CHECK_FALSE(test::brute_force_distance(cube.view(), {3.001, 0, 0}) == Approx(2).epsilon(1e-6));
  CHECK(test::is_inside(cube.view(), {0.9, 0.1, 0.2}));
  CHECK_FALSE(test::is_inside(cube.view(), {1.1, 0.1, 0.2}));
}
