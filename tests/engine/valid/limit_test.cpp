// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/limit.h"

#include <openvdb/math/Quat.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "ground/numbers/rounding.h"
#include "motion/paths/miters.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "valid/faults/fault_finder.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/limit/limit_state.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// With every vertex at the distance, unless other corners are asked for; nothing fades.
OffsetResult limited(const Polygons& mesh, double distance, Collision collision = Collision::Limit,
                     Corners corners = Corners::Round) {
  OffsetOptions options;
  options.distance = distance;
  options.collision = collision;
  options.corners = corners;
  options.taper = 0;
  return offset(mesh.view(), options);
}

/// Pairs of triangles that meet in a mesh with its vertices at `positions`.
std::size_t crossings(const Polygons& mesh, const std::vector<Vec3d>& positions) {
  const Surface surface = build_surface(mesh.view(), {});
  std::vector<Vec3d> now;
  for (const auto v : surface.representative) now.push_back(positions[v]);
  return CrossingFinder(surface, now).all().size();
}

/// What limit() says is left is what is found in what is written: nothing.
void check_agreement(const Polygons& mesh, const Distances& distance, const Precision& precision) {
  OffsetOptions options;
  options.distance = distance;
  options.precision = precision;
  const OffsetResult result = offset(mesh.view(), options);
  std::vector<Vec3d> written(result.positions.size());
  for (std::size_t v = 0; v < written.size(); ++v)
    written[v] = Rounding(precision)(mesh.positions[v], result.positions[v]);
  const CheckResult found = check_offset(mesh.view(), written, {.distance = distance, .precision = precision});
  const FaultCounts &left = result.statistics.limit.left, &there = found.faults;
  CHECK(left.inverted == there.inverted);
  CHECK(left.collapsed == there.collapsed);
  CHECK(left.crossings == there.crossings);
  CHECK(result.statistics.limit.crossings_near_source == found.crossings_near_source);
  CHECK(left.total() == 0);
  CHECK(found.wrong_side + found.torn + found.beyond == 0);
}

/// A closed fan around a point, its rim of n points on a circle.
Polygons umbrella(int n, double height) {
  Polygons mesh;
  for (int i = 0; i < n; ++i) mesh.positions.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0);
  mesh.positions.emplace_back(0, 0, height);
  for (int i = 0; i < n; ++i) {
    mesh.corners.insert(mesh.corners.end(), {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>((i + 1) % n),
                                             static_cast<std::uint32_t>(n)});
    mesh.close_face();
  }
  return mesh;
}

/// A plate of 370 by 370 by 3 with rounded corners, whose arcs end short of its straight sides: eight notches far
/// smaller than any distance to offset by, in which large triangles have a corner each.
Polygons notched_plate(double notch) {
  constexpr double kHalf = 185, kRadius = 3, kAlong = kHalf - kRadius;
  constexpr int kArc = 12;
  std::vector<std::pair<double, double>> corner{{kHalf, kAlong - 0.1}, {kHalf - notch, kAlong - 0.1 + notch}};
  for (int i = 0; i <= kArc; ++i) {
    const double a = M_PI / 2 * i / kArc;
    corner.emplace_back(kAlong + (kRadius - notch) * std::cos(a), kAlong + (kRadius - notch) * std::sin(a));
  }
  corner.emplace_back(kAlong - 0.1 + notch, kHalf - notch);
  corner.emplace_back(kAlong - 0.1, kHalf);
  Polygons mesh;
  for (const double z : {0.0, 3.0})
    for (const auto& [c, s] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}})
      for (const auto& [x, y] : corner) mesh.positions.emplace_back(c * x - s * y, s * x + c * y, z);
  const auto n = static_cast<std::uint32_t>(mesh.positions.size() / 2);
  for (std::uint32_t i = 0; i < n; ++i) mesh.corners.push_back(n + i);
  mesh.close_face();
  for (std::uint32_t i = n; i-- > 0;) mesh.corners.push_back(i);
  mesh.close_face();
  for (std::uint32_t i = 0; i < n; ++i) mesh.add_face({i, (i + 1) % n, n + (i + 1) % n, n + i});
  return mesh;
}

/// Two cubes side by side that share an edge, which has four faces.
Polygons cubes_at_an_edge() {
  Polygons mesh;
  for (int i = 0; i < 16; ++i) {
    const int shift = i / 8;
    mesh.positions.emplace_back(shift + (i & 1), shift + (i >> 1 & 1), i >> 2 & 1);
  }
  for (const std::uint32_t i : {0u, 8u})
    for (const auto& f : {std::array{0u, 2u, 3u, 1u},
                          {4u, 5u, 7u, 6u},
                          {0u, 1u, 5u, 4u},
                          {2u, 6u, 7u, 3u},
                          {0u, 4u, 6u, 2u},
                          {1u, 3u, 7u, 5u}})
      mesh.add_face({i + f[0], i + f[1], i + f[2], i + f[3]});
  return mesh;
}

/// Of a mesh's area, a third of each triangle to each of its corners: what has reached its distance, or is mitered.
double reached_area(const Polygons& mesh, const OffsetResult& result) {
  const Surface surface = build_surface(mesh.view(), {});
  double all = 0, reached = 0;
  for (const auto& corners : surface.triangles) {
    const auto at = [&](std::size_t k) { return mesh.positions[surface.representative[corners[k]]]; };
    const double third = (at(1) - at(0)).cross(at(2) - at(0)).length() / 6;
    all += 3 * third;
    for (const auto v : corners)
      if (const VertexState state = result.states[surface.representative[v]];
          state == VertexState::Reached || state == VertexState::Mitered)
        reached += third;
  }
  return reached / all;
}

}  // namespace

TEST_CASE("crossings: shapes that do not cross themselves have none", "[crossings]") {
  for (const Polygons& mesh :
       {shapes::box(Vec3d(1), 4, true), shapes::torus(1, 0.4, 24, 12), shapes::plates(1, 0.1, 1e-9, 5),
        shapes::bumpy_sphere(1, 0.3, 1.5, 3, 3), umbrella(6, 0.5)})
    CHECK(crossings(mesh, mesh.positions) == 0);
}

TEST_CASE("crossings: what meets is found, however little", "[crossings]") {
  Polygons pair;
  pair.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0}, {0.2, 0.2, 1}, {0.3, 0.2, 1}};
  pair.corners = {0, 1, 2, 3, 4, 5};
  pair.face_begin = {0, 3, 6};
  CHECK(crossings(pair, pair.positions) == 1);  // a corner on a face
  pair.positions[3][2] = 1e-300;
  CHECK(crossings(pair, pair.positions) == 0);
  pair.positions[3][2] = -1e-300;
  CHECK(crossings(pair, pair.positions) == 1);
  pair.positions[4] = {0.9, 0.8, 0};
  pair.positions[5] = {0.8, 0.9, 0};
  pair.positions[3] = {0.5, 0.5, 0};
  CHECK(crossings(pair, pair.positions) == 1);  // in one plane, a corner on an edge
  pair.positions[3] = {0.5, std::nextafter(0.5, 1.0), 0};
  CHECK(crossings(pair, pair.positions) == 0);
}

TEST_CASE("crossings: faces at one vertex that run through each other, and faces folded flat", "[crossings]") {
  const Polygons fan = umbrella(6, 0.5);
  std::vector<Vec3d> through = fan.positions;
  std::swap(through[0], through[1]);
  std::swap(through[3], through[5]);
  CHECK(crossings(fan, through) > 0);
  Polygons hinge;
  hinge.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, -1, 0}};
  hinge.corners = {0, 1, 2, 1, 0, 3};
  hinge.face_begin = {0, 3, 6};
  CHECK(crossings(hinge, hinge.positions) == 0);
  hinge.positions[3] = {0.25, 1, 0};
  CHECK(crossings(hinge, hinge.positions) == 1);
  hinge.positions[3] = {0.25, 1, 1e-300};
  CHECK(crossings(hinge, hinge.positions) == 0);
}

TEST_CASE("crossings: as vertices move, those around them are found, or one of each triangle's", "[crossings]") {
  const Surface surface = build_surface(shapes::torus(1, 0.4, 24, 12).view(), {});
  std::vector<Vec3d> now = surface.vertices;
  CrossingFinder finder(surface, now);
  std::mt19937 engine(3);
  std::size_t pairs = 0, fewer = 0;
  for (int round = 0; round < 60; ++round) {
    INFO(round);
    const double size = 0.04 * (1 + round % 20);
    std::vector<std::uint32_t> touched;
    for (std::uint32_t v = 0; v < now.size(); ++v) {
      if (engine() % 8 != 0) continue;
      for (int k = 0; k < 3; ++k) now[v][k] = surface.vertices[v][k] + size * (engine() / 4294967296.0 - 0.5);
      const auto around = surface.triangles_around(v);
      touched.insert(touched.end(), around.begin(), around.end());
    }
    sort_unique(touched);
    finder.update(touched);
    const auto has_moved = [&](std::uint32_t t) { return std::binary_search(touched.begin(), touched.end(), t); };
    const auto moved_of = [&](const std::vector<TrianglePair>& found) {
      Indices members;
      for (const auto& [s, t] : found)
        for (const auto member : {s, t})
          if (has_moved(member)) members.push_back(member);
      sort_unique(members);
      return members;
    };
    std::vector<TrianglePair> expected = finder.all();
    std::erase_if(expected,
                  [&](const TrianglePair& pair) { return !has_moved(pair.first) && !has_moved(pair.second); });
    CHECK(finder.of_updated() == expected);
    const auto counts = [](const TrianglePair& pair) { return (pair.first + pair.second) % 3 != 0; };
    std::erase_if(expected, [&](const TrianglePair& pair) { return !counts(pair); });
    const std::vector<TrianglePair> some = finder.one_of_each_updated({}, counts);
    CHECK(std::includes(expected.begin(), expected.end(), some.begin(), some.end()));
    CHECK(moved_of(some) == moved_of(expected));
    pairs += expected.size();
    fewer += expected.size() - some.size();
  }
  CHECK(pairs > 1000);
  CHECK(fewer > 100);
}

TEST_CASE("limit: what propagation folds and crosses is valid afterwards", "[limit][no_races]") {
  struct Case {
    Polygons mesh;
    double distance;
  };
  const Case cases[] = {{shapes::box(Vec3d(0.5), 20, true), -0.1},
                        {shapes::bumpy_sphere(1, 0.5, 2.5, 11, 4), 0.3},
                        {shapes::bumpy_sphere(1, 0.5, 2.5, 5, 4), -0.25},
                        {shapes::plates(1, 0.1, 0.1, 6), 0.2},
                        {shapes::wedge(0.4, 1, 1, 6), 0.15},
                        {shapes::gear(12, 0.7, 1, 0.3, 0.3, 3), 0.08}};
  std::size_t wrong_before = 0;
  for (const auto& [mesh, distance] : cases) {
    const OffsetResult merged = limited(mesh, distance, Collision::Merge), result = limited(mesh, distance);
    wrong_before += crossings(mesh, merged.positions);
    CHECK(crossings(mesh, mesh.positions) == 0);
    CHECK(crossings(mesh, result.positions) == 0);
    const LimitStatistics& limit = result.statistics.limit;
    CHECK(limit.left.inverted + limit.left.collapsed + limit.left.crossings == 0);
    CHECK(limit.limited_vertices ==
          result.statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Limited)]);
    const test::DistanceErrors errors = test::judge(mesh.view(), result, distance, 7, true);
    CHECK(errors.worst_reached < 1.01e-6);
    CHECK(errors.worst_beyond < 1.01e-6);
    CHECK(errors.worst_told < 1e-9);
    CHECK(errors.wrong_side == 0);
  }
  CHECK(wrong_before > 0);
}

TEST_CASE("limit: what is valid stays as it is", "[limit]") {
  const Polygons mesh = shapes::torus(1, 0.4, 48, 24);
  const OffsetResult merged = limited(mesh, 0.1, Collision::Merge), result = limited(mesh, 0.1);
  CHECK(result.positions == merged.positions);
  CHECK(result.statistics.limit.limited_vertices == 0);
}

TEST_CASE("limit: an input that crosses itself is told, not repaired", "[limit]") {
  Polygons two = shapes::box(Vec3d(1), 3, true);
  const Polygons other = two;
  const auto base = static_cast<std::uint32_t>(two.positions.size());
  for (const Vec3d& p : other.positions) two.positions.push_back(p + Vec3d(0.53, 0.37, 0.41));
  for (std::size_t f = 0; f < other.face_count(); ++f) {
    for (const auto v : other.view().face(f)) two.corners.push_back(base + v);
    two.close_face();
  }
  const OffsetResult result = limited(two, 0.05);
  CHECK(result.statistics.limit.source_crossings > 0);
  CHECK(result.statistics.limit.left.crossings == 0);
}

TEST_CASE("limit: the same bits for any number of threads", "[limit][invariant]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.5, 2.5, 11, 4);
  OffsetOptions one;
  one.distance = 0.3;
  one.threads = 1;
  const OffsetResult alone = offset(mesh.view(), one), all = offset(mesh.view(), {.distance = 0.3});
  CHECK(alone.positions == all.positions);
  CHECK(alone.states == all.states);
}

TEST_CASE("limit: single precision is checked as it will be stored", "[limit]") {
  Polygons mesh = shapes::bumpy_sphere(1, 0.5, 2.5, 11, 4);
  for (Vec3d& p : mesh.positions) p = Vec3d(openvdb::Vec3s(p));
  OffsetOptions options;
  options.distance = 0.3;
  options.precision = {Precision::Kind::Single};
  const OffsetResult result = offset(mesh.view(), options);
  std::vector<Vec3d> stored;
  for (const Vec3d& p : result.positions) stored.emplace_back(openvdb::Vec3s(p));
  CHECK(crossings(mesh, stored) == 0);
}

TEST_CASE("limit: what is written of a thin wall is what is judged", "[limit][no_races]") {
  // Farther than half way through: faces lie on the middle sheet, and digits decide which side of the wall is nearer.
  const openvdb::math::Quat<double> turn(Vec3d(0.4, -0.3, 0.8).unit(), 1.1);
  for (const double thickness : {0.1, 0.05}) {
    Polygons wall = shapes::box(Vec3d(1, thickness, 1), 8, true);
    for (Vec3d& p : wall.positions)
      p = Vec3d(openvdb::Vec3s(turn.rotateVector(p + Vec3d(0, 0.1 * p[0] * p[1], 0)) + Vec3d(0.3, -0.7, 1.1)));
    for (const Precision& precision : {Precision{}, Precision{Precision::Kind::Single},
                                       Precision{Precision::Kind::Digits, 5}, Precision{Precision::Kind::Digits, 7}}) {
      INFO("thickness " << thickness << " digits " << precision.digits);
      check_agreement(wall, -0.6 * thickness, precision);
    }
  }
}

TEST_CASE("limit: points as near to two sides are judged by both", "[limit][long]") {
  // Symmetric to the last bit.
  for (const double share : {0.5, 0.6, 0.8}) {
    check_agreement(shapes::box(Vec3d(1, 0.125, 1), 8, true), -share * 0.125, {});
    check_agreement(shapes::hollow_box(1, 0.125, 6), -share * 0.125, {});
  }
}

TEST_CASE("limit: solids that close on each other stop before they touch", "[limit][no_races]") {
  Polygons spheres = shapes::icosphere(0.5, 4);
  const Polygons one = spheres;
  const auto base = static_cast<std::uint32_t>(one.positions.size());
  for (Vec3d& p : spheres.positions) p[0] -= 0.55;
  for (const Vec3d& p : one.positions) spheres.positions.push_back(p + Vec3d(0.55, 0, 0));
  for (std::size_t f = 0; f < one.face_count(); ++f) {
    for (const auto v : one.view().face(f)) spheres.corners.push_back(v + base);
    spheres.close_face();
  }
  for (const Polygons& mesh : {spheres, shapes::plates(1, 0.1, 0.1, 20)}) {
    const OffsetResult result = limited(mesh, 0.08);
    CHECK(crossings(mesh, result.positions) == 0);
    CHECK(check_offset(mesh.view(), result.positions, {.distance = 0.08}).valid());
    CHECK(test::share(result, VertexState::Reached) < 1);
  }
  // The gap is 0.1 wide at its narrowest; its middle is the plane x = 0.
  const OffsetResult result = limited(spheres, 0.08);
  for (std::size_t v = 0; v < result.positions.size(); ++v)
    CHECK((v < base ? -1 : 1) * result.positions[v][0] > -0.01 * 0.1);
}

TEST_CASE("limit: corners of a wrong face that are not to blame for it go on", "[limit][long]") {
  // Faces reach from the bore, where there is room, to the teeth, where there is none.
  const Polygons gear = shapes::gear(18, 0.8, 1, 0.3, 0.3, 2);
  double reached = 0;
  std::size_t held_back = 0;
  for (const double distance : {-0.14, -0.13, -0.12, -0.11, -0.1}) {
    const OffsetResult result = limited(gear, distance);
    held_back += result.statistics.limit.limited_vertices;
    CHECK(check_offset(gear.view(), result.positions, {.distance = distance}).valid());
    reached += test::share(result, VertexState::Reached) / 5;
  }
  CHECK(held_back > 0);
  CHECK(reached > 0.99);
}

TEST_CASE("limit: a tiny notch holds back nothing but itself", "[limit][no_races]") {
  for (const double notch : {0.002, 0.02})
    for (const double distance : {2.6, 5.2, 13.0}) {
      const Polygons mesh = notched_plate(notch);
      for (const Corners corners : {Corners::Round, Corners::Miter}) {
        const OffsetResult result = limited(mesh, distance, Collision::Limit, corners);
        CAPTURE(notch, distance, corners == Corners::Miter);
        CHECK(check_offset(mesh.view(), result.positions, {.distance = distance, .corners = corners}).valid());
        CHECK(reached_area(mesh, result) > 0.99);
        // With vertices left where they had slid: up to 37 %. Round corners alone: 19 %.
        CHECK(result.statistics.faces.mean < (corners == Corners::Round ? 0.2 : 0.02));
      }
    }
}

TEST_CASE("limit: what is short settles where there is room beside it", "[limit]") {
  const Polygons cubes = cubes_at_an_edge();
  for (const double distance : {-0.02, -0.1}) {
    const OffsetResult result = limited(cubes, distance);
    CHECK(check_offset(cubes.view(), result.positions, {.distance = distance}).valid());
    CHECK(reached_area(cubes, result) > 0.99);
  }
}

TEST_CASE("limit: patches around folds are freed at their distance", "[limit][untangle][no_races]") {
  // Ridges and grooves at whose feet the offset has creases.
  std::size_t folded = 0;
  for (const unsigned seed : {11u, 7u, 3u}) {
    const Polygons mesh = shapes::bumpy_sphere(1, 0.4, 3, seed, 4);
    const OffsetResult merged = limited(mesh, 0.1, Collision::Merge), result = limited(mesh, 0.1);
    const FaultCounts& before = result.statistics.limit.before;
    folded += before.inverted + before.crossings;
    CHECK(check_offset(mesh.view(), result.positions, {.distance = 0.1}).valid());
    CHECK(test::share(result, VertexState::Reached) >= test::share(merged, VertexState::Reached) - 0.01);
  }
  CHECK(folded > 0);
}

TEST_CASE("limit: a vertex that a face is folded over at gets off the surface", "[limit][untangle]") {
  // Pushed across the edge that faces it, where it dips in or stands out a little: what is around it then faces both
  // ways, and no direction leads away from all of it.
  const Polygons box = shapes::box(Vec3d(1), 8, true);
  std::size_t f = 0;
  const auto is_inner = [&](std::uint32_t v) {
    const Vec3d& p = box.positions[v];
    return p[2] == 0.5 && std::max(std::abs(p[0]), std::abs(p[1])) < 0.2;
  };
  while (!std::ranges::all_of(box.view().face(f), is_inner)) ++f;
  const auto face = box.view().face(f);
  for (const double push : {0.3, 0.6})
    for (const double distance : {0.02, 0.1, -0.02, -0.1}) {
      INFO("push " << push << " distance " << distance);
      Polygons mesh = box;
      Vec3d& pushed = mesh.positions[face[0]];
      const Vec3d middle = (box.positions[face[1]] + box.positions[face[2]]) / 2.0;
      pushed = middle + (middle - pushed) * push;
      pushed[2] -= std::copysign(0.001, distance);
      const OffsetResult result = limited(mesh, distance);
      CHECK(std::abs(result.achieved[face[0]] - std::abs(distance)) < 1e-6 * std::abs(distance));
      CHECK(test::share(result, VertexState::Limited) == 0);
      CHECK(check_offset(mesh.view(), result.positions, {.distance = distance}).valid());
    }
}

TEST_CASE("limit: the smaller offset lies inside the larger", "[limit][property]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 2, 5, 3);
  const OffsetResult small = limited(mesh, 0.1), large = limited(mesh, 0.2);
  REQUIRE(large.statistics.faces.worst * 0.2 * 2 < 0.1);
  Polygons outer = mesh;
  outer.positions = large.positions;
  for (std::size_t v = 0; v < mesh.positions.size(); v += 7) CHECK(test::is_inside(outer.view(), small.positions[v]));
}

TEST_CASE("limit: out and back again, a smooth shape is what it was", "[limit][property]") {
  const double minor = 0.4, distance = 0.1;
  Polygons torus = shapes::torus(1, minor, 160, 64);
  const std::vector<Vec3d> before = torus.positions;
  torus.positions = limited(torus, distance).positions;
  const OffsetResult back = limited(torus, -distance);
  CHECK(test::share(back, VertexState::Reached) == 1);
  const double edge = 2 * M_PI * (1 + minor + distance) / 160;
  for (std::size_t v = 0; v < before.size(); ++v)
    CHECK((back.positions[v] - before[v]).length() < edge * edge / (2 * minor));
}

TEST_CASE("limit: what stays is judged as it is in a coarser format", "[limit]") {
  const auto [mesh, distances] = test::far_sphere();
  for (const bool rounds_all : {false, true})
    check_agreement(mesh, Distances(distances), {.kind = Precision::Kind::Single, .rounds_all = rounds_all});
  check_agreement(mesh, Distances(distances), {.kind = Precision::Kind::Digits, .digits = 7, .rounds_all = true});
}

TEST_CASE("limit: random scenes are what they say in three formats", "[limit][property][random][no_races]") {
  const test::Seeds seeds = test::random_seeds(30);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    // Text of as many digits as there are, or of six; numbers of single precision, of which each face may have its own.
    check_agreement(scene.mesh, scene.distance, {});
    check_agreement(scene.mesh, scene.distance, {Precision::Kind::Digits, 6});
    check_agreement(scene.mesh, scene.distance, {.kind = Precision::Kind::Single, .rounds_all = true});
    for (Vec3d& p : scene.mesh.positions) p = Vec3d(openvdb::Vec3s(p));
    check_agreement(scene.mesh, scene.distance, {Precision::Kind::Single});
    check_agreement(test::torn(scene.mesh), scene.distance, {Precision::Kind::Single});
  }
}

TEST_CASE("limit: what crosses itself all over is valid to check as well",
          "[limit][check][property][random][no_races]") {
  // Where faces are folded, an edge and its end disagree about sides, and rounding chooses which is closest.
  const test::Seeds seeds = test::random_seeds(12);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    const Polygons mesh = test::crumpled_box(seed);
    for (const double distance : {0.05, -0.04})
      for (const Corners corners : {Corners::Round, Corners::Miter}) {
        const Precision precision = seed % 2 == 0 ? Precision{} : Precision{Precision::Kind::Digits, 5};
        CAPTURE(seed, distance, corners == Corners::Miter, precision.digits);
        OffsetOptions options;
        options.distance = distance;
        options.corners = corners;
        options.precision = precision;
        const OffsetResult result = offset(mesh.view(), options);
        CHECK(result.statistics.limit.left.total() == 0);
        std::vector<Vec3d> written;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v)
          written.push_back(Rounding(precision)(mesh.positions[v], result.positions[v]));
        const CheckResult found = check_offset(
            mesh.view(), written, {.distance = options.distance, .corners = corners, .precision = precision});
        CHECK(found.valid());
        CHECK(found.beyond == 0);
      }
  }
}

TEST_CASE("limit: a vertex that gives up its miter has a path to the distance, and no share of the miter",
          "[limit][miter]") {
  const Polygons cube = shapes::box(Vec3d(1), 1, false);
  Surface surface = build_surface(cube.view(), {});
  to_local_frame(surface, 0.1);
  const ClosestQuery query(surface);
  const Distances distances(0.1);
  std::vector<Vec3d> source;
  Paths paths;
  for (std::uint32_t v = 0; v < surface.vertices.size(); ++v) {
    source.push_back(cube.positions[surface.representative[v]]);
    paths.displacement.push_back(surface.vertex_normals[v].unit() * 0.1);
    paths.achieved.push_back(0.1);
    paths.state.push_back(VertexState::Reached);
    paths.closest.push_back(surface.triangles_around(v).front());
  }
  MiterFacts facts;
  const std::vector<Miter> miters = MiterFinder<ClosestQuery>(query, Corners::Miter, 4, nullptr)(distances, facts);
  REQUIRE(miters.size() == 8);
  MiteredPaths mitered(miters, paths);
  ConstrainedSurface constrained{query, surface, {}, {}, {}};
  constrained.farther = mitered.farther();
  FaultFinder faults(constrained, source, distances, Rounding(Precision{}));
  faults.move_to_ends(paths);
  const SurfaceOffset offset{constrained, source, distances, paths, &mitered};
  LimitState state(faults, offset, nullptr);
  const Indices corner{0};
  // At a share of a miter nothing tells that it is beyond: only the end's distance is known.
  state.share[0] = 0.6;
  state.move(corner);
  CHECK(faults.distance_of(0) > 0.103);
  CHECK(faults.misplaced().empty());
  CHECK(state.take_miters_back(corner) == corner);
  state.move(corner);
  CHECK(faults.distance_of(0) < 0.1);
  state.share[0] = 1;
  state.move(corner);
  CHECK(faults.distance_of(0) == Approx(0.1).epsilon(1e-6));
  CHECK(state.take_miters_back(corner).empty());
}

TEST_CASE("limit: vertices that gave up their miters are at their distance, or nearer",
          "[limit][property][random][miter]") {
  const test::Seeds seeds = test::random_seeds(30);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    INFO("seed " << seed);
    const test::RandomScene scene = test::random_scene(seed);
    OffsetOptions options;
    options.distance = scene.distance;
    options.corners = Corners::Miter;
    const OffsetResult result = offset(scene.mesh.view(), options);
    CHECK(result.statistics.limit.left.total() == 0);
    CheckOptions check;
    check.distance = scene.distance;
    check.corners = Corners::Miter;
    CHECK(check_offset(scene.mesh.view(), result.positions, check).faults.total() == 0);
    std::size_t beyond = 0;
    for (std::size_t v = 0; v < result.states.size(); ++v) {
      const bool may_be = result.states[v] == VertexState::Mitered || result.states[v] == VertexState::Cut;
      beyond += !may_be && result.achieved[v] > std::abs(scene.distance) * (1 + 1.01e-6);
    }
    CHECK(beyond == 0);
  }
}

TEST_CASE("limit: what is short with round corners goes where there is room", "[limit][miter][long]") {
  // Distance, the share that reaches it, and how far faces are off: 83.8 and 59.3 % otherwise, and 8.0 and 16.9 % off,
  // if vertices went straight above live points alone and not beside their neighbours.
  const std::tuple<const char*, Polygons, double, double, double> cases[] = {
      {"room corner", shapes::room_corner(1, 40), 0.3, 0.88, 0.03},
      {"diffuser", shapes::diffuser(0.4, 0.8, 2, 24), 0.2, 0.675, 0.01},
  };
  for (const auto& [name, mesh, distance, least, most_off] : cases) {
    CAPTURE(name);
    const OffsetResult result = limited(mesh, distance);
    CHECK(test::share(result, VertexState::Reached) > least);
    CHECK(result.statistics.faces.mean < most_off);
    CHECK(result.statistics.limit.left.total() == 0);
    CHECK(check_offset(mesh.view(), result.positions, {.distance = distance}).faults.total() == 0);
  }
}

TEST_CASE("limit: by default faces are no farther off than with round corners where much is in the way",
          "[limit][no_races]") {
  struct Case {
    const char* name;
    Polygons mesh;
    double distance;
  };
  const Case cases[] = {{"gear", shapes::gear(18, 0.8, 1, 0.3, 0.3, 6), -0.12},
                        {"room corner", shapes::room_corner(1, 40), 0.3},
                        {"diffuser", shapes::diffuser(0.4, 0.8, 2, 24), 0.2}};
  for (const auto& [name, mesh, distance] : cases) {
    CAPTURE(name);
    const FaceError miter = offset(mesh.view(), {.distance = distance}).statistics.faces,
                    round = offset(mesh.view(), {.distance = distance, .corners = Corners::Round}).statistics.faces;
    CHECK(miter.mean <= round.mean + 1e-4);
    CHECK(miter.at_distance >= round.at_distance - 1e-3);
  }
}

TEST_CASE("limit: what nothing has room above goes beside neighbours that are at the distance", "[limit]") {
  // Distance, and the share that reaches it: 62.0 and 99.93 % otherwise.
  const std::tuple<const char*, Polygons, double, double> cases[] = {
      {"wing", shapes::naca_wing("2412", 1, 1, 80, 40), -0.0425828, 0.645},
      {"gear", shapes::gear(18, 0.8, 1, 0.3, 0.3, 6), -0.0851684, 0.9995},
  };
  for (const auto& [name, mesh, distance, least] : cases) {
    CAPTURE(name);
    const OffsetResult result = limited(mesh, distance);
    CHECK(test::share(result, VertexState::Reached) > least);
    CHECK(result.statistics.limit.left.total() == 0);
    CHECK(check_offset(mesh.view(), result.positions, {.distance = distance}).valid());
  }
}

TEST_CASE("limit: what is short does not leave a plane that holds it", "[limit][border]") {
  // Its border lies in z = 0, and half of it, where faces are steep enough, is held there.
  const Polygons patch = shapes::patch(1, 0.05, 48);
  const OffsetResult result = limited(patch, 0.05);
  std::size_t held = 0;
  for (std::size_t v = 0; v < patch.positions.size(); ++v)
    if (std::abs(patch.positions[v][2]) < 1e-12) held += std::abs(result.positions[v][2]) < 1e-12;
  CHECK(held == 96);
}

TEST_CASE("limit: random scenes are valid and exact", "[limit][property][random]") {
  const test::Seeds seeds = test::random_seeds(200);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    INFO("seed " << seed);
    const test::RandomScene scene = test::random_scene(seed);
    const OffsetResult result = limited(scene.mesh, scene.distance);
    const CheckResult found =
        check_offset(scene.mesh.view(), result.positions, {.distance = scene.distance, .corners = Corners::Round});
    CHECK(result.statistics.limit.left.total() == 0);
    CHECK(found.faults.total() == 0);
    CHECK(result.statistics.limit.crossings_near_source == found.crossings_near_source);
    CHECK(found.torn + found.wrong_side + found.beyond == 0);
    const test::DistanceErrors errors =
        test::judge(scene.mesh.view(), result, scene.distance, 97, scene.closed && found.source_crossings == 0);
    CHECK(errors.worst_reached < 1.01e-6);
    CHECK(errors.worst_beyond < 1.01e-6);
    CHECK(errors.wrong_side == 0);
  }
}
