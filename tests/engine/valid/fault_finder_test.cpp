// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/fault_finder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "vdb_offset/numbers.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// All that a finder tells.
struct Told {
  std::vector<Vec3d> positions;
  std::vector<double> distances;
  std::vector<std::uint32_t> closest;
  std::vector<TrianglePair> crossings;
  Indices misplaced, faulty;
  std::size_t inverted, collapsed, crowded;

  Told(FaultFinder& finder, std::size_t vertices)
      : positions(finder.positions().begin(), finder.positions().end()),
        crossings(finder.crossings()),
        misplaced(finder.misplaced()),
        faulty(finder.faulty_vertices()) {
    for (std::uint32_t v = 0; v < vertices; ++v) {
      distances.push_back(finder.distance_of(v));
      closest.push_back(finder.closest_to(v));
    }
    std::sort(crossings.begin(), crossings.end());
    const FaultCounts counts = finder.count();
    inverted = counts.inverted;
    collapsed = counts.collapsed;
    crowded = counts.crowded;
  }
  bool operator==(const Told&) const = default;
};

/// A sphere with dents, and random positions of its vertices around those at a distance.
struct Scene {
  Surface surface;
  std::vector<Vec3d> source;
  Distances distances{0.15};
  std::mt19937 engine{11};

  Scene() {
    const Polygons mesh = shapes::bumpy_sphere(1, 0.4, 2.5, 5, 3);
    surface = build_surface(mesh.view(), {});
    to_local_frame(surface, 0.05);
    for (const auto v : surface.representative) source.push_back(mesh.positions[v]);
  }
  double random() { return engine() / 4294967296.0 - 0.5; }
  Vec3d position_near(std::uint32_t v, double size) {
    return source[v] + surface.vertex_normals[v].unit() * 0.15 + Vec3d(random(), random(), random()) * size;
  }
  Indices some(unsigned one_in) {
    Indices chosen;
    for (std::uint32_t v = 0; v < source.size(); ++v)
      if (engine() % one_in == 0) chosen.push_back(v);
    return chosen;
  }
};

}  // namespace

TEST_CASE("fault finder: a trial that is taken back has changed nothing", "[fault_finder][oracle]") {
  Scene scene;
  const ClosestQuery query(scene.surface);
  const ConstrainedSurface constrained{query, scene.surface, {}, {}, {}};
  FaultFinder finder(constrained, scene.source, scene.distances, Rounding(Precision{}));
  std::vector<Vec3d> at(scene.source.size());
  for (std::uint32_t v = 0; v < at.size(); ++v) at[v] = scene.position_near(v, 0.1);
  const auto position_of = [&](std::uint32_t v) { return at[v]; };
  finder.move_all(position_of);
  const Told before(finder, at.size());
  CHECK(before.crossings.size() > 0);
  CHECK(before.inverted > 0);
  for (const auto crossings : {FaultFinder::Crossings::All, FaultFinder::Crossings::OneOfEach})
    for (const unsigned one_in : {40u, 4u, 1u}) {
      INFO(one_in);
      const Indices moved = scene.some(one_in);
      std::vector<Vec3d> there = at;
      for (const auto v : moved) there[v] = scene.position_near(v, 0.2);
      FaultFinder::Trial trial = finder.try_out(
          moved, [&](std::uint32_t v) { return there[v]; }, crossings);
      CHECK(Told(finder, at.size()) != before);
      trial.take_back(moved);
      CHECK(Told(finder, at.size()) == before);
    }
}

TEST_CASE("fault finder: what is partly taken back is as if only the rest had moved", "[fault_finder][oracle]") {
  Scene scene;
  const ClosestQuery query(scene.surface);
  const ConstrainedSurface constrained{query, scene.surface, {}, {}, {}};
  std::vector<Vec3d> at(scene.source.size());
  for (std::uint32_t v = 0; v < at.size(); ++v) at[v] = scene.position_near(v, 0.1);
  FaultFinder finder(constrained, scene.source, scene.distances, Rounding(Precision{}));
  finder.move_all([&](std::uint32_t v) { return at[v]; });
  for (const unsigned one_in : {30u, 3u}) {
    INFO(one_in);
    const Indices moved = scene.some(one_in);
    std::vector<Vec3d> there = at;
    for (const auto v : moved) there[v] = scene.position_near(v, 0.2);
    {
      FaultFinder::Trial trial = finder.try_out(moved, [&](std::uint32_t v) { return there[v]; });
      for (const unsigned nth : {2u, 3u}) {  // in two steps
        Indices back;
        for (const auto v : moved)
          if (v % nth == 0 && there[v] != at[v]) back.push_back(v);
        for (const auto v : back) there[v] = at[v];
        trial.take_back(back);
      }
    }
    at = there;
    FaultFinder fresh(constrained, scene.source, scene.distances, Rounding(Precision{}));
    fresh.move_all([&](std::uint32_t v) { return at[v]; });
    Told now(finder, at.size()), expected(fresh, at.size());
    now.closest = expected.closest;  // one of several that are as near, where they share an edge or a corner
    CHECK(now == expected);
  }
}

TEST_CASE("fault finder: an inverted, a collapsed and a misplaced one of a plate", "[fault_finder]") {
  // Two triangles in the plane z = 0, offset by 1.
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({0, 2, 3});
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.5);
  std::vector<Vec3d> source;
  for (const auto v : surface.representative) source.push_back(mesh.positions[v]);
  const auto of_input = [&](std::uint32_t v) { return surface.welded[v]; };
  const ClosestQuery query(surface);
  const ConstrainedSurface constrained{query, surface, {}, {}, {}};
  const Distances distances(1);
  FaultFinder finder(constrained, source, distances, Rounding(Precision{}));
  std::vector<Vec3d> at = source;
  for (Vec3d& x : at) x[2] += 1;
  const std::vector<Vec3d> above = at;
  const auto move = [&] { finder.move_all([&](std::uint32_t v) { return at[v]; }); };
  move();
  CHECK_FALSE(finder.any());
  CHECK(finder.misplaced().empty());
  CHECK(finder.distance_of(0) == Approx(1).epsilon(1e-12));
  at[of_input(1)] = Vec3d(1, 3, 1);  // beyond the diagonal
  move();
  CHECK(finder.count().inverted == 1);
  at = above;
  at[of_input(1)] = Vec3d(2, 2, 1);  // on the diagonal
  move();
  CHECK(finder.count().collapsed == 1);
  CHECK(finder.count().total() == 1);
  at = above;
  at[of_input(3)] = Vec3d(0, 4, 1.5);
  move();
  CHECK(finder.misplaced() == Indices{of_input(3)});
  CHECK(finder.faulty_vertices() == Indices{of_input(3)});
  CHECK_FALSE(finder.any());
}
