// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/shell.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "ground/numbers/index_set.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "support/shells.h"
#include "valid/faults/rim_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test::shells;

namespace {

/// As the command makes it: what moves keeps off the source.
Shell solid_of(const Polygons& mesh, double distance) {
  OffsetOptions options;
  options.distance = distance;
  options.off_source = true;
  return shell_of(mesh.view(), offset(mesh.view(), options), options);
}

}  // namespace

TEST_CASE("shell: two skins and a rim, by hand", "[shell]") {
  const Polygons mesh = quad();
  const Shell shell = make_shell(mesh.view(), raised(mesh.positions, 2), mesh.positions, {});
  CHECK(shell.polygons.positions.size() == 8);
  CHECK(shell.polygons.corners ==
        std::vector<std::uint32_t>{0, 1, 2, 3, 4, 7, 6, 5, 1, 0, 4, 5, 2, 1, 5, 6, 3, 2, 6, 7, 0, 3, 7, 4});
  CHECK(shell.part(0) == ShellPart::Outer);
  CHECK(shell.part(1) == ShellPart::Inner);
  CHECK(shell.part(2) == ShellPart::Rim);
  CHECK(shell.source_face(5) == 0);
  CHECK(shell.source_corner(mesh.view(), 1, 1) == 3);
  CHECK(shell.source_corner(mesh.view(), 5, 0) == 0);
  CHECK(shell.source_corner(mesh.view(), 5, 2) == 3);
  CHECK(shell.facts.rim_quads == 4);
  CHECK(shell.facts.volume == 2);
  check_solid(shell);
}

TEST_CASE("shell: where an end of a border edge stays, the rim has a triangle or nothing", "[shell]") {
  const Polygons mesh = quad();
  std::vector<Vec3d> outer = raised(mesh.positions, 1);
  outer[0] = mesh.positions[0];
  const Shell one = make_shell(mesh.view(), outer, mesh.positions, {});
  CHECK(one.facts.rim_quads == 2);
  CHECK(one.facts.rim_triangles == 2);
  CHECK(one.facts.volume == Approx(2. / 3));  // half the box, and a sixth
  check_solid(one);
  outer[1] = mesh.positions[1];
  const Shell two = make_shell(mesh.view(), outer, mesh.positions, {});
  CHECK(two.facts.rim_quads == 1);
  CHECK(two.facts.rim_triangles == 2);
  CHECK(two.rim.size() == 3);
  CHECK(two.facts.volume == 0.5);
  check_solid(two);
}

TEST_CASE("shell: of open and closed shapes and their offsets", "[shell]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  struct Case {
    const char* name;
    Polygons mesh;
    double distance;
    bool open;
  };
  const Case cases[] = {{"hemisphere of quads", upper_half(shapes::uv_sphere(1, 32, 16)), 0.1, true},
                        {"hemisphere inwards", upper_half(shapes::uv_sphere(1, 32, 16)), -0.1, true},
                        {"hemisphere with a jagged border", upper_half(sphere), 0.05, true},
                        {"wavy patch", shapes::patch(1, 0.1, 12), 0.05, true},
                        {"cube", shapes::box(Vec3d(1), 6, false), 0.1, false},
                        {"cube inwards", shapes::box(Vec3d(1), 6, true), -0.1, false},
                        {"torus", shapes::torus(1, 0.3, 32, 16), 0.1, false},
                        {"sphere inwards", sphere, -0.2, false}};
  for (const Case& c : cases) {
    INFO(c.name);
    const Shell shell = offset_shell(c.mesh, c.distance);
    check_solid(shell);
    CHECK(shell.facts.rim_triangles == 0);
    CHECK((shell.facts.rim_quads > 0) == c.open);
    CHECK(shell.rim.size() == build_surface(c.mesh.view(), {}).facts.boundary_edges);
    if (!c.open)
      CHECK(shell.facts.volume == Approx(volume(c.mesh, shell.outer()) - volume(c.mesh, shell.inner())).epsilon(1e-12));
    // Corners of their own, as in STL, change nothing but the numbers of vertices.
    const Polygons soup = test::torn(c.mesh);
    const Shell of_soup = offset_shell(soup, c.distance);
    CHECK(of_soup.rim.size() == shell.rim.size());
    CHECK(of_soup.facts.volume == Approx(shell.facts.volume).epsilon(1e-9));
    check_solid(of_soup);
  }
}

TEST_CASE("shell: a flat patch becomes a box of that height", "[shell]") {
  const Polygons patch = shapes::patch(3, 0, 5);
  CHECK(make_shell(patch.view(), raised(patch.positions, 0.25), patch.positions, {}).facts.volume ==
        Approx(9 * 0.25).epsilon(1e-14));
  const Shell shell = offset_shell(patch, 0.25);
  CHECK(shell.facts.volume == Approx(9 * 0.25).epsilon(1e-6));
  CHECK(shell.facts.rim_quads == 20);
  // The other way round it is inside out, which the sign tells.
  CHECK(make_shell(patch.view(), patch.positions, raised(patch.positions, 0.25), {}).facts.volume ==
        Approx(-9 * 0.25).epsilon(1e-14));
}

TEST_CASE("shell: by default a cube has a larger cube around it", "[shell][miter]") {
  const Shell shell = solid_of(shapes::box(Vec3d(1), 1, false), 0.1);
  std::size_t outer = 0;
  for (const Vec3d& p : shell.polygons.positions) {
    const double side = std::abs(p[0]) > 0.55 ? 0.6 : 0.5;
    outer += side > 0.5;
    for (int k = 0; k < 3; ++k) CHECK(std::abs(std::abs(p[k]) - side) <= 1e-12);
  }
  CHECK(outer == 8);
  CHECK(shell.facts.volume == Approx(1.2 * 1.2 * 1.2 - 1));
}

TEST_CASE("shell: a rim stops before what stands in its way", "[shell]") {
  // A plate, and the tip of a triangle over its border, in the rim's way but not in that of the plate.
  Polygons mesh = quad();
  for (const Vec3d& p : {Vec3d(0.98, 0.5, 0.06), Vec3d(2, 0.4, 0.06), Vec3d(2, 0.6, 0.06)}) mesh.positions.push_back(p);
  mesh.add_face({4, 5, 6});
  OffsetOptions options;
  options.distance = Distances(std::vector<double>{0.1, 0.1, 0.1, 0.1, 0, 0, 0});
  CHECK(shell_of(mesh.view(), offset(mesh.view(), options), options).facts.crossings > 0);
  options.off_source = true;
  const OffsetResult result = offset(mesh.view(), options);
  const Shell shell = shell_of(mesh.view(), result, options);
  CHECK(shell.facts.crossings == 0);
  CHECK(shell.facts.pinched_vertices == 3);
  // The edge between these runs below the tip, halfway, whichever of them goes farther.
  const double halfway = (result.achieved[1] + result.achieved[2]) / 2;
  CHECK(halfway < 0.06);
  CHECK(halfway > 0.05);
  CHECK(std::min(result.achieved[1], result.achieved[2]) > 0.01);
  for (const std::size_t v : {0, 3}) CHECK(result.states[v] == VertexState::Reached);
}

TEST_CASE("shell: the outer skin of one sheet keeps off the inner skin of another", "[shell]") {
  Polygons mesh = quad();
  for (const Vec3d& p : raised(mesh.positions, 0.15)) mesh.positions.push_back(p + Vec3d(0.3, 0, 0));
  mesh.add_face({4, 5, 6, 7});
  const std::vector<Distances> both = {0.1, -0.1};
  OffsetOptions options;
  options.off_source = true;
  std::vector<OffsetResult> results = offset_several(mesh.view(), both, options);
  CHECK(shell_of(mesh.view(), results[0], options, &results[1]).facts.crossings > 0);
  options.inner_skin_last = true;
  results = offset_several(mesh.view(), both, options);
  const Shell shell = shell_of(mesh.view(), results[0], options, &results[1]);
  check_solid(shell);
  CHECK(shell.facts.pinched_vertices == 0);
  CHECK(results[1].states[0] == VertexState::Reached);
  CHECK(results[0].states[4] == VertexState::Reached);
}

/// A shape made up from a seed, every other one opened by a plane, or two that may be in each other.
Polygons random_sheets(unsigned seed) {
  Polygons all;
  for (const unsigned part : {seed, seed + 100000}) {
    const Polygons whole = test::random_scene(part).mesh;
    Vec3d lower = whole.positions[0], upper = lower;
    for (const Vec3d& p : whole.positions) {
      lower = openvdb::math::minComponent(lower, p);
      upper = openvdb::math::maxComponent(upper, p);
    }
    Polygons mesh = whole;
    for (Vec3d& p : mesh.positions) p = (p - (lower + upper) / 2.0) * (1.0 / (upper - lower).length());
    if (seed % 2 == 0) mesh = upper_half(mesh);
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      for (const auto v : mesh.view().face(f)) all.corners.push_back(first + v);
      all.close_face();
    }
    if (seed % 3 == 0) break;
  }
  return all;
}

TEST_CASE("shell: of random sheets, nothing meets but where the source does", "[shell][property][random]") {
  const test::Seeds seeds = test::random_seeds(6);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    INFO("seed " << seed);
    const Polygons mesh = random_sheets(seed);
    if (mesh.face_count() == 0) continue;
    OffsetOptions options;
    options.off_source = options.inner_skin_last = true;
    const double distance = 0.003 * (1 + seed % 11);
    const std::vector<OffsetResult> results =
        offset_several(mesh.view(), std::vector<Distances>{distance, -distance}, options);
    for (const OffsetResult* inner : {&results[1], static_cast<const OffsetResult*>(nullptr)}) {
      const Shell shell = shell_of(mesh.view(), results[inner ? 0 : 1], options, inner);
      CHECK(shell.facts.crossings == 0);
    }
  }
}

TEST_CASE("shell: what stays is where the source is in another format, too", "[shell]") {
  const auto [mesh, distances] = test::far_sphere();
  OffsetOptions options;
  options.distance = Distances(distances);
  options.off_source = true;
  options.precision = {.kind = Precision::Kind::Single, .rounds_all = true};
  const OffsetResult result = offset(mesh.view(), options);
  CHECK(result.statistics.limit.left.total() == 0);
  for (std::size_t v = 0; v < distances.size(); ++v)
    if (distances[v] > 0) CHECK(result.states[v] == VertexState::Reached);
  const Shell shell = shell_of(mesh.view(), result, options);
  CHECK(shell.facts.crossings + shell.facts.crossings_near_source == 0);
}

TEST_CASE("shell: what meets a rim is found as its vertices move, whichever way faces run", "[shell]") {
  std::mt19937 engine(7);
  const auto in_box = [&](const Vec3d& lower, const Vec3d& upper) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = lower[k] + (upper[k] - lower[k]) * (engine() / 4294967296.0);
    return p;
  };
  for (int round = 0; round < 20; ++round) {
    INFO(round);
    // A patch with some faces turned, and small triangles above it.
    const Polygons patch = shapes::patch(1, 0.05, 4);
    Polygons mesh;
    mesh.positions = patch.positions;
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto face = patch.view().face(f);
      if (f % 3 == 1) mesh.corners.insert(mesh.corners.end(), face.rbegin(), face.rend());
      else mesh.corners.insert(mesh.corners.end(), face.begin(), face.end());
      mesh.close_face();
    }
    for (int i = 0; i < 12; ++i) {
      const Vec3d centre = in_box(Vec3d(-0.6, -0.6, 0.1), Vec3d(0.6, 0.6, 0.4));
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (int k = 0; k < 3; ++k) mesh.positions.push_back(centre + in_box(Vec3d(-0.1), Vec3d(0.1)));
      mesh.add_face({first, first + 1, first + 2});
    }
    Surface surface = build_surface(mesh.view(), {});
    REQUIRE(surface.facts.turned_triangles > 0);
    to_local_frame(surface, 0.1);
    std::vector<Vec3d> source;
    for (const auto v : surface.representative) source.push_back(mesh.positions[v]);
    std::vector<Vec3d> positions = source;
    const ClosestQuery query(surface);
    const Distances distances(0.3);
    CrossingFinder now(surface, positions);
    const CrossingFinder before(surface, source);
    const SourceCrossings none(surface, {});
    const ConstrainedSurface constrained{query, surface, {}, {}, {}};
    RimCrossings rim(constrained, source, positions, distances);
    for (int step = 0; step < 4; ++step) {
      std::vector<std::uint32_t> moved, touched;
      for (std::uint32_t v = 0; v < positions.size(); ++v) {
        if (step > 0 && engine() % 10 < 7) continue;
        moved.push_back(v);
        positions[v] = source[v] + in_box(Vec3d(-0.1, -0.1, 0), Vec3d(0.1, 0.1, 0.4));
        const auto around = surface.triangles_around(v);
        touched.insert(touched.end(), around.begin(), around.end());
      }
      sort_unique(touched);
      now.update(touched);
      rim.find(moved, touched, now, before, none);
      std::vector<Vec3d> outer = mesh.positions;
      for (std::size_t v = 0; v < outer.size(); ++v) outer[v] = positions[surface.welded[v]];
      const Shell shell = make_shell(mesh.view(), outer, mesh.positions, {});
      const Surface solid = build_surface(shell.polygons.view(), {});
      std::size_t expected = 0;
      for (const auto& [s, t] : CrossingFinder(solid, solid.vertices).all())
        expected += shell.part(solid.face[s]) == ShellPart::Rim || shell.part(solid.face[t]) == ShellPart::Rim;
      CHECK(rim.count() == expected);
      CHECK(expected > 0);
    }
  }
}

TEST_CASE("shell: what cannot be joined is counted", "[shell]") {
  // Three leaves of a book: edges of three faces have no rim, and so the rims at their ends are three, too.
  Polygons book;
  book.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  book.add_face({0, 2, 3, 1});
  book.add_face({4, 0, 1, 5});
  book.add_face({0, 1, 7, 6});
  const Shell leaves = make_shell(book.view(), raised(book.positions, 0.1), book.positions, {});
  CHECK(leaves.facts.rim_quads == 9);
  CHECK(leaves.facts.non_manifold_edges == 4);
  CHECK_FALSE(leaves.facts.closed);
  CHECK_FALSE(leaves.facts.oriented);

  Polygons turned = quad();
  turned.positions.insert(turned.positions.end(), {{2, 0, 0}, {2, 1, 0}});
  turned.add_face({1, 2, 5, 4});
  const Shell twisted = make_shell(turned.view(), raised(turned.positions, 1), turned.positions, {});
  CHECK(twisted.facts.rim_quads == 6);
  CHECK(twisted.facts.closed);
  CHECK_FALSE(twisted.facts.oriented);

  // Two faces that share a corner: the rim touches itself there.
  Polygons bow = quad();
  bow.positions.insert(bow.positions.end(), {{2, 1, 0}, {2, 2, 0}, {1, 2, 0}});
  bow.add_face({2, 4, 5, 6});
  const Shell touching = make_shell(bow.view(), raised(bow.positions, 1), bow.positions, {});
  CHECK(touching.facts.non_manifold_edges == 1);
  CHECK(touching.facts.closed);
  CHECK(touching.facts.oriented);
  CHECK(touching.facts.volume == 2);
}

TEST_CASE("shell: where the source crosses itself skins keep their thickness, and what meets is counted apart",
          "[shell]") {
  Polygons boxes = shapes::box(Vec3d(1), 6, true);
  const auto count = static_cast<std::uint32_t>(boxes.positions.size());
  const std::size_t faces = boxes.face_count();
  for (std::size_t v = 0; v < count; ++v) boxes.positions.push_back(boxes.positions[v] + Vec3d(0.47, 0.41, 0.53));
  for (std::size_t f = 0; f < faces; ++f) {
    for (std::size_t k = 0; k < 3; ++k) boxes.corners.push_back(boxes.corners[3 * f + k] + count);
    boxes.close_face();
  }
  const Shell shell = solid_of(boxes, 0.03);
  const Surface source = build_surface(boxes.view(), {});
  CHECK(shell.facts.source_crossings == CrossingFinder(source, source.vertices).all().size());
  CHECK(shell.facts.source_crossings > 0);
  CHECK(shell.facts.crossings_near_source > 0);
  CHECK(shell.facts.crossings == 0);
  CHECK(shell.facts.pinched_vertices == 0);
  CHECK(shell.facts.non_manifold_edges == 0);
}

TEST_CASE("shell: of a folded vertex and those around it, only that one stays", "[shell]") {
  // A cone over a U, as seen from its apex: whatever direction sees the insides of one prong is behind the other's.
  Polygons cone;
  cone.positions = {{0, 0, 0}};
  for (const auto& [x, y] : {std::pair(-3, -2), {3, -2}, {3, 2}, {1, 2}, {1, -1}, {-1, -1}, {-1, 2}, {-3, 2}})
    cone.positions.emplace_back(x, y, 2);
  for (std::uint32_t k = 1; k <= 8; ++k) cone.add_face({0, k % 8 + 1, k});
  const Shell shell = solid_of(cone, 0.1);
  CHECK(shell.outer()[0] == cone.positions[0]);
  CHECK(shell.facts.pinched_vertices == 1);
  CHECK(shell.facts.crossings == 0);
  CHECK(shell.facts.closed);
}

TEST_CASE("shell: faces without extent, nothing moved, and welding", "[shell]") {
  Polygons mesh = quad();
  mesh.add_face({0, 1, 1});  // a line along the border
  CHECK(make_shell(mesh.view(), raised(mesh.positions, 1), mesh.positions, {}).facts.rim_quads == 4);
  const Polygons flat = quad();
  const Shell nothing = make_shell(flat.view(), flat.positions, flat.positions, {});
  CHECK(nothing.rim.empty());
  CHECK(nothing.facts.closed);
  CHECK(nothing.facts.volume == 0);

  const Polygons soup = test::torn(shapes::box(Vec3d(1), 2, false));
  std::vector<Vec3d> grown = soup.positions;
  for (Vec3d& p : grown) p *= 1.5;
  const Shell welded = make_shell(soup.view(), grown, soup.positions, {});
  CHECK(welded.rim.empty());
  CHECK(welded.facts.closed);
  const Shell apart = make_shell(soup.view(), grown, soup.positions, {.enabled = false});
  CHECK(apart.facts.rim_quads == 4 * soup.face_count());
  CHECK(apart.facts.closed);
  CHECK(apart.facts.oriented);
  CHECK(apart.facts.volume == Approx(welded.facts.volume));
  // Copies that are not quite at one position.
  Polygons loose = soup;
  for (std::size_t v = 0; v < loose.positions.size(); ++v) loose.positions[v][0] += static_cast<double>(v % 2) * 1e-9;
  CHECK_FALSE(make_shell(loose.view(), grown, loose.positions, {}).rim.empty());
  const Shell near = make_shell(loose.view(), grown, loose.positions, {.tolerance = 1e-6});
  CHECK(near.rim.empty());
  CHECK(near.facts.closed);
}

TEST_CASE("shell: refuses skins of another mesh", "[shell]") {
  const Polygons mesh = quad();
  const std::vector<Vec3d> three(3);
  CHECK_THROWS_WITH(make_shell(mesh.view(), three, mesh.positions, {}),
                    Catch::Contains("4 vertices") && Catch::Contains("got 3 and 4"));
  CHECK_THROWS_AS(make_shell(Polygons().view(), {}, {}, {}), InvalidInput);
}

namespace {

using U8 = std::uint8_t;
using I16 = std::int16_t;

}  // namespace

TEST_CASE("shell: an opening has a flat rim, and vertices inside it are not in the way", "[shell]") {
  const double size = 1, d = 0.2;
  const Polygons box = shapes::box(Vec3d(size, size, size), 20, false);
  for (const double side : {-1.0, 1.0}) {
    OffsetOptions options;
    options.distance = side * d;
    options.off_source = true;
    options.corners = Corners::Miter;
    for (std::size_t f = 0; f < box.face_count(); ++f) {
      const auto face = box.view().face(f);
      const bool is_top = std::ranges::all_of(face, [&](auto v) { return box.positions[v].z() == size / 2; });
      options.only.push_back(!is_top);
    }
    const Shell cup = shell_of(box.view(), offset(box.view(), options), options);
    check_solid(cup);
    const double within = size - 2 * d, around = size + 2 * d;
    const double volume = side < 0 ? 1 - within * within * (size - d) : around * around * (size + d) - 1;
    CHECK(cup.facts.volume == Approx(volume).epsilon(1e-5));
    CHECK(cup.facts.rim_quads == 4 * 20);
    for (std::size_t f = 2 * cup.skin_faces(); f < cup.polygons.face_count(); ++f)
      for (const auto v : cup.polygons.view().face(f))
        CHECK(cup.polygons.positions[v].z() == Approx(size / 2).margin(1e-9));
  }
}
