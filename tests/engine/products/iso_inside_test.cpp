// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "products/iso/mend.h"
#include "products/iso/merge_flats.h"
#include "products/iso/solid_boundary.h"
#include "products/iso/specks.h"
#include "space/surface/holes.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

namespace {

Polygons moved(Polygons mesh, const Vec3d& by) {
  for (Vec3d& p : mesh.positions) p += by;
  return mesh;
}

Polygons together(Polygons all, const Polygons& other) {
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  all.positions.insert(all.positions.end(), other.positions.begin(), other.positions.end());
  for (std::size_t f = 0; f < other.face_count(); ++f) {
    for (const auto v : other.view().face(f)) all.corners.push_back(first + v);
    all.close_face();
  }
  return all;
}

/// Without the faces for which is_out(face) holds.
Polygons without(const Polygons& mesh, const std::function<bool(std::size_t)>& is_out) {
  Polygons rest;
  rest.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    if (is_out(f)) continue;
    const auto face = mesh.view().face(f);
    rest.corners.insert(rest.corners.end(), face.begin(), face.end());
    rest.close_face();
  }
  return rest;
}

IsoOptions options_of(double distance, double voxel_size) {
  IsoOptions options;
  options.distance = distance;
  options.grid.voxel_size = voxel_size;
  return options;
}

/// A square bar of length 1 with a notch along it that is as sharp as 14 degrees, and turned against the axes.
Polygons notched_bar() {
  const double side = 0.01, half = 0.0005, depth = 0.004;
  const double section[7][2] = {
      {0, 0},   {side, 0}, {side, side}, {side / 2 + half, side}, {side / 2, side - depth}, {side / 2 - half, side},
      {0, side}};
  Polygons bar;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : section) {
      const Vec3d p(x * std::cos(0.3) - y * std::sin(0.3), x * std::sin(0.3) + y * std::cos(0.3), z);
      bar.positions.emplace_back(p[0], p[1] * std::cos(0.5) - p[2] * std::sin(0.5),
                                 p[1] * std::sin(0.5) + p[2] * std::cos(0.5));
    }
  for (std::uint32_t k = 0; k < 7; ++k) bar.add_face({k, (k + 1) % 7, (k + 1) % 7 + 7, k + 7});
  for (const auto& [a, b, c] : {std::array<std::uint32_t, 3>{0, 4, 1}, {1, 4, 3}, {1, 3, 2}, {0, 6, 5}, {0, 5, 4}}) {
    bar.add_face({a, b, c});
    bar.add_face({a + 7, c + 7, b + 7});
  }
  return bar;
}

/// A triangle of sides along x and y, extruded, with a knife edge of so many degrees, in a frame that is not the
/// grid's.
Polygons knife(double degrees) {
  const double height = 10 * std::tan(degrees * M_PI / 180);
  Polygons mesh;
  for (const double z : {0.0, 8.0})
    for (const Vec3d& p : {Vec3d(0, 0, z), Vec3d(10, 0, z), Vec3d(10, height, z)}) {
      const Vec3d turned(0.6 * p[0] - 0.64 * p[1] + 0.48 * p[2], 0.8 * p[0] + 0.48 * p[1] - 0.36 * p[2],
                         0.6 * p[1] + 0.8 * p[2]);
      mesh.positions.push_back(turned);
    }
  mesh.add_face({0, 2, 1});
  mesh.add_face({3, 4, 5});
  mesh.add_face({0, 1, 4, 3});
  mesh.add_face({1, 2, 5, 4});
  mesh.add_face({2, 0, 3, 5});
  return mesh;
}

/// Of a prism over a regular polygon, along z: vertices at round coordinates.
Polygons prism(int sides) {
  Polygons mesh;
  for (const double z : {0.0, 5.0})
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * M_PI * i / sides;
      mesh.positions.emplace_back(std::round(10 * std::cos(angle) * 1e8) / 1e8,
                                  std::round(10 * std::sin(angle) * 1e8) / 1e8, z);
    }
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) mesh.add_face({i, (i + 1) % n, n + (i + 1) % n, n + i});
  for (std::uint32_t i = n; i-- > 0;) mesh.corners.push_back(i);
  mesh.close_face();
  for (std::uint32_t i = 0; i < n; ++i) mesh.corners.push_back(n + i);
  mesh.close_face();
  return mesh;
}

}  // namespace

TEST_CASE("iso inside: solids that overlap are hollowed as one", "[iso]") {
  // Two boxes as one: by hand, with the rim where they meet.
  const Polygons big = shapes::box({2, 2, 2}, 1, true), beam = moved(shapes::box({3, 1, 1}, 1, true), {1.5, 0, 0}),
                 both = together(big, beam);
  const IsoResult result = make_iso_surface(both.view(), options_of(-0.1, 0.05));
  CHECK(result.statistics.valid());
  CHECK(result.statistics.components == 1);
  CHECK(result.statistics.solid.buried + result.statistics.solid.cut > 0);
  // The smaller boxes, and what the rounding around the rim adds to the passage between them.
  const double passage = 0.64 * 2.0, rounding = (1 - M_PI / 4) * 0.01 * 4 * 0.8;
  CHECK(test::enclosed_volume(result.polygons) == Approx(5.832 + passage + rounding).epsilon(3e-3));
  // Every vertex is as far from the boundary, and none nearer to what is buried but through it.
  std::size_t beyond_buried = 0;
  for (std::size_t v = 0; v < result.polygons.positions.size(); v += 7) {
    const Vec3d& x = result.polygons.positions[v];
    const double all = test::brute_force_distance(both.view(), x);
    CHECK(all <= 0.1 * (1 + 1e-6));
    beyond_buried += all < 0.1 * (1 - 1e-6);
  }
  CHECK(beyond_buried > 0);
  CHECK(result.statistics.worst_error < 1e-8);
}

TEST_CASE("iso inside: what lies in a solid is not surface, whether faces meet or not", "[iso]") {
  const Polygons box = shapes::box({1, 1, 1}, 1, true);
  const double alone = test::enclosed_volume(make_iso_surface(box.view(), options_of(-0.1, 0.03)).polygons);
  CHECK(alone == Approx(0.512).epsilon(1e-6));
  for (const Polygons& other : {shapes::box({0.5, 0.4, 0.3}, 1, true), shapes::icosphere(0.4, 2)}) {
    const IsoResult nested = make_iso_surface(together(box, other).view(), options_of(-0.1, 0.03));
    CHECK(nested.statistics.components == 1);
    CHECK(nested.statistics.solid.buried == other.face_count());
    CHECK(test::enclosed_volume(nested.polygons) == Approx(alone).epsilon(1e-9));
  }
  // Flush: part of a side is shared.
  const IsoResult flush = make_iso_surface(
      together(box, moved(shapes::box({0.5, 0.5, 0.5}, 1, true), {0.25, 0.25, 0.25})).view(), options_of(-0.1, 0.03));
  CHECK(flush.statistics.components == 1);
  CHECK(test::enclosed_volume(flush.polygons) == Approx(alone).epsilon(1e-6));
  // Face to face: two halves of a bar.
  const IsoResult bar = make_iso_surface(together(box, moved(box, {1, 0, 0})).view(), options_of(-0.1, 0.03));
  CHECK(bar.statistics.components == 1);
  CHECK(test::enclosed_volume(bar.polygons) == Approx(1.8 * 0.8 * 0.8).epsilon(1e-6));
  // A cavity stays one.
  const IsoResult hollow = make_iso_surface(shapes::hollow_box(1, 0.3, 2).view(), options_of(-0.05, 0.03));
  CHECK(hollow.statistics.components == 2);
  CHECK(hollow.statistics.solid.buried + hollow.statistics.solid.cut == 0);
}

TEST_CASE("iso inside: an edge of four faces does not make solids open", "[iso][no_races]") {
  const Polygons cube = shapes::box({1, 1, 1}, 1, true);
  const Polygons cubes = together(cube, moved(cube, {1, 1, 0}));
  const IsoResult result = make_iso_surface(cubes.view(), options_of(-0.05, 0.02));
  CHECK(result.statistics.is_signed);
  CHECK(result.statistics.valid());
  CHECK(result.statistics.components == 2);
  CHECK(test::enclosed_volume(result.polygons) == Approx(2 * 0.9 * 0.9 * 0.9).epsilon(1e-6));
  IsoOptions never = options_of(-0.05, 0.02);
  never.use_winding = false;
  CHECK_FALSE(make_iso_surface(cubes.view(), never).statistics.is_signed);
}

TEST_CASE("iso inside: small holes are filled, and what is open stays so", "[iso]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  const Polygons pierced = without(sphere, [](std::size_t f) { return f == 3 || f == 200 || f == 777; });
  for (const double d : {0.2, -0.2, 0.03}) {  // the last: less than a hole is wide
    const IsoResult result = make_iso_surface(pierced.view(), options_of(d, std::min(0.1, std::abs(d))));
    CHECK(result.statistics.valid());
    CHECK(result.statistics.is_signed);
    CHECK(result.statistics.components == 1);
    CHECK(result.statistics.solid.holes == 3);
    CHECK(test::enclosed_volume(result.polygons) == Approx(4.0 / 3 * M_PI * std::pow(1 + d, 3)).epsilon(0.03));
  }
  // Distances are to the mesh as it is, if the ball of that radius does not pass through the holes.
  const IsoResult inner = make_iso_surface(pierced.view(), options_of(-0.2, 0.1));
  for (std::size_t v = 0; v < inner.polygons.positions.size(); v += 11)
    CHECK(test::brute_force_distance(pierced.view(), inner.polygons.positions[v]) == Approx(0.2).epsilon(1e-6));

  for (const Polygons& open :
       {shapes::patch(1, 0.1, 6), shapes::hemisphere(1, 16, 6),
        without(shapes::cylinder(0.2, 5, 12, 8, 2), [m = shapes::cylinder(0.2, 5, 12, 8, 2)](std::size_t f) {
          for (const auto v : m.view().face(f))
            if (std::abs(std::abs(m.positions[v][2]) - 2.5) > 1e-9) return false;
          return true;
        })}) {
    const IsoResult tube = make_iso_surface(open.view(), options_of(0.05, 0.05));
    CHECK_FALSE(tube.statistics.is_signed);
    CHECK(tube.statistics.valid());
  }
  // A sheet beside a solid: that has an inside, the sheet a tube around it.
  const IsoResult mixed =
      make_iso_surface(together(sphere, moved(shapes::patch(1, 0, 4), {3, 0, 0})).view(), options_of(0.1, 0.1));
  CHECK(mixed.statistics.is_signed);
  CHECK(mixed.statistics.components == 2);
  CHECK(mixed.statistics.solid.open_parts == 1);
}

TEST_CASE("holes: loops are found whatever meets at their vertices", "[iso]") {
  const Surface closed = build_surface(shapes::icosphere(1, 2).view(), {});
  CHECK(find_solid_parts(closed).holes.empty());
  CHECK(find_solid_parts(closed).all_solid());
  CHECK(find_solid_parts(closed).volume == Approx(4.0 / 3 * M_PI).epsilon(0.05));
  // Three triangles in a row at one vertex make one loop, two at opposite corners of a vertex two that touch.
  const Polygons sphere = shapes::icosphere(1, 3);
  const std::uint32_t v = sphere.corners[3 * 50];
  std::vector<std::size_t> around;
  for (std::size_t f = 0; f < sphere.face_count(); ++f) {
    const auto face = sphere.view().face(f);
    if (std::find(face.begin(), face.end(), v) != face.end()) around.push_back(f);
  }
  const auto shares_edge = [&](std::size_t a, std::size_t b) {
    std::size_t shared = 0;
    for (const auto x : sphere.view().face(a))
      for (const auto y : sphere.view().face(b)) shared += x == y;
    return shared == 2;
  };
  const auto apart =
      *std::find_if(around.begin() + 1, around.end(), [&](std::size_t f) { return !shares_edge(around[0], f); });
  const Surface touching =
      build_surface(without(sphere, [&](std::size_t f) { return f == around[0] || f == apart; }).view(), {});
  const Solidity found = find_solid_parts(touching);
  CHECK(found.holes.size() == 2);
  CHECK(found.all_solid());
  for (const Hole& hole : found.holes) CHECK(hole.rim.size() == 3);
}

TEST_CASE("iso: flat faces at round coordinates are valid", "[iso][no_races]") {
  for (const double d : {0.5, -0.5, 1.0}) {
    const IsoResult result = make_iso_surface(prism(24).view(), options_of(d, 0.25));
    CHECK(result.statistics.valid());
    CHECK(result.statistics.components == 1);
  }
}

TEST_CASE("iso: knife edges leave no specks", "[iso][no_races]") {
  const Polygons wedge = knife(10);
  IsoOptions options = options_of(-0.2, 0.1);
  const IsoResult result = make_iso_surface(wedge.view(), options);
  CHECK(result.statistics.valid());
  CHECK(result.statistics.components == 1);
  CHECK(result.statistics.dropped_specks > 0);
  options.keep_specks = true;
  const IsoResult all = make_iso_surface(wedge.view(), options);
  CHECK(all.statistics.components == 1 + result.statistics.dropped_specks);
  CHECK(test::enclosed_volume(all.polygons) - test::enclosed_volume(result.polygons) <
        1e-3 * static_cast<double>(result.statistics.dropped_specks));
}

TEST_CASE("specks: the largest piece stays, cavities are specks as well", "[iso]") {
  Polygons mesh = together(shapes::icosphere(1, 1), moved(shapes::icosphere(0.1, 1), {3, 0, 0}));
  Polygons hole = shapes::icosphere(0.2, 1);
  std::reverse(hole.corners.begin(), hole.corners.end());
  mesh = together(mesh, hole);
  CHECK(drop_specks(mesh, 0.01) == 1);
  CHECK(mesh.face_count() == 160);
  CHECK(drop_specks(mesh, 0.1) == 1);
  CHECK(drop_specks(mesh, 100) == 0);
  CHECK(mesh.face_count() == 80);
}

TEST_CASE("iso: what is flat is merged, and nothing of its shape is lost", "[iso]") {
  const Polygons box = shapes::box({1, 0.7, 0.52}, 1, true);
  const IsoResult inner = make_iso_surface(box.view(), options_of(-0.1, 0.03));
  CHECK(inner.statistics.valid());
  CHECK(inner.polygons.face_count() == 12);
  CHECK(test::enclosed_volume(inner.polygons) == Approx(0.8 * 0.5 * 0.32).epsilon(1e-7));
  IsoOptions uniform = options_of(0.1, 0.03);
  uniform.adaptivity = 0;
  const IsoResult all = make_iso_surface(box.view(), uniform),
                  outer = make_iso_surface(box.view(), options_of(0.1, 0.03));
  CHECK(outer.statistics.valid());
  CHECK(outer.statistics.merged_vertices + outer.polygons.positions.size() == all.polygons.positions.size());
  CHECK(outer.polygons.face_count() < all.polygons.face_count() / 2);
  CHECK(test::enclosed_volume(outer.polygons) == Approx(test::enclosed_volume(all.polygons)).epsilon(1e-8));
  // On flats, the distance is that between vertices, too.
  double worst = 0;
  for (std::size_t f = 0; f < outer.polygons.face_count(); ++f) {
    const auto face = outer.polygons.view().face(f);
    const Vec3d &a = outer.polygons.positions[face[0]], &b = outer.polygons.positions[face[1]],
                &c = outer.polygons.positions[face[2]];
    const Vec3d normal = (b - a).cross(c - a).unit();
    if (std::max({std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])}) < 1 - 1e-9) continue;
    worst = std::max(worst, std::abs(test::brute_force_distance(box.view(), (a + b + c) / 3.0) / 0.1 - 1));
  }
  CHECK(worst < 1e-6);
}

TEST_CASE("flats: a tilted cube of many triangles is one of twelve", "[iso]") {
  Polygons cube = shapes::box({1, 1, 1}, 9, true);
  for (Vec3d& p : cube.positions)
    p = Vec3d(0.6 * p[0] - 0.8 * p[1], 0.8 * p[0] + 0.6 * p[1], p[2]) + Vec3d(0.1, 0.2, 0.3);
  Surface mesh = build_surface(cube.view(), {});
  const std::size_t vertices = mesh.vertices.size();
  CHECK(merge_flats(mesh, 1e-9).vertices == vertices - 8);
  CHECK(mesh.triangles.size() == 12);
  CHECK(CrossingFinder(mesh, mesh.vertices).all().empty());
  Surface plate = build_surface(shapes::box({4, 3, 0.1}, 20, true).view(), {});
  const MergedFlats merged = merge_flats(plate, 1e-9);
  CHECK(plate.triangles.size() < 200);
  CHECK(find_faulty(plate, merged.changed).empty());
  CHECK(find_faults(plate).total() == 0);
  Surface sphere = build_surface(shapes::icosphere(1, 3).view(), {});
  CHECK(merge_flats(sphere, 1e-9).vertices == 0);
}

TEST_CASE("flats: what crosses when it is merged stays as it was, and only that", "[iso]") {
  // Two plates one upon the other. The lower one has spikes, which are higher than the tolerance; the upper one gets
  // out of their way so gently that each step is flat to within that.
  constexpr double kStep = 0.0005, kTolerance = 2.2 * kStep, kEdge = 0.2;
  const Polygons plate = shapes::box({4, 4, 1}, 20, true);
  Polygons both = together(plate, moved(plate, {0, 0, 1 + 0.1 * kStep}));
  const std::size_t of_plate = plate.positions.size();
  const double top =
      std::max_element(plate.positions.begin(), plate.positions.end(), [](const Vec3d& a, const Vec3d& b) {
        return a[2] < b[2];
      })->z();
  for (std::size_t v = 0; v < both.positions.size(); ++v) {
    Vec3d& p = both.positions[v];
    if (std::abs(p[2] - top) > 0.01) continue;
    double rings = 2;  // from the nearest spike
    for (const Vec3d& spike : {Vec3d(0.4, 0.2, 0), Vec3d(-0.8, 0.2, 0), Vec3d(1, -1, 0), Vec3d(-1, -1.2, 0)})
      rings = std::min(rings, std::max(std::abs(p[0] - spike[0]), std::abs(p[1] - spike[1])) / kEdge);
    p[2] += v < of_plate ? (rings < 0.5 ? 2 * kStep : 0) : (2 - rings) * kStep;
  }
  Surface mesh = build_surface(both.view(), {}), alone = mesh;
  REQUIRE(find_faults(mesh).total() == 0);
  const std::size_t vertices = mesh.vertices.size();
  REQUIRE(merge_flats(alone, kTolerance).vertices > 0);
  REQUIRE(find_faults(alone).total() > 0);
  const std::size_t gone = merge_flats_soundly(mesh, kTolerance);
  CHECK(static_cast<double>(gone) > 0.8 * static_cast<double>(vertices));
  CHECK(mesh.vertices.size() == vertices - gone);
  CHECK(find_faults(mesh).total() == 0);
}

TEST_CASE("iso: by default, voxels of hollow solids are so small that no face reaches the source", "[iso]") {
  const Polygons bar = notched_bar();
  const double d = 0.001;
  IsoOptions options;
  options.distance = -d;
  options.adaptivity = 0;
  // As fine as other surfaces are by default, chords cut through the tip of the notch.
  const IsoPlan coarse = plan_iso_surface(bar.view(), options).plan;
  CHECK(coarse.voxel_size > d);
  const IsoResult cutting = make_iso_surface(bar.view(), options);
  CHECK(make_hollow(bar.view(), cutting.polygons.view(), Hollow::Source::Outer).facts.crossings > 0);
  options.off_source = true;
  const IsoPlan plan = plan_iso_surface(bar.view(), options).plan;
  CHECK(plan.voxel_size == d / 2);
  const IsoResult cavity = make_iso_surface(bar.view(), options);
  const Hollow hollow = make_hollow(bar.view(), cavity.polygons.view(), Hollow::Source::Outer);
  CHECK(hollow.facts.closed);
  CHECK(hollow.facts.crossings == 0);
  // The bound that it follows from: no corner of a triangle is farther from another one than three voxels.
  double longest = 0;
  for (std::size_t f = 0; f < cavity.polygons.face_count(); ++f) {
    const auto face = cavity.polygons.view().face(f);
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest,
                         (cavity.polygons.positions[face[k]] - cavity.polygons.positions[face[(k + 1) % 3]]).length());
  }
  CHECK(longest <= 3 * plan.voxel_size);
  // They are never larger: with less memory than these take, the run is refused, and larger ones have to be asked for.
  options.max_memory = plan.bytes - 1;
  CHECK_THROWS_WITH(plan_iso_surface(bar.view(), options),
                    Catch::Contains("half the distance, so that skins do not meet"));
  options.grid.voxel_size = d;
  CHECK(plan_iso_surface(bar.view(), options).plan.voxel_size == d);
  // Where others are finer anyway, they are as they were.
  const Polygons box = shapes::box({1, 1, 1}, 2, true);
  IsoOptions wide = options_of(-0.1, 0);
  wide.grid.voxel_size.reset();
  const double before = plan_iso_surface(box.view(), wide).plan.voxel_size;
  wide.off_source = true;
  CHECK(plan_iso_surface(box.view(), wide).plan.voxel_size == before);
}

TEST_CASE("iso: a hollow solid of a mesh that is inside out is all inside out", "[iso]") {
  Polygons cube = shapes::box({1, 1, 1}, 2, true);
  for (std::size_t f = 0; f < cube.face_count(); ++f)
    std::reverse(cube.corners.begin() + cube.face_begin[f], cube.corners.begin() + cube.face_begin[f + 1]);
  IsoOptions options;
  options.orient = Orient::FixDirectionOnly;
  options.off_source = true;
  // Inward a smaller cube, outward one with round edges and corners (Steiner's formula).
  constexpr double kPi = 3.14159265358979;
  for (const auto& [distance, volume] :
       {std::pair(-0.1, 1 - 0.8 * 0.8 * 0.8), std::pair(0.1, 6 * 0.1 + 3 * kPi * 0.01 + 4 * kPi / 3 * 0.001)}) {
    options.distance = distance;
    const Polygons skin = make_iso_surface(cube.view(), options).polygons;
    const Hollow hollow = distance < 0 ? make_hollow(cube.view(), skin.view(), Hollow::Source::Outer)
                                       : make_hollow(skin.view(), cube.view(), Hollow::Source::Inner);
    INFO(distance);
    CHECK(hollow.facts.closed);
    CHECK(hollow.facts.oriented);
    CHECK(std::abs(hollow.facts.volume) == Approx(volume).epsilon(0.02));
    CHECK((hollow.facts.volume > 0) == (distance > 0));
  }
}
