// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "ground/mesh/triangulate.h"
#include "space/sheets/sheet_sides.h"
#include "support/folder.h"
#include "support/rooms.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;
using namespace vdb_offset::test::rooms;

namespace {

Made made_of_two(const Polygons& mesh, double outer, double inner) {
  OffsetOptions options;
  options.off_source = options.inner_skin_last = true;
  std::vector<OffsetResult> results = offset_several(mesh.view(), std::vector<Distances>{outer, -inner}, options);
  Made made{std::move(results[0]), {}};
  made.shell = shell_of(mesh.view(), made.result, options, &results[1]);
  report_states(made.shell, made.result);
  return made;
}

/// Both skins of every face lie in planes along it, as far apart as the sheet is to be thick, and face away from each
/// other.
void check_thickness(const Polygons& mesh, const Shell& shell, double thickness) {
  double worst = 0;
  std::size_t turned = 0;
  for (std::size_t f = 0; f < shell.skin_faces(); ++f) {
    const std::uint32_t of_mesh = shell.source_face(f);
    Vec3d normal = area_vector(mesh.view(), of_mesh);
    normal.normalize();
    const Vec3d on = mesh.positions[mesh.view().face(of_mesh)[0]];
    std::array<double, 2> least{1e9, 1e9}, most{-1e9, -1e9};
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t face = side * shell.skin_faces() + f;
      for (const auto v : shell.polygons.view().face(face)) {
        const double height = normal.dot(shell.polygons.positions[v] - on);
        least[side] = std::min(least[side], height);
        most[side] = std::max(most[side], height);
      }
      turned += area_vector(shell.polygons.view(), face).dot(normal) * (side == 0 ? 1 : -1) <= 0;
      worst = std::max(worst, most[side] - least[side]);
    }
    worst = std::max(worst, std::abs(least[0] - least[1] - thickness));
  }
  CHECK(worst < 1e-9);
  CHECK(turned == 0);
}

void add_moved(Polygons& all, const Polygons& mesh, const Vec3d& by) {
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  for (const Vec3d& p : mesh.positions) all.positions.push_back(p + by);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (const auto v : mesh.view().face(f)) all.corners.push_back(first + v);
    all.close_face();
  }
}

}  // namespace

TEST_CASE("shell junctions: walls between rooms are as thick as asked for, and mitered where they meet", "[shell]") {
  for (const double distance : {0.5, -0.5, 2.0}) {
    INFO(distance);
    const Polygons mesh = walls(four_rooms());
    const Made made = made_of(mesh, distance);
    check_one_solid(made.shell);
    check_thickness(mesh, made.shell, std::abs(distance));
    CHECK(made.shell.facts.pinched_vertices == 0);
    CHECK(made.shell.facts.short_junctions == 0);
    CHECK(made.shell.facts.volume == Approx(8 * 120 * std::abs(distance)).epsilon(0.02 * std::abs(distance) / 0.5));
    for (const VertexState state : made.result.states) CHECK(state == VertexState::Reached);
  }
}

TEST_CASE("shell junctions: where walls are of smaller faces than they are thick, these make room", "[shell]") {
  const Polygons mesh = walls(four_rooms(), 40, 8);
  const Made made = made_of(mesh, 0.6);
  check_one_solid(made.shell);
  check_thickness(mesh, made.shell, 0.6);
  CHECK(made.shell.facts.volume == Approx(made_of(walls(four_rooms()), 0.6).shell.facts.volume).epsilon(1e-3));
}

TEST_CASE("shell junctions: three leaves of a book, at any angles and whichever way they face", "[shell][no_races]") {
  for (int turned = 0; turned < 8; ++turned)
    for (const double angle : {60.0, 120.0, 170.0, 180.0}) {
      INFO(turned << ", " << angle);
      std::vector<std::array<Vec3d, 2>> lines;
      int leaf = 0;
      for (const double a : {0.0, angle, 250.0}) {
        const double radians = a * std::numbers::pi / 180;
        const Vec3d end(5 * std::cos(radians), 5 * std::sin(radians), 0);
        if (turned >> leaf++ & 1) lines.push_back({end, Vec3d(0.0)});
        else lines.push_back({Vec3d(0.0), end});
      }
      const Polygons mesh = walls(lines);
      const Made made = made_of(mesh, 0.3);
      check_one_solid(made.shell);
      check_thickness(mesh, made.shell, 0.3);
      CHECK(made.shell.facts.pinched_vertices == 0);
    }
}

TEST_CASE("shell junctions: a box with a wall inside gets cells with walls of that thickness", "[shell]") {
  // Cubes of edge 2 side by side, with one wall between them.
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {0, 2, 0}, {0, 2, 2}, {0, 0, 2}, {2, 0, 0}, {2, 2, 0},
                    {2, 2, 2}, {2, 0, 2}, {4, 0, 0}, {4, 2, 0}, {4, 2, 2}, {4, 0, 2}};
  mesh.add_face({0, 3, 2, 1});
  mesh.add_face({8, 9, 10, 11});
  for (const std::uint32_t i : {0u, 4u}) {
    mesh.add_face({i, i + 1, i + 5, i + 4});
    mesh.add_face({i + 2, i + 3, i + 7, i + 6});
    mesh.add_face({i + 3, i, i + 4, i + 7});
    mesh.add_face({i + 1, i + 2, i + 6, i + 5});
  }
  mesh.add_face({4, 5, 6, 7});
  const Made out = made_of(mesh, 0.25), in = made_of(mesh, -0.25);
  for (const Made* made : {&out, &in}) {
    check_one_solid(made->shell);
    check_thickness(mesh, made->shell, 0.25);
  }
  // The outer box, less two cells, of which the wall inside takes 0.25 from one.
  CHECK(out.shell.facts.volume == Approx(4.5 * 2.5 * 2.5 - 2 * 2 * 2 - 1.75 * 2 * 2));
  CHECK(in.shell.facts.volume == Approx(4 * 2 * 2 - 1.5 * 1.5 * (1.75 + 1.5)));
}

TEST_CASE("shell junctions: cubes that share an edge, or a corner, are hollowed each by itself", "[shell]") {
  for (const Vec3d& by : {Vec3d(2, 2, 0), Vec3d(2, 2, 2)}) {
    Polygons mesh;
    add_moved(mesh, shapes::box(Vec3d(2), 2, false), Vec3d(0.0));
    add_moved(mesh, shapes::box(Vec3d(2), 2, false), by);
    const Made made = made_of(mesh, -0.25);
    check_thickness(mesh, made.shell, 0.25);
    CHECK(made.shell.facts.closed);
    CHECK(made.shell.facts.oriented);
    CHECK(made.shell.facts.crossings == 0);
    CHECK(made.shell.facts.pinched_vertices == 0);
    CHECK(made.shell.facts.volume == Approx(2 * (8 - 1.5 * 1.5 * 1.5)));
  }
}

TEST_CASE("shell junctions: cubes that share an edge get one skin around both, mitered on either side", "[shell]") {
  const double d = 0.25;
  for (const int divisions : {1, 2})
    for (const bool triangles : {false, true})
      for (const std::uint32_t first : {0u, 1u}) {
        INFO(divisions << ", " << triangles << ", " << first);
        Polygons mesh;
        add_moved(mesh, shapes::box(Vec3d(2), divisions, triangles), Vec3d(2, 2, 0) * first);
        add_moved(mesh, shapes::box(Vec3d(2), divisions, triangles), Vec3d(2, 2, 0) * (1 - first));
        const Made made = made_of(mesh, d);
        if (divisions == 1) check_thickness(mesh, made.shell, d);
        CHECK(made.shell.facts.closed);
        CHECK(made.shell.facts.oriented);
        CHECK(made.shell.facts.crossings == 0);
        CHECK(made.shell.facts.pinched_vertices == 0);
        CHECK(made.shell.facts.short_junctions == 0);
        // On the inner skin, which is the source, the edge is what it was; the outer one has none.
        CHECK(made.shell.facts.non_manifold_edges == static_cast<std::size_t>(divisions));
        // At either end, each cube's side there is as wide as two corners ask for.
        CHECK(made.shell.facts.rim_triangles == 4);
        CHECK(made.shell.facts.rim_quads == 0);
        const double side = 2 + 2 * d;
        CHECK(made.shell.facts.volume == Approx(2 * (side * side * side - 8) - 4 * d * d * side)
                                             // Far from the junction it is edges' vertices that are at the distance.
                                             .epsilon(divisions == 1 ? 1e-9 : 0.02));
        CHECK(summarise(made.result).share_reached == 1);
      }
}

TEST_CASE("shell junctions: blocks that touch along edges which meet, or end within a wall", "[shell]") {
  // On a lattice of cubes of edge 2, each with what the outer skin encloses beside them.
  struct Case {
    std::vector<Vec3d> cubes;
    double around;
  };
  const double cube = 2.5 * 2.5 * 2.5, edge = 0.5 * 0.5 * 2.5;
  // In a row, and as a step that turns: three cubes, two edges.
  const Case cases[] = {{{{0, 0, 0}, {2, 2, 0}, {4, 4, 0}}, 3 * cube - 2 * edge},
                        {{{0, 0, 0}, {2, 2, 0}, {4, 0, 0}}, 3 * cube - 2 * edge},
                        {{{0, 0, 0}, {2, 2, 0}, {4, 2, 2}}, 3 * cube - 2 * edge}};
  for (const Case& c : cases) {
    Polygons mesh;
    for (const Vec3d& at : c.cubes) add_moved(mesh, shapes::box(Vec3d(2), 1, false), at);
    const Made made = made_of(mesh, 0.25);
    check_thickness(mesh, made.shell, 0.25);
    CHECK(made.shell.facts.closed);
    CHECK(made.shell.facts.oriented);
    CHECK(made.shell.facts.crossings == 0);
    CHECK(made.shell.facts.short_junctions == 0);
    CHECK(made.shell.facts.volume == Approx(c.around - 8.0 * static_cast<double>(c.cubes.size())));
  }
}

TEST_CASE("shell junctions: two faces that share a corner have a vertex each on their skins", "[shell]") {
  Polygons bow;
  bow.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, -0.5}, {2, 2, -0.5}, {1, 2, 0}};
  bow.add_face({0, 1, 2, 3});
  bow.add_face({2, 4, 5, 6});
  const Made made = made_of(bow, 0.1);
  CHECK(made.shell.facts.closed);
  CHECK(made.shell.facts.oriented);
  CHECK(made.shell.facts.junction_vertices == 1);
  CHECK(made.shell.facts.pinched_vertices == 0);
}

TEST_CASE("shell junctions: a strip with one side only becomes one solid", "[shell]") {
  Polygons strip;
  constexpr std::uint32_t kSteps = 60;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double a = 2 * std::numbers::pi * i / kSteps;
    for (const double s : {-0.5, 0.0, 0.5}) {
      const double r = 2 + s * std::cos(a / 2);
      strip.positions.emplace_back(r * std::cos(a), r * std::sin(a), s * std::sin(a / 2));
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t v = 3 * i + k;
      if (i + 1 < kSteps) strip.add_face({v, v + 3, v + 4, v + 1});
      else strip.add_face({v, 2 - k, 1 - k, v + 1});
    }
  const Made both = made_of_two(strip, 0.05, 0.05);
  check_one_solid(both.shell);
  CHECK(both.shell.facts.volume == Approx(0.1 * build_surface(strip.view(), {}).facts.area).epsilon(0.02));
  const Made one = made_of(strip, 0.05);
  check_one_solid(one.shell);
  CHECK(one.shell.facts.pinched_vertices == 0);
  CHECK(one.shell.facts.volume == Approx(0.05 * build_surface(strip.view(), {}).facts.area).epsilon(0.02));
}

TEST_CASE("shell junctions: what has no room is held back, told, and still valid", "[shell]") {
  const Polygons mesh = walls(four_rooms());
  const Made made = made_of(mesh, 12);
  CHECK(made.shell.facts.crossings == 0);
  CHECK(made.shell.facts.closed);
  CHECK(made.shell.facts.oriented);
  CHECK(made.shell.facts.short_junctions > 0);
  CHECK(std::count(made.result.states.begin(), made.result.states.end(), VertexState::Limited) > 0);
}

TEST_CASE("shell: of a part is open where the rest was, with a flush rim", "[shell]") {
  // A box whose lid is left out.
  const Polygons mesh = shapes::box(Vec3d(2), 3, false);
  std::vector<std::uint8_t> only(mesh.face_count(), 1);
  for (std::size_t f = 0; f < only.size(); ++f) {
    double lowest = 1;
    for (const auto v : mesh.view().face(f)) lowest = std::min(lowest, mesh.positions[v][2]);
    only[f] = lowest < 1;
  }
  for (const double distance : {-0.25, 0.25}) {
    const Shell shell = made_of(mesh, distance, only).shell;
    check_one_solid(shell);
    CHECK(shell.rim.size() == 12);
    CHECK(shell.skin_faces() == 45);
    for (std::size_t f = 90; f < shell.polygons.face_count(); ++f)
      for (const auto v : shell.polygons.view().face(f))
        CHECK(shell.polygons.positions[v][2] == Approx(1).epsilon(1e-12));
  }
  CHECK(made_of(mesh, -0.25, only).shell.facts.volume == Approx(8 - 1.5 * 1.5 * 1.75).epsilon(1e-6));
}
