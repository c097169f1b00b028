// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/fill.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "products/volume/cell_quality.h"
#include "products/volume/volume_faces.h"
#include "support/fills.h"
#include "support/grown_curves.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A tube along x, open at both ends, seen from inside.
Polygons tube(int segments, int stacks, double length) {
  Polygons mesh;
  const auto n = static_cast<std::uint32_t>(segments);
  for (int j = 0; j <= stacks; ++j)
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * std::numbers::pi * i / segments;
      mesh.positions.emplace_back(length * j / stacks, std::cos(angle), std::sin(angle));
    }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(stacks); ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * n + i, b = j * n + (i + 1) % n;
      mesh.add_face({a, a + n, b + n, b});
    }
  return mesh;
}

}  // namespace

TEST_CASE("the inside of a closed surface is filled behind its layers") {
  const bool is_of_quads = GENERATE(true, false);
  const FillQuads quads = is_of_quads ? GENERATE(FillQuads::Split, FillQuads::Pyramids) : FillQuads::Split;
  const Polygons wall = shapes::box({2, 2, 2}, 4, !is_of_quads);
  FillOptions options;
  options.quads = quads;
  const Filled made = fill(wall, -0.2, fill_from_middle, options);
  require_mesh(made.mesh, 8);
  CHECK(made.mesh.patches.size() == 1);
  CHECK(made.report.pyramids == (is_of_quads && quads == FillQuads::Pyramids ? 96 : 0));
  CHECK(made.report.split_cells == (is_of_quads && quads == FillQuads::Split ? 96 : 0));
  CHECK(made.report.tetrahedra == (quads == FillQuads::Pyramids && is_of_quads ? 384 : 192));
  CHECK(made.report.volume == Approx(1.6 * 1.6 * 1.6));
  CHECK(made.report.scaled_jacobian.least > 0);
  const bool has_polyhedra = std::ranges::count(made.mesh.cell_types, CellType::Polyhedron) > 0;
  CHECK(has_polyhedra == (is_of_quads && quads == FillQuads::Split));
}

TEST_CASE("openings of a tube are covered by caps that belong to the sides around them") {
  const Polygons wall = tube(24, 6, 3);
  const Filled made = fill(wall, 0.3, fill_from_middle);
  const double area = 12 * std::sin(2 * std::numbers::pi / 24);
  require_mesh(made.mesh, 3 * area);
  REQUIRE(made.mesh.patches.size() == 3);
  for (const char* const name : {"sides_1", "sides_2"}) {
    const BoundaryPatch* const cap = patch_of(made.mesh, name);
    REQUIRE(cap != nullptr);
    double covered = 0;
    const double x = made.mesh.points[cap->corners[0]][0];
    for (std::size_t f = 0; f < cap->face_count(); ++f) {
      const auto face = cap->face(f);
      for (const std::uint32_t p : face) REQUIRE(made.mesh.points[p][0] == x);
      covered += std::abs(six_volumes_below(made.mesh.points, face, Vec3d(x - 1, 0, 0))) / 2;
    }
    CHECK(covered == Approx(area).epsilon(1e-12));
  }
  FillOptions options;
  options.caps = false;
  CHECK_THROWS_AS(fill(wall, 0.3, fill_from_middle, options), InvalidInput);
}

TEST_CASE("the outside of a body is filled out to the farfield, and half of it along its plane") {
  std::vector<FillDomain> seen;
  const Filler look = [&](const FillDomain& domain) -> FilledDomain {
    seen.push_back(domain);
    throw FillFailed("enough");
  };
  const bool is_half = GENERATE(true, false);
  const bool is_box = GENERATE(true, false);
  const Polygons wall = is_half ? shapes::hemisphere(1, 24, 6) : shapes::icosphere(1, 2);
  FillOptions options;
  options.farfield.size = 5;
  options.farfield.shape = is_box ? Farfield::Shape::Box : Farfield::Shape::Sphere;
  CHECK_THROWS_AS(fill(wall, 0.1, look, options), FillFailed);
  REQUIRE(seen.size() == 1);
  // Its volume: each edge has two triangles of opposite directions, and the farfield is what the options say.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  double six_volumes = 0, farthest = 0, lowest = 0;
  for (const auto& t : seen[0].triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    six_volumes += seen[0].points[t[0]].dot(seen[0].points[t[1]].cross(seen[0].points[t[2]]));
  }
  for (const Vec3d& x : seen[0].points) farthest = std::max(farthest, x.length()), lowest = std::min(lowest, x[2]);
  for (const auto& [ends, count] : sides) {
    REQUIRE(count == 1);
    REQUIRE(sides.contains({ends.second, ends.first}));
  }
  const double width = is_box ? 2.2 + 2 * 11 : 0, height = is_half ? 1.1 + 11 : width;
  const double whole = is_box ? width * width * height : 4.0 / 3 * std::numbers::pi * 1331 / (is_half ? 2 : 1);
  CHECK(six_volumes / 6 == Approx(whole).epsilon(is_box ? 1e-3 : 0.06));
  CHECK(seen[0].outside.size() == 1);
}

TEST_CASE("what carries no layers is part of what is filled") {
  const Polygons wall = shapes::box({2, 2, 2}, 4, true);
  std::vector<std::uint8_t> only(wall.face_count(), 0);
  for (std::size_t f = 0; f < wall.face_count(); ++f) {
    const auto face = wall.view().face(f);
    only[f] = std::ranges::all_of(face, [&](std::uint32_t v) { return wall.positions[v][2] == 1; });
  }
  double six_volumes = 0;
  const Filler look = [&](const FillDomain& domain) -> FilledDomain {
    for (const auto& t : domain.triangles)
      six_volumes += domain.points[t[0]].dot(domain.points[t[1]].cross(domain.points[t[2]]));
    throw FillFailed("enough");
  };
  FillOptions options;
  options.farfield = {.shape = Farfield::Shape::Box, .size = 3, .in_lengths = false};
  // Layers on the upper side alone: their sides and the rest of the box are the border.
  CHECK_THROWS_AS(fill(wall, 0.2, look, options, only), FillFailed);
  CHECK(six_volumes / 6 == Approx(8 * 8 * 8.2 - (8 + 4 * 0.2)).epsilon(1e-6));
}

TEST_CASE("a filler's result that is no mesh of the domain is refused") {
  const std::function<void(FilledDomain&)> spoil = GENERATE(values<std::function<void(FilledDomain&)>>({
      [](FilledDomain& filled) { filled.cells.pop_back(); },
      [](FilledDomain& filled) { filled.cells.push_back(filled.cells[3]); },
      [](FilledDomain& filled) { std::swap(filled.cells[7][0], filled.cells[7][1]); },
      [](FilledDomain& filled) { filled.cells[5] = filled.cells[6]; },
      [](FilledDomain& filled) { filled.added[0] = Vec3d(3, 0, 0); },
      [](FilledDomain& filled) { filled.cells[0][3] += 1; },
      [](FilledDomain& filled) { filled.cells[0][3] = filled.cells[1][0]; },
      [](FilledDomain& filled) { filled.cells.clear(); },
  }));
  const Filler wrong = [&](const FillDomain& domain) {
    FilledDomain filled = fill_from_middle(domain);
    spoil(filled);
    return filled;
  };
  CHECK_THROWS_AS(fill(shapes::box({2, 2, 2}, 3, true), -0.2, wrong), FillFailed);
}

TEST_CASE("what cannot be filled is refused before a filler is asked") {
  const Filler none = [](const FillDomain&) -> FilledDomain { throw std::logic_error("was asked"); };
  SECTION("a border that crosses itself") {
    Polygons two = shapes::icosphere(1, 2), other = two;
    const auto first = static_cast<std::uint32_t>(two.positions.size());
    for (const Vec3d& x : other.positions) two.positions.push_back(x + Vec3d(1, 0.3, 0.2));
    for (std::size_t f = 0; f < other.face_count(); ++f) {
      for (const std::uint32_t v : other.view().face(f)) two.corners.push_back(first + v);
      two.close_face();
    }
    CHECK_THROWS_AS(fill(two, 0.05, none), FillFailed);
  }
  SECTION("an opening that is not flat") {
    Polygons bent = tube(24, 6, 3);
    for (Vec3d& x : bent.positions) x[0] += 0.5 * x[1] * x[1] * (x[0] > 2.9 ? 1 : 0);
    CHECK_THROWS_AS(fill(bent, 0.2, none), InvalidInput);
  }
  SECTION("a farfield within the layers") {
    FillOptions options;
    options.farfield.size = 0.5;
    options.farfield.in_lengths = false;
    CHECK_THROWS_AS(fill(shapes::icosphere(1, 2), 0.1, none, options), InvalidInput);
    options.farfield.shape = Farfield::Shape::Given;
    options.farfield.surface = shapes::icosphere(0.5, 2);
    CHECK_THROWS_AS(fill(shapes::icosphere(1, 2), 0.1, none, options), InvalidInput);
    options.farfield.surface = shapes::hemisphere(9, 24, 6);
    CHECK_THROWS_AS(fill(shapes::icosphere(1, 2), 0.1, none, options), InvalidInput);
  }
  SECTION("growth that is none") {
    FillOptions options;
    options.growth = 1;
    CHECK_THROWS_AS(fill(shapes::icosphere(1, 2), 0.1, none, options), InvalidOption);
  }
}

TEST_CASE("walls with faces that are reversed, missing, crossing or doubled give a valid mesh or none") {
  enum Break { Reversed, Missing, Crossing, Doubled, MovedThrough };
  int refused = 0, filled = 0;
  for (const Break how : {Reversed, Missing, Crossing, Doubled, MovedThrough})
    for (std::uint32_t i = 0; i < 10; ++i) {
      const Polygons whole = shapes::box({2, 2, 2}, 4, true);
      const std::uint32_t face = (i * 37 + 5) % static_cast<std::uint32_t>(whole.face_count());
      Polygons wall{whole.positions, {}, {0}};
      for (std::uint32_t f = 0; f < whole.face_count(); ++f) {
        const auto its = whole.view().face(f);
        if (f == face && how == Missing) continue;
        if (f == face && how == Reversed) wall.add_face({its[0], its[2], its[1]});
        else wall.add_face({its[0], its[1], its[2]});
        if (f == face && how == Doubled) wall.add_face({its[1], its[2], its[0]});
      }
      const std::uint32_t corner = whole.view().face(face)[0];
      if (how == MovedThrough) wall.positions[corner] *= -0.8;
      if (how == Crossing) {
        const auto first = static_cast<std::uint32_t>(wall.positions.size());
        for (const Vec3d& by : {Vec3d(0.3, 0.1, 0.2), Vec3d(-0.3, 0.2, -0.1), Vec3d(0.1, -0.3, -0.2)})
          wall.positions.push_back(wall.positions[corner] + by);
        wall.add_face({first, first + 1, first + 2});
      }
      CAPTURE(how, i, face);
      try {
        const Filled made = fill(wall, -0.1, fill_from_middle);
        require_mesh(made.mesh, enclosed_volume(made.mesh));
        ++filled;
      } catch (const InvalidInput&) {
        ++refused;
      } catch (const FillFailed&) {
        ++refused;
      }
    }
  CHECK(refused > 0);
  CHECK(filled > 0);
  CHECK(refused + filled == 50);
}

TEST_CASE("layers on curves are filled in their plane, and made one cell thick") {
  const bool is_inward = GENERATE(true, false);
  Curves circle;
  const int count = 40;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    circle.positions.emplace_back(3 + std::cos(angle), std::sin(angle), 0.5);
    circle.corners.push_back(static_cast<std::uint32_t>(i));
  }
  circle.corners.push_back(0);
  circle.close_face();
  const double sign = is_inward ? -1 : 1;
  const LayersResult layers = grow_curve_layers(circle.view(), std::vector<Distances>{0.1 * sign, 0.2 * sign}, {});
  FillOptions options;
  options.farfield = {.shape = Farfield::Shape::Box, .size = 4};
  FillReport report;
  const VolumeMesh mesh = fill_plane(make_curve_cells(circle.view(), layers), layers, options, &report);
  const double inside = 20 * std::sin(2 * std::numbers::pi / count);
  // The box goes 4 lengths beyond the outer polygon, whose corners are 1.2 / cos(pi / 40) or so away from the middle.
  double size = 0;
  for (const Vec3d& x : mesh.points) size = std::max(size, x[0] - 3);
  require_mesh(mesh, is_inward ? inside : 4 * size * size - inside);
  CHECK(report.triangles > 100);
  CHECK(report.scaled_jacobian.least > 0.5);
  CHECK(mesh.patches.size() == (is_inward ? 1 : 2));
  const VolumeMesh solid = extruded(mesh, 0.25);
  require_mesh(solid, 0.25 * enclosed_volume(mesh));
  REQUIRE(patch_of(solid, "front_and_back") != nullptr);
  CHECK(patch_of(solid, "front_and_back")->face_count() == 2 * mesh.cell_count());
  CHECK(patch_of(solid, "wall")->face_count() == count);
}

TEST_CASE("open curves are not filled") {
  Curves line;
  for (int i = 0; i < 5; ++i) {
    line.positions.emplace_back(i, 0, 0);
    line.corners.push_back(static_cast<std::uint32_t>(i));
  }
  line.close_face();
  const LayersResult layers = grow_curve_layers(line.view(), std::vector<Distances>{0.1}, {});
  CHECK_THROWS_AS(fill_plane(make_curve_cells(line.view(), layers), layers, {}), InvalidInput);
}
