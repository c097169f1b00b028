// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "products/cells/make_cells.h"
#include "products/cells/measure_cells.h"
#include "products/volume/cell_quality.h"
#include "products/volume/volume_faces.h"
#include "support/oracles.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// Heights of as many layers, each as thick.
std::vector<Distances> even_heights(double total, std::size_t count) {
  std::vector<Distances> heights;
  for (std::size_t k = 1; k <= count; ++k)
    heights.emplace_back(total * static_cast<double>(k) / static_cast<double>(count));
  return heights;
}

struct FannedMesh {
  FannedLayers fanned;
  Polygons wall;
  VolumeMesh volume;
  LayerReport report;

  std::size_t cells_of(CellType type) const { return report.all.cells_by_type[static_cast<std::size_t>(type)]; }
};

/// Grows layers with fans, and requires what holds of all: cells meet face to face, all are valid, and what was
/// measured before they were made is what they have; vertices that keep their heights are at them.
FannedMesh grow_fans(const Polygons& mesh, std::span<const Distances> heights, double angle = 60,
                     CellRules rules = CellRules::AnySolver, const OffsetOptions& options = {}) {
  FannedMesh grown{grow_fanned_layers(mesh.view(), heights, options, angle, rules), {}, {}, {}};
  const LayersResult& layers = grown.fanned.layers;
  grown.wall = grown.fanned.wall ? grown.fanned.wall->polygons : mesh;
  const LayerCells cells = number_cells(grown.wall.view(), layers);
  const LayerQuality quality = measure_cells(layers, cells);
  grown.volume = make_cells(layers, cells, {}, quality);
  test::check_measured(quality, grown.volume, layers, cells);
  grown.report = report_layers(grown.wall.view(), layers, {}, cells.facts, quality);
  CHECK_NOTHROW(VolumeFaces(grown.volume));
  CHECK(grown.report.all.inverted_cells == 0);
  for (std::size_t c = 0; c < grown.volume.cell_count(); ++c) REQUIRE(cell_volume(grown.volume, c) > 0);
  std::vector<std::uint8_t> is_used(grown.volume.points.size(), 0);
  for (const std::uint32_t corner : grown.volume.corners)
    if (corner < is_used.size()) is_used[corner] = 1;  // of polyhedra there are counts as well
  CHECK(std::count(is_used.begin(), is_used.end(), 0) == 0);
  for (std::size_t v = 0; v < grown.wall.positions.size(); ++v) {
    const auto stack = layers.stacks.of(v);
    REQUIRE(stack[0] == grown.wall.positions[v]);
    for (std::size_t k = 1; k < stack.size() && layers.share[v] == 1; ++k) {
      const double height = std::abs(heights[k - 1][v < mesh.positions.size() ? v : 0]);
      REQUIRE(test::brute_force_distance(mesh.view(), stack[k]) == Approx(height).epsilon(1e-6));
    }
  }
  return grown;
}

/// A roof over the unit square's double: its ridge runs along y, and bends by less and less from one end to the other.
Polygons fading_roof(std::uint32_t divisions) {
  Polygons mesh;
  const auto at = [&](std::uint32_t i) { return 2.0 * i / divisions - 1; };
  for (std::uint32_t j = 0; j <= divisions; ++j)
    for (std::uint32_t i = 0; i <= divisions; ++i)
      mesh.positions.emplace_back(at(i), at(j), -std::abs(at(i)) * (0.65 - 0.4 * at(j)));
  const std::uint32_t row = divisions + 1;
  for (std::uint32_t j = 0; j < divisions; ++j)
    for (std::uint32_t i = 0; i < divisions; ++i) {
      const std::uint32_t p = j * row + i;
      if ((i + j) % 2 == 0) {
        mesh.add_face({p, p + 1, p + row + 1, p + row});
      } else {
        mesh.add_face({p, p + 1, p + row + 1});
        mesh.add_face({p, p + row + 1, p + row});
      }
    }
  return mesh;
}

/// The walls of a duct whose section is an L of three unit squares, open at both ends.
Polygons l_duct() {
  Polygons mesh;
  const double outline[][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh.positions.emplace_back(x, y, z);
  for (std::uint32_t i = 0; i < 6; ++i) mesh.add_face({i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6});
  return mesh;
}

std::size_t count_short_fans(const LayersResult& layers) {
  return static_cast<std::size_t>(std::count_if(layers.states.begin(), layers.states.end(), falls_short));
}

}  // namespace

TEST_CASE("fanned layers: a cube's edges get prisms along them, its corners tetrahedra") {
  const Polygons cube = shapes::box(Vec3d(1), 1, false);
  const std::vector<Distances> heights = even_heights(0.3, 3);
  const FannedMesh grown = grow_fans(cube, heights);
  REQUIRE(grown.fanned.wall);
  const Refinement& wall = *grown.fanned.wall;
  // Two columns over each edge, and six over each corner: a loop of six directions around its middle.
  CHECK(wall.over_ridges == 12 * 2 + 8 * 6);
  CHECK(wall.over_corners == 8 * 6);
  CHECK(grown.cells_of(CellType::Tetrahedron) == 8 * 6);
  CHECK(grown.cells_of(CellType::Prism) == 12 * 2 + 2 * 8 * 6);
  CHECK(grown.cells_of(CellType::Hexahedron) == 3 * 6 + 2 * 12 * 2);
  CHECK(grown.report.all.fan_cells == 3 * (12 * 2 + 8 * 6));
  CHECK(grown.report.all.needles == 0);  // faces of fans have no area on the wall
  CHECK(grown.report.all.coverage == 1);
  CHECK(grown.report.all.faces_by_role[static_cast<std::size_t>(FaceRole::Full)] == 6);
  CHECK(grown.report.all.wall_angle.most < 1e-6);
  // Figures of the mesh are those of the one that was given.
  const OffsetStatistics& statistics = grown.fanned.layers.statistics;
  CHECK(statistics.facts.vertices == 8);
  CHECK(statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)] == 8);
  // The cube's faces come first, in their order, and their layers are parallel to them.
  for (std::size_t f = 0; f < 6; ++f) {
    CHECK(wall.parent[f] == f);
    for (std::size_t k = 0; k < 4; ++k)
      CHECK(grown.wall.positions[wall.polygons.view().face(f)[k]] == cube.positions[cube.view().face(f)[k]]);
  }
  const double kPi = std::numbers::pi, whole = 6 * 0.3 + 3 * kPi * 0.09 + 4 * kPi / 3 * 0.027;
  CHECK(grown.report.volume == Approx(whole).epsilon(0.05));
  CHECK(grown.report.volume < whole);
  CHECK(grow_fans(cube, heights, 15).report.volume == Approx(whole).epsilon(0.005));
  // The wall's patch has the cube's faces alone.
  CHECK(grown.volume.patches.front().face_count() == 6);
}

TEST_CASE("fanned layers: without a sharp convex edge there are no fans, and layers are those without") {
  const Polygons sphere = shapes::icosphere(1, 3), cube = shapes::box(Vec3d(1), 2, true);
  for (const auto& [mesh, total] : {std::pair(sphere, 0.2), std::pair(cube, -0.2)}) {
    const FannedLayers fanned = grow_fanned_layers(mesh.view(), even_heights(total, 2), {}, 60);
    CHECK(!fanned.wall);
    const LayersResult plain = grow_layers(mesh.view(), even_heights(total, 2), {});
    for (std::size_t k = 0; k <= 2; ++k) CHECK(fanned.layers.stacks.surface(k) == plain.stacks.surface(k));
  }
  CHECK(!grow_fanned_layers(cube.view(), even_heights(0.2, 2), {}, 0).wall);
  CHECK(!grow_fanned_layers(cube.view(), even_heights(0.2, 2), {}, 91).wall);
}

TEST_CASE("fanned layers: in a duct it is the edge that stands out into it which has a fan") {
  const FannedMesh grown = grow_fans(l_duct(), even_heights(-0.2, 4));
  REQUIRE(grown.fanned.wall);
  CHECK(count_short_fans(grown.fanned.layers) == 0);
  CHECK(grown.fanned.wall->parent == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 2, 2});  // two faces over that edge
}

TEST_CASE("fanned layers: a fan ends in a point where its edge is no longer sharp") {
  const std::uint32_t divisions = 32;
  const Polygons roof = fading_roof(divisions);
  for (const CellRules rules : {CellRules::AnySolver, CellRules::OpenFoam}) {
    const FannedMesh grown = grow_fans(roof, even_heights(0.05, 3), 60, rules);
    REQUIRE(grown.fanned.wall);
    CHECK(count_short_fans(grown.fanned.layers) == 0);
    CHECK(grown.fanned.wall->over_corners == 0);
    CHECK(grown.fanned.wall->over_ridges > 0);
    CHECK(grown.fanned.wall->over_ridges < divisions * 2);
    // Two cells around a point in the middle, of a quad on one side and of a triangle or a quad on the other.
    CHECK(grown.cells_of(CellType::Pyramid) >= 2 + 5);
    // The pyramids are flat, as the layer is thin.
    CHECK(grown.report.all.scaled_jacobian.least > 1e-3);
    CHECK(grown.report.all.poor_cells <= 16);
  }
  // A ridge that is short for an end of it has no fan, as the noise of scans.
  CHECK(!grow_fanned_layers(fading_roof(8).view(), even_heights(0.05, 3), {}, 60).wall);
}

TEST_CASE("fanned layers: a fan that ends on a border stays in the border's plane") {
  Polygons whole = shapes::box(Vec3d(1), 2, false);
  Polygons open;
  open.positions = whole.positions;
  double lowest = 0;
  for (const Vec3d& x : whole.positions) lowest = std::min(lowest, x[2]);
  for (std::size_t f = 0; f < whole.face_count(); ++f) {
    const auto face = whole.view().face(f);
    if (std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return whole.positions[v][2] == lowest; }))
      continue;
    open.corners.insert(open.corners.end(), face.begin(), face.end());
    open.close_face();
  }
  const FannedMesh grown = grow_fans(open, even_heights(0.2, 2));
  REQUIRE(grown.fanned.wall);
  CHECK(count_short_fans(grown.fanned.layers) == 0);
  std::size_t in_plane = 0;
  for (const BoundaryPatch& patch : grown.volume.patches)
    if (patch.kind == BoundaryPatch::Kind::Side)
      for (const std::uint32_t p : patch.corners) {
        REQUIRE(grown.volume.points[p][2] == lowest);
        ++in_plane;
      }
  // Two quads a side in both layers, and two faces a fan.
  CHECK(in_plane == 4 * 2 * 2 * 4 + 4 * 2 * (3 + 4));
}

TEST_CASE("fanned layers: a wing's trailing edge and tips have room for all heights") {
  const Polygons wing = shapes::naca_wing("2412", 1, 1, 40, 8);
  const FannedMesh grown = grow_fans(wing, even_heights(0.04, 5));
  REQUIRE(grown.fanned.wall);
  CHECK(count_short_fans(grown.fanned.layers) == 0);
  CHECK(grown.report.all.scaled_jacobian.least > 0.05);
  // Without fans the faces beside the edges tilt.
  const LayersResult plain = grow_layers(wing.view(), even_heights(0.04, 5), {});
  CHECK(grown.fanned.layers.statistics.faces.mean < 0.5 * plain.statistics.faces.mean);
}

TEST_CASE("fanned layers: uneven heights, names of walls, and the same bytes for any number of threads") {
  const Polygons cube = shapes::box(Vec3d(1), 3, true);
  std::vector<Distances> heights;
  for (const double share : {0.5, 1.0}) {
    std::vector<double> each;
    for (const Vec3d& x : cube.positions) each.push_back(share * (0.1 + 0.05 * x[0]));
    heights.emplace_back(std::move(each));
  }
  OffsetOptions one, two;
  one.threads = 1, two.threads = 2;
  const FannedLayers first = grow_fanned_layers(cube.view(), heights, one, 45),
                     second = grow_fanned_layers(cube.view(), heights, two, 45);
  REQUIRE((first.wall && second.wall));
  CHECK(first.wall->polygons.corners == second.wall->polygons.corners);
  for (std::size_t k = 0; k <= 2; ++k) CHECK(first.layers.stacks.surface(k) == second.layers.stacks.surface(k));
  CHECK(count_short_fans(first.layers) == 0);
  const auto& stacks = first.layers.stacks;
  for (std::size_t v = 0; v < stacks.vertices(); ++v) {
    const std::uint32_t foot = first.layers.foot[v];
    CHECK(stacks.of(v)[0] == stacks.of(foot)[0]);
    CHECK(first.layers.heights[1][v] == Approx(0.1 + 0.05 * stacks.of(v)[0][0]).epsilon(1e-12));
    CHECK(test::brute_force_distance(cube.view(), stacks.of(v)[2]) <= first.layers.heights[1][v] * (1 + 1e-6));
  }
  WallNames names{{"rest", "top"}, {}};
  for (std::size_t f = 0; f < cube.face_count(); ++f) {
    const auto face = cube.view().face(f);
    names.of_face.push_back(
        std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return cube.positions[v][2] > 0.4; }));
  }
  const WallNames of_wall = names_of_pieces(names, *first.wall);
  const VolumeMesh volume = make_cells(first.wall->polygons.view(), first.layers, of_wall);
  REQUIRE(volume.patches.size() == 3);
  CHECK(volume.patches[1].name == "top");
  CHECK(volume.patches[1].face_count() == 2 * 3 * 3);
}

TEST_CASE("fanned layers: angles that no fan can have are refused") {
  const Polygons cube = shapes::box(Vec3d(1), 1, false);
  for (const double angle : {-1.0, 4.9, 181.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(grow_fanned_layers(cube.view(), even_heights(0.1, 1), {}, angle), InvalidInput);
}
