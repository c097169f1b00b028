// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "space/surface/surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

// Names of its own, as tests are compiled several files at once.
namespace hanging {
namespace {

/// A cube of side 1, of quads; those at its upper front edge may have vertices on it.
Polygons cube(std::initializer_list<double> on_top, std::initializer_list<double> on_front) {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (const auto& face : {std::array{0U, 3U, 2U, 1U}, {1U, 2U, 6U, 5U}, {2U, 3U, 7U, 6U}, {3U, 0U, 4U, 7U}})
    mesh.add_face({face[0], face[1], face[2], face[3]});
  const auto add = [&](double x) {
    mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.emplace_back(x, 0, 1);
  };
  mesh.corners.push_back(4);
  for (const double x : on_top) add(x);
  for (const std::uint32_t v : {5U, 6U, 7U}) mesh.corners.push_back(v);
  mesh.close_face();
  for (const std::uint32_t v : {0U, 1U, 5U}) mesh.corners.push_back(v);
  for (const double x : on_front) add(x);
  mesh.corners.push_back(4);
  mesh.close_face();
  return mesh;
}

/// The triangles of a mesh, some of them with one or two vertices on a side that their neighbour has not.
Polygons with_hanging(const Polygons& mesh, std::uint32_t seed) {
  Polygons split;
  split.positions = mesh.positions;
  std::mt19937 random(seed);
  const Surface surface = build_surface(mesh.view(), {});
  for (const auto& corner : surface.triangles) {
    std::array<std::uint32_t, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = surface.representative[corner[k]];
    if (random() % 8 != 0) {
      split.add_face({v[0], v[1], v[2]});
      continue;
    }
    const std::size_t k = random() % 3;
    const std::uint32_t from = v[k], to = v[(k + 1) % 3], across = v[(k + 2) % 3], count = 1 + random() % 2;
    std::uint32_t last = from;
    for (std::uint32_t i = 1; i <= count; ++i) {
      const double share = (i - 0.3 * static_cast<double>(random() % 2)) / (count + 1);
      split.positions.push_back(mesh.positions[from] * (1 - share) + mesh.positions[to] * share);
      const auto added = static_cast<std::uint32_t>(split.positions.size() - 1);
      split.add_face({last, added, across});
      last = added;
    }
    split.add_face({last, to, across});
  }
  return split;
}

MeshFacts facts_of(const Polygons& mesh, const WeldOptions& weld = WeldOptions::automatic()) {
  return build_surface(mesh.view(), weld).facts;
}

OffsetOptions options_at(double distance, Corners corners) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = corners;
  return options;
}

}  // namespace

TEST_CASE("hanging vertices: borders whose vertices do not match are one", "[hanging]") {
  struct Case {
    Polygons mesh;
    std::size_t hanging;
  };
  for (const auto& [mesh, hanging] :
       {Case{cube({0.5}, {}), 1}, Case{cube({}, {0.5}), 1}, Case{cube({0.2, 0.7}, {}), 2},
        Case{cube({0.2, 0.7}, {0.5}), 3}, Case{cube({0.2, 0.5, 0.6, 0.8}, {0.75, 0.6, 0.3}), 5}}) {
    const MeshFacts facts = facts_of(mesh);
    CHECK(facts.closed());
    CHECK(facts.non_manifold_edges == 0);
    CHECK(facts.seams.hanging == hanging);
    CHECK(facts.area == Approx(6));
    CHECK_FALSE(facts_of(mesh, {}).closed());
    // Positions are exact by the closed form, and the faces are at the distance.
    for (const double d : {0.1, -0.1}) {
      const OffsetOptions options = options_at(d, Corners::Miter);
      const OffsetResult result = offset(mesh.view(), options);
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        for (int k = 0; k < 3; ++k) {
          const double x = mesh.positions[v][k];
          CHECK(result.positions[v][k] == Approx(x == 0 ? -d : x == 1 ? 1 + d : x).margin(1e-9));
        }
      CHECK(result.statistics.faces.worst < 1e-8);
      CheckOptions as_made;
      as_made.distance = d;
      as_made.corners = Corners::Miter;
      const CheckResult check = check_offset(mesh.view(), result.positions, as_made);
      CHECK(check.valid());
      CHECK(check.facts.seams.hanging == hanging);
    }
  }
}

TEST_CASE("hanging vertices: what only touches, or is too far off, is not joined", "[hanging]") {
  Polygons touching;  // a tip on the middle of an edge
  touching.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0, 0}, {0.3, -1, 0.2}, {0.7, -1, 0.2}};
  touching.add_face({0, 1, 2});
  touching.add_face({3, 4, 5});
  CHECK(facts_of(touching).seams.hanging == 0);
  CHECK(facts_of(touching).boundary_edges == 6);
  Polygons off = cube({0.5}, {});
  off.positions.back() += Vec3d(0, 1e-6, 0);
  CHECK(facts_of(off).seams.hanging == 0);
  WeldOptions within{.tolerance = 1e-5, .join_hanging = true};
  CHECK(facts_of(off, within).seams.hanging == 1);
  CHECK(facts_of(off, within).seams.widest_hanging == Approx(1e-6));
  CHECK(facts_of(off, within).closed());
  within.join_hanging = false;
  CHECK(facts_of(off, within).seams.hanging == 0);
  // A hole in a flat sheet whose rim has a vertex on a straight line hangs on nothing.
  CHECK(facts_of(shapes::patch(1, 0, 6)).seams.hanging == 0);
}

TEST_CASE("hanging vertices: sheets that lie on each other, and vertices of what stays, are not joined", "[hanging]") {
  Polygons decal;  // flush with an edge of the sheet that it lies on
  decal.positions = {{0, 0, 0},   {1, 0, 0},   {1, 1, 0},     {0, 1, 0},
                     {0.3, 0, 0}, {0.6, 0, 0}, {0.6, 0.4, 0}, {0.3, 0.4, 0}};
  decal.add_face({0, 1, 2, 3});
  decal.add_face({4, 5, 6, 7});
  CHECK(facts_of(decal).seams.hanging == 0);
  CHECK(facts_of(decal).components == 2);
  // The cube's front, without the top that has the vertex.
  const Polygons mesh = cube({0.5}, {});
  OffsetOptions options = options_at(0.1, Corners::Round);
  options.only = {0, 0, 0, 0, 0, 1};
  const OffsetResult result = offset(mesh.view(), options);
  for (const std::uint32_t v : {0U, 1U, 4U, 5U}) CHECK(result.positions[v][1] == Approx(-0.1));
  CHECK(result.statistics.facts.seams.hanging == 0);
}

TEST_CASE("hanging vertices: a face is turned over though its pieces are not", "[hanging]") {
  Polygons mesh;  // three triangles below y = 0 with a vertex at (1, 0), and a flat one above, without
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 0, 0}, {0, -1, 0}, {2, -1, 0}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({0, 4, 3});
  mesh.add_face({4, 5, 3});
  mesh.add_face({5, 1, 3});
  CheckOptions options;
  options.distance = 0.1;
  std::vector<Vec3d> moved = mesh.positions;
  for (Vec3d& p : moved) p[2] = 0.1;
  CheckResult check = check_offset(mesh.view(), moved, options);
  CHECK(check.facts.seams.hanging == 1);
  CHECK(check.valid());
  moved[2][1] = -0.1;
  moved[3][1] = -0.5;
  check = check_offset(mesh.view(), moved, options);
  CHECK(check.faults.inverted > 0);
}

TEST_CASE("hanging vertices: of so many long edges across each other that nobody can tell", "[hanging]") {
  Polygons mesh;  // each between the ends of all that follow
  for (int i = 1; i <= 2000; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3d& p : {Vec3d(-i, 0, 0), Vec3d(i, 0, 0), Vec3d(0, i % 2 == 0 ? 1 : -1, i)})
      mesh.positions.push_back(p);
    mesh.add_face({first, first + 1, first + 2});
  }
  CHECK(build_surface(mesh.view(), WeldOptions::automatic()).triangles.size() <= 9 * mesh.face_count());
}

TEST_CASE("hanging vertices: a body that has many goes where it would go without", "[hanging]") {
  const Polygons gear = shapes::gear(8, 1, 1.2, 0.4, 0.5, 3);
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Polygons mesh = with_hanging(gear, seed);
    const MeshFacts facts = facts_of(mesh);
    CHECK(facts.closed());
    CHECK(facts.seams.hanging > 20);
    for (const double d : {0.02, -0.02}) {
      OffsetOptions options = options_at(d, Corners::Miter);
      options.threads = 1;
      const OffsetResult result = offset(mesh.view(), options);
      CHECK(check_offset(mesh.view(), result.positions, {}).valid());
      CHECK(result.statistics.faces.mean < 0.003);  // 0.02 and more where they are not joined
      CHECK(summarise(result).share_reached == 1);
      options.threads = 2;
      CHECK(offset(mesh.view(), options).positions == result.positions);
      options.weld = {};
      CHECK(offset(mesh.view(), options).statistics.faces.mean > 0.005);
    }
  }
}

}  // namespace hanging
