// SPDX-License-Identifier: Apache-2.0
#include "products/cells/make_cells.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "products/volume/cell_faces.h"
#include "products/volume/cell_quality.h"
#include "products/volume/prism_quality_columns.h"
#include "support/oracles.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

using Face = std::vector<std::uint32_t>;

/// Layers along a direction for each vertex, which need not be of unit length.
LayersResult layers_along(const Polygons& mesh, const std::vector<Vec3d>& directions,
                          const std::vector<double>& heights, std::vector<double> share = {}) {
  LayersResult layers;
  share.resize(mesh.positions.size(), 1);
  layers.share = share;
  VertexStacks stacks(mesh.positions.size(), heights.size());
  std::vector<std::uint32_t> own(mesh.positions.size());
  std::iota(own.begin(), own.end(), 0);
  for (std::size_t v = 0; v < share.size(); ++v) {
    const auto stack = stacks.of(v);
    stack[0] = mesh.positions[v];
    for (std::size_t k = 0; k < heights.size(); ++k)
      stack[k + 1] = mesh.positions[v] + share[v] * heights[k] * directions[v];
  }
  layers.stacks = {std::move(stacks), std::move(own)};
  layers.welded_to = weld_by_position(mesh.view(), {});
  for (const double height : heights) layers.heights.emplace_back(height);
  layers.states.assign(share.size(), VertexState::Reached);
  for (const double s : share) {
    layers.achieved.push_back(heights.empty() ? 0 : s * std::abs(heights.back()));
    layers.first_achieved.push_back(heights.empty() ? 0 : s * std::abs(heights.front()));
  }
  return layers;
}

LayersResult layers_up(const Polygons& mesh, const std::vector<double>& heights, std::vector<double> share = {}) {
  return layers_along(mesh, std::vector<Vec3d>(mesh.positions.size(), Vec3d(0, 0, 1)), heights, std::move(share));
}

/// A face's cycle of corners, which does not depend on its first corner.
Face rotated(std::span<const std::uint32_t> face) {
  Face cycle(face.begin(), face.end());
  std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
  return cycle;
}
Face reversed(const Face& face) { return rotated(Face(face.rbegin(), face.rend())); }

/// Faces that are not shared by two cells of opposite views, nor in one patch with their cell.
std::size_t unmatched_faces(const VolumeMesh& volume) {
  std::map<Face, std::uint32_t> seen;  // face and its cell, without those that another cell has seen from its side
  std::size_t wrong = 0;
  for (std::uint32_t c = 0; c < volume.cell_count(); ++c)
    for_each_cell_face(volume.cell_types[c], volume.cell(c), [&](std::span<const std::uint32_t> corners) {
      const Face face = rotated(corners);
      if (seen.erase(reversed(face)) == 0) wrong += !seen.emplace(face, c).second;
    });
  for (const BoundaryPatch& patch : volume.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto found = seen.find(rotated(patch.face(f)));
      if (found != seen.end() && found->second == patch.cell[f]) seen.erase(found);
      else ++wrong;
    }
  return wrong + seen.size();
}

double sum_of_cells(const VolumeMesh& volume) {
  double sum = 0;
  for (std::size_t c = 0; c < volume.cell_count(); ++c) sum += cell_volume(volume, c);
  return sum;
}

/// Faces match, all cells have a positive volume, and these sum up to what the patches enclose.
void check_cells(const VolumeMesh& volume) {
  CHECK(unmatched_faces(volume) == 0);
  std::size_t inverted = 0, used = 0;
  std::vector<std::uint8_t> in_cell(volume.points.size(), 0);
  for (std::size_t c = 0; c < volume.cell_count(); ++c) {
    inverted += !(cell_volume(volume, c) > 0);
    for_each_cell_face(volume.cell_types[c], volume.cell(c), [&](std::span<const std::uint32_t> face) {
      for (const auto p : face) in_cell[p] = 1;
    });
  }
  for (const auto u : in_cell) used += u;
  CHECK(inverted == 0);
  CHECK(used == volume.points.size());
  CHECK(sum_of_cells(volume) == Approx(enclosed_volume(volume)).epsilon(1e-11));
  for (const auto* fields : {&volume.point_fields, &volume.cell_fields})
    for (const VolumeField& field : *fields)
      CHECK(field.values.size() == (fields == &volume.cell_fields ? volume.cell_count() : volume.points.size()));
}

/// Checks the cells of layers, and that cells that are only numbered are measured like those that are made.
void check_cells(const Polygons& mesh, const LayersResult& layers) {
  const LayerCells cells = number_cells(mesh.view(), layers);
  const LayerQuality quality = measure_cells(layers, cells);
  const VolumeMesh volume = make_cells(layers, cells, {}, quality);
  check_cells(volume);
  test::check_measured(quality, volume, layers, cells);
}

std::size_t count(const VolumeMesh& volume, CellType type) {
  return static_cast<std::size_t>(std::count(volume.cell_types.begin(), volume.cell_types.end(), type));
}

const VolumeField& field(const std::vector<VolumeField>& fields, const std::string& name) {
  return *std::find_if(fields.begin(), fields.end(), [&](const VolumeField& f) { return f.name == name; });
}

/// A unit square of n x n quads, each of them split into two triangles if asked for.
Polygons grid(std::uint32_t n, bool triangles) {
  Polygons mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) mesh.positions.emplace_back(double(i) / n, double(j) / n, 0);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      if (!triangles) mesh.add_face({a, b, c, d});
      else mesh.add_face({a, b, c}), mesh.add_face({a, c, d});
    }
  return mesh;
}

/// A honeycomb: all faces have six corners.
Polygons honeycomb(std::uint32_t n) {
  Polygons mesh;
  std::map<std::pair<int, int>, std::uint32_t> at;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      constexpr int kCorner[6][2] = {{0, -2}, {1, -1}, {1, 1}, {0, 2}, {-1, 1}, {-1, -1}};
      const int x = static_cast<int>(2 * i + j % 2), y = static_cast<int>(3 * j);
      for (const auto& [dx, dy] : kCorner) {
        const std::pair key(x + dx, y + dy);
        const auto [known, added] = at.try_emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
        if (added) mesh.positions.emplace_back(key.first * std::numbers::sqrt3 / 2, key.second / 2.0, 0);
        mesh.corners.push_back(known->second);
      }
      mesh.close_face();
    }
  return mesh;
}

/// A cube of side 2 around the origin whose faces are n x n quads; corners of each face are its own.
Polygons seamed_cube(std::uint32_t n) {
  const Polygons side = grid(n, false);
  Polygons mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {-1, 1}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const Vec3d& p : side.positions) {
        Vec3d x(0.0);
        x[axis] = sign;
        x[(axis + 1) % 3] = 2 * p[0] - 1;
        x[(axis + 2) % 3] = sign * (2 * p[1] - 1);
        mesh.positions.push_back(x);
      }
      for (std::size_t f = 0; f < side.face_count(); ++f) {
        for (const auto v : side.view().face(f)) mesh.corners.push_back(first + v);
        mesh.close_face();
      }
    }
  return mesh;
}

std::vector<double> random_share(const Polygons& mesh, unsigned seed, double flat) {
  // By position, so that copies of a vertex agree.
  std::vector<double> share;
  for (const Vec3d& p : mesh.positions) {
    std::mt19937 random(seed + static_cast<unsigned>(std::lround(1e4 * (p[0] + 3 * p[1] + 7 * p[2]) + 1e6)));
    random.discard(3);
    share.push_back(std::uniform_real_distribution<>()(random) < flat ? 0 : 1);
  }
  return share;
}

/// A single cell over points, with the corners in their order.
VolumeMesh single(CellType type, std::vector<Vec3d> points) {
  VolumeMesh mesh;
  mesh.points = std::move(points);
  for (std::uint32_t k = 0; k < mesh.points.size(); ++k) mesh.corners.push_back(k);
  mesh.cell_types = {type};
  mesh.cell_begin.push_back(mesh.corners.size());
  return mesh;
}

}  // namespace

TEST_CASE("layer cells: a plane of triangles, by numbers", "[layer_cells]") {
  const Polygons mesh = grid(4, true);
  LayerCellFacts facts;
  const VolumeMesh volume = make_cells(mesh.view(), layers_up(mesh, {0.5, 1.25}), {}, &facts);
  check_cells(volume);
  CHECK(volume.points.size() == 75);
  CHECK(count(volume, CellType::Prism) == 64);
  for (std::size_t c = 0; c < 64; ++c)
    CHECK(cell_volume(volume, c) == Approx((c < 32 ? 0.5 : 0.75) / 32).epsilon(1e-12));
  REQUIRE(volume.patches.size() == 6);
  CHECK(volume.patches[0].name == "wall");
  CHECK(volume.patches[0].face_count() == 32);
  CHECK(volume.patches[1].name == "outer");
  CHECK(volume.patches[1].kind == BoundaryPatch::Kind::Outer);
  CHECK(volume.patches[1].face_count() == 32);
  // Each side of the square is a patch of its own.
  for (std::size_t i = 0; i < 4; ++i) {
    const BoundaryPatch& side = volume.patches[2 + i];
    CHECK(side.name == "sides_" + std::to_string(i + 1));
    CHECK(side.kind == BoundaryPatch::Kind::Side);
    CHECK(side.face_count() == 8);
    const PatchFacts facts_of_side = patch_facts(volume)[2 + i];
    CHECK(facts_of_side.faces == 8);
    REQUIRE(facts_of_side.plane);
    for (const auto p : side.corners) CHECK(facts_of_side.plane->height(volume.points[p]) == 0);
  }
  CHECK(facts.border_sides == 16);
  CHECK(facts.unpaired_sides == 0);
  CHECK(field(volume.cell_fields, "layer").values[32] == 2);
  CHECK(field(volume.cell_fields, "face").values[33] == 1);
  CHECK(field(volume.point_fields, "layer").values[25] == 1);
  CHECK(field(volume.point_fields, "height").values[50] == 1.25F);
  CHECK(field(volume.point_fields, "achieved").values[0] == 0);
  CHECK(field(volume.point_fields, "achieved").values[25] == 0.5F);
  CHECK(field(volume.point_fields, "achieved").values[50] == 1.25F);
}

TEST_CASE("layer cells: seams of a cube are one, and mitered cells fill what is between", "[layer_cells]") {
  const Polygons mesh = seamed_cube(4);  // a power of 2, so that copies agree in all bits
  std::vector<Vec3d> directions = mesh.positions;
  for (Vec3d& d : directions)
    for (int k = 0; k < 3; ++k) d[k] = std::abs(d[k]) == 1 ? d[k] : 0;
  for (const double sign : {1.0, -1.0}) {
    const VolumeMesh volume = make_cells(mesh.view(), layers_along(mesh, directions, {0.1 * sign, 0.3 * sign}), {});
    check_cells(volume);
    CHECK(volume.points.size() == 3 * 98);
    CHECK(count(volume, CellType::Hexahedron) == 2 * 96);
    CHECK(volume.patches.size() == 2);
    CHECK(enclosed_volume(volume) == Approx(sign * (std::pow(2 + 0.6 * sign, 3) - 8)).epsilon(1e-12));
  }
}

TEST_CASE("layer cells: a cylinder's wall, by its closed form", "[layer_cells]") {
  Polygons mesh;
  std::vector<Vec3d> directions;
  constexpr std::uint32_t kSides = 12;
  for (std::uint32_t i = 0; i < kSides; ++i)
    for (const int z : {0, 1}) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      directions.emplace_back(std::cos(angle), std::sin(angle), 0);
      mesh.positions.emplace_back(directions.back() + Vec3d(0, 0, z));
    }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    mesh.add_face({a, b, b + 1, a + 1});
  }
  const VolumeMesh volume = make_cells(mesh.view(), layers_along(mesh, directions, {0.25}), {});
  check_cells(volume);
  for (std::size_t c = 0; c < kSides; ++c)
    CHECK(cell_volume(volume, c) ==
          Approx((1.25 * 1.25 - 1) / 2 * std::sin(2 * std::numbers::pi / kSides)).epsilon(1e-12));
}

TEST_CASE("layer cells: each pattern of flat corners in a quad or triangle matches its neighbours", "[layer_cells]") {
  const std::map<int, std::vector<CellType>> of_quad = {{0, {CellType::Hexahedron}},
                                                        {1, {CellType::Pyramid, CellType::Pyramid}},
                                                        {2, {CellType::Prism}},
                                                        {5, {CellType::Tetrahedron, CellType::Tetrahedron}},
                                                        {3, {CellType::Tetrahedron, CellType::Tetrahedron}},
                                                        {4, {}}};
  const std::map<int, std::vector<CellType>> of_triangle = {
      {0, {CellType::Prism}}, {1, {CellType::Pyramid}}, {2, {CellType::Tetrahedron}}, {3, {}}};
  for (const bool triangles : {false, true})
    for (const double sign : {1.0, -1.0})
      for (unsigned pattern = 0; pattern < (triangles ? 8 : 16); ++pattern) {
        const Polygons mesh = grid(3, triangles);
        const std::size_t middle = triangles ? 8 : 4;
        const auto face = mesh.view().face(middle);
        std::vector<double> share(mesh.positions.size(), 1);
        int flats = 0;
        for (std::size_t k = 0; k < face.size(); ++k)
          if ((pattern >> k & 1) != 0) share[face[k]] = 0, ++flats;
        const VolumeMesh volume = make_cells(mesh.view(), layers_up(mesh, {0.1 * sign, 0.2 * sign}, share), {});
        INFO("pattern " << pattern << " sign " << sign << " triangles " << triangles);
        check_cells(volume);
        std::vector<CellType> types;
        for (std::size_t c = 0; c < volume.cell_count(); ++c)
          if (field(volume.cell_fields, "face").values[c] == static_cast<float>(middle) &&
              field(volume.cell_fields, "layer").values[c] == 2)
            types.push_back(volume.cell_types[c]);
        const bool opposite = !triangles && (pattern == 5 || pattern == 10);
        CHECK(types == (triangles ? of_triangle : of_quad).at(opposite ? 5 : flats));
      }
}

TEST_CASE("layer cells: flat vertices anywhere leave a closed, matching mesh", "[layer_cells]") {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const double sign : {1.0, -1.0})
      for (const double flat : {0.2, 0.6}) {
        const std::vector<double> heights = {0.01 * sign, 0.03 * sign, 0.06 * sign};
        for (const Polygons& mesh : {grid(7, false), grid(7, true), honeycomb(5)})
          check_cells(mesh, layers_up(mesh, heights, random_share(mesh, seed, flat)));
        const Polygons cube = seamed_cube(4);
        check_cells(cube, layers_along(cube, cube.positions, heights, random_share(cube, seed, flat)));
        const Polygons ball = test::torn(shapes::icosphere(1, 2));
        check_cells(ball, layers_along(ball, ball.positions, heights, random_share(ball, seed, flat)));
      }
}

TEST_CASE("layer cells: polygons become polyhedra", "[layer_cells]") {
  const Polygons mesh = honeycomb(3);
  const VolumeMesh volume = make_cells(mesh.view(), layers_up(mesh, {0.5, 1}), {});
  check_cells(volume);
  CHECK(count(volume, CellType::Polyhedron) == 18);
  const double hexagon = 1.5 * std::numbers::sqrt3;
  CHECK(cell_volume(volume, 9) == Approx(hexagon / 2).epsilon(1e-12));
  // Edges of length 1 on hexagons, of 1/2 up.
  CHECK(aspect_ratio(volume, 0) == Approx(2).epsilon(1e-12));
  CHECK(scaled_jacobian(volume, 0) == Approx(std::sin(std::numbers::pi / 3)).epsilon(1e-12));
}

TEST_CASE("layer cells: what carries nothing, repeats or folds up gives no cells, and its edge is a side",
          "[layer_cells]") {
  Polygons mesh = grid(2, false);
  mesh.add_face({0, 3, 4, 1});  // the first from its back
  mesh.add_face({1, 2, 2});     // a line
  mesh.add_face({2, 5, 5, 4});  // a triangle, on another quad
  mesh.positions.emplace_back(9, 9, 9);
  LayersResult layers = layers_up(mesh, {1});
  layers.carries = {1, 0, 1, 1, 1, 1, 0};
  LayerCellFacts facts;
  const VolumeMesh volume = make_cells(mesh.view(), layers, {}, &facts);
  check_cells(volume);
  CHECK(facts.role == std::vector<FaceRole>{FaceRole::Full, FaceRole::Bare, FaceRole::Full, FaceRole::Full,
                                            FaceRole::Repeated, FaceRole::Degenerate, FaceRole::Bare});
  CHECK(volume.points.size() == 16);  // not the far corner of the bare quad, nor the vertex in no face
  std::size_t sides = 0;
  for (const BoundaryPatch& patch : volume.patches)
    if (patch.kind == BoundaryPatch::Kind::Side) sides += patch.face_count();
  CHECK(sides == 8);
  layers.carries = {0, 0, 0, 0, 0, 0, 1};
  const VolumeMesh triangle = make_cells(mesh.view(), layers, {});
  check_cells(triangle);
  CHECK(triangle.cell_types == std::vector{CellType::Prism});
}

TEST_CASE("layer cells: on edges of three faces, and where faces disagree, what cannot be paired is a side",
          "[layer_cells]") {
  Polygons mesh = grid(2, false);
  const auto fin = static_cast<std::uint32_t>(mesh.positions.size());
  for (const std::uint32_t v : {1, 4, 7}) mesh.positions.push_back(mesh.positions[v] + Vec3d(0.3, 0, 0.5));
  mesh.add_face({1, 4, fin + 1, fin});
  mesh.add_face({4, 7, fin + 2, fin + 1});
  LayerCellFacts facts;
  const LayersResult layers =
      layers_along(mesh, std::vector<Vec3d>(mesh.positions.size(), Vec3d(-1, 0, 1)), {0.1, 0.2});
  check_cells(make_cells(mesh.view(), layers, {}, &facts));
  CHECK(facts.unpaired_sides == 2);
  CHECK(facts.split_points == 3);
  CHECK(facts.coincident_sides == 0);

  Polygons turned = grid(2, true);
  std::reverse(turned.corners.begin() + 3, turned.corners.begin() + 6);
  check_cells(make_cells(turned.view(), layers_up(turned, {0.1, 0.2}), {}, &facts));
  CHECK(facts.turned_faces == 1);
  CHECK(facts.unpaired_sides == 0);
}

TEST_CASE("layer cells: walls have the names of their faces", "[layer_cells]") {
  const Polygons mesh = grid(2, false);
  const WallNames names{{"a b", "outer", "a_b", "7", "none"}, {0, 1, 2, 3}};
  const VolumeMesh volume = make_cells(mesh.view(), layers_up(mesh, {1, 2}), names);
  check_cells(volume);
  REQUIRE(volume.patches.size() == 10);
  CHECK(volume.patches[0].name == "a_b");
  CHECK(volume.patches[1].name == "outer_2");
  CHECK(volume.patches[2].name == "a_b_2");
  CHECK(volume.patches[3].name == "wall_7");
  CHECK(volume.patches[4].face_count() == 0);
  for (std::uint32_t p = 0; p < 4; ++p) CHECK(volume.patches[p].cell == std::vector{p});
  CHECK(field(volume.cell_fields, "patch").values == std::vector<float>{0, 1, 2, 3, 0, 1, 2, 3});
}

TEST_CASE("layer cells: the same for any number of threads", "[layer_cells]") {
  const Polygons mesh = shapes::icosphere(1, 4);
  const LayersResult layers = layers_along(mesh, mesh.positions, {0.1, 0.2, 0.4}, random_share(mesh, 1, 0.1));
  const VolumeMesh volume = make_cells(mesh.view(), layers, {});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const VolumeMesh same = make_cells(mesh.view(), layers, {});
  CHECK(volume.points == same.points);
  CHECK(volume.cell_types == same.cell_types);
  CHECK(volume.corners == same.corners);
  CHECK(volume.cell_begin == same.cell_begin);
  for (std::size_t i = 0; i < same.cell_fields.size(); ++i)
    CHECK(volume.cell_fields[i].values == same.cell_fields[i].values);
  CHECK(enclosed_volume(volume) == enclosed_volume(same));
}

TEST_CASE("layer cells: without layers, there are none", "[layer_cells]") {
  const Polygons mesh = grid(2, false);
  LayerCellFacts facts;
  const VolumeMesh volume = make_cells(mesh.view(), layers_up(mesh, {}), {}, &facts);
  CHECK(volume.cell_count() == 0);
  CHECK(std::count(facts.role.begin(), facts.role.end(), FaceRole::Flat) == 4);
}

TEST_CASE("layer cells: layers of another mesh are refused", "[layer_cells]") {
  const Polygons mesh = grid(2, false);
  LayersResult layers = layers_up(mesh, {1});
  CHECK_THROWS_AS(make_cells(mesh.view(), layers, {{"a"}, {0, 0, 0, 1}}), InvalidInput);
  LayersResult nowhere = layers;
  nowhere.welded_to[4] = kNone;
  CHECK_THROWS_WITH(make_cells(mesh.view(), nowhere, {}), Catch::Contains("that lack welded vertices of its corners"));
  layers.share.pop_back();
  CHECK_THROWS_WITH(make_cells(mesh.view(), layers, {}), "layers: expected 9 shares, got 8");
}

TEST_CASE("cell quality: cells of known quality", "[cell_quality]") {
  const double h = std::numbers::sqrt3 / 2;
  const VolumeMesh cube = single(
      CellType::Hexahedron, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  CHECK(scaled_jacobian(cube, 0) == Approx(1).epsilon(1e-14));
  CHECK(aspect_ratio(cube, 0) == 1);
  CHECK(cell_volume(cube, 0) == Approx(1).epsilon(1e-14));

  const VolumeMesh prism =
      single(CellType::Prism, {{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0, 0, 2}, {1, 0, 2}, {0.5, h, 2}});
  CHECK(scaled_jacobian(prism, 0) == Approx(1).epsilon(1e-14));
  CHECK(aspect_ratio(prism, 0) == Approx(2).epsilon(1e-14));
  CHECK(cell_volume(prism, 0) == Approx(h).epsilon(1e-14));
  // Sheared by 45 degrees: the edges up are sqrt 2 long.
  const VolumeMesh sheared =
      single(CellType::Prism, {{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {1, 0, 1}, {2, 0, 1}, {1.5, h, 1}});
  CHECK(scaled_jacobian(sheared, 0) == Approx(1 / std::numbers::sqrt2).epsilon(1e-14));

  const VolumeMesh regular = single(CellType::Tetrahedron, {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}});
  CHECK(std::abs(scaled_jacobian(regular, 0)) == Approx(1).epsilon(1e-14));
  // Of the corners of edges 1, 1, sqrt 2 ... the worst is 1 / (sqrt 2 sqrt 2 1).
  const VolumeMesh right = single(CellType::Tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  CHECK(scaled_jacobian(right, 0) == Approx(1 / std::numbers::sqrt2).epsilon(1e-14));
  CHECK(aspect_ratio(right, 0) == Approx(std::numbers::sqrt2).epsilon(1e-14));
  CHECK(cell_volume(right, 0) == Approx(1.0 / 6).epsilon(1e-14));
  const VolumeMesh inverted = single(CellType::Tetrahedron, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}});
  CHECK(scaled_jacobian(inverted, 0) == Approx(-1 / std::numbers::sqrt2).epsilon(1e-14));
  CHECK(cell_volume(inverted, 0) < 0);

  const VolumeMesh pyramid =
      single(CellType::Pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1 / std::numbers::sqrt2}});
  CHECK(scaled_jacobian(pyramid, 0) == Approx(1).epsilon(1e-14));
  CHECK(cell_volume(pyramid, 0) == Approx(1 / std::numbers::sqrt2 / 3).epsilon(1e-14));
  const VolumeMesh flat = single(CellType::Pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}});
  CHECK(scaled_jacobian(flat, 0) == 0);
}

TEST_CASE("cell quality: a hexahedron that is twisted shows at its principal axes or corners", "[cell_quality]") {
  std::vector<Vec3d> points;
  for (const double z : {0.0, 1.0})
    for (const double k : {0.0, 1.0, 2.0, 3.0}) {
      const double angle = std::numbers::pi / 2 * k + std::numbers::pi / 6 * z;
      points.emplace_back(std::cos(angle), std::sin(angle), z);
    }
  const VolumeMesh twisted = single(CellType::Hexahedron, points);
  // Each corner's edges: two of sqrt 2 at a right angle in the plane; the third goes up by 1 and aside.
  const double up = 1 / std::sqrt(1 + 2 - 2 * std::cos(std::numbers::pi / 6));
  CHECK(scaled_jacobian(twisted, 0) == Approx(up).epsilon(1e-14));
}

TEST_CASE("cell quality: the angle at the wall", "[cell_quality]") {
  const std::vector<Vec3d> wall = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<Vec3d> first = wall;
  for (Vec3d& p : first) p += Vec3d(0.1 * std::tan(std::numbers::pi / 180), 0, -0.1);
  CHECK(wall_angle(wall, first) == Approx(1).epsilon(1e-12));
  CHECK(wall_angle(wall, wall) == 90);
}

TEST_CASE("prism columns: four at once and pairs give the same bits", "[cell_quality]") {
  constexpr std::size_t kLayers = 3, kInLayer = 7;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  const Vec3d origin(any(random), any(random), any(random));
  std::vector<Vec3d> stacks(3 * PrismQualityColumns::kCount * (kLayers + 1));
  struct Found {
    std::vector<float> jacobian = std::vector<float>(kLayers * kInLayer, -2), aspect = jacobian, angle = jacobian;
    SixVolumes six_volumes{};
    bool operator==(const Found&) const = default;
  };
  for (int trial = 0; trial < 1000; ++trial) {
    for (Vec3d& position : stacks)
      for (int i = 0; i < 3; ++i) position[i] = trial % 4 == 0 ? std::round(any(random)) : any(random);
    Found found[2];
    for (const bool pairs : {false, true}) {
      Found& to = found[pairs];
      PrismQualityColumns columns{.layers = kLayers,
                                  .in_layer = kInLayer,
                                  .scaled_jacobian = to.jacobian.data() + 1,
                                  .aspect_ratio = to.aspect.data() + 1,
                                  .wall_angle = to.angle.data() + 1,
                                  .origin = origin.asPointer()};
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < PrismQualityColumns::kCount; ++i)
          columns.stack[k][i] = stacks[(i * 3 + k) * (kLayers + 1)].asPointer();
      to.six_volumes = pairs ? measure_prism_pairs(columns) : measure_prism_columns(columns);
    }
    REQUIRE(found[0] == found[1]);
    CHECK(found[0].jacobian[kInLayer] == -2);
    CHECK(found[0].jacobian[PrismQualityColumns::kCount] >= -2 / std::numbers::sqrt3);
  }
}

TEST_CASE("layer report: quantiles by area are those of sorted faces, whatever their order", "[layer_report]") {
  const Polygons mesh = grid(60, false);
  LayersResult layers = layers_up(mesh, {0.25, 0.5}, std::vector<double>(mesh.positions.size(), 1));
  const auto count = static_cast<double>(layers.achieved.size());
  for (const int shape : {0, 1, 2}) {
    for (std::size_t v = 0; v < layers.achieved.size(); ++v) {
      const double at = static_cast<double>(v) / count;
      layers.achieved[v] = shape == 0   ? std::sin(std::numbers::pi * at)
                           : shape == 1 ? std::abs(at - 0.5)
                                        : std::floor(3 * at);
    }
    const LayerCells cells = number_cells(mesh.view(), layers);
    const Spread reached =
        report_layers(mesh.view(), layers, {}, cells.facts, measure_cells(layers, cells)).all.reached;
    std::vector<double> sorted;
    for (std::size_t f = 0; f < mesh.view().face_count(); ++f) {
      double mean = 0;
      for (const auto v : mesh.view().face(f)) mean += layers.achieved[v] / 4;
      sorted.push_back(mean);
    }
    std::sort(sorted.begin(), sorted.end());
    const auto quantile = [&](double share) {
      return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size()))];
    };
    // Sums of areas are rounded: a face more or less.
    constexpr double kOneFace = 4e-3;
    CHECK(reached.least == Approx(sorted.front()));
    CHECK(reached.quantile_01 == Approx(quantile(0.01)).margin(kOneFace));
    CHECK(reached.quantile_05 == Approx(quantile(0.05)).margin(kOneFace));
    CHECK(reached.median == Approx(quantile(0.5)).margin(kOneFace));
    CHECK(reached.quantile_95 == Approx(quantile(0.95)).margin(kOneFace));
    CHECK(reached.quantile_99 == Approx(quantile(0.99)).margin(kOneFace));
    CHECK(reached.most == Approx(sorted.back()));
  }
}

TEST_CASE("layer report: figures of each patch and of all", "[layer_report]") {
  Polygons mesh = grid(4, false);
  std::vector<double> share(mesh.positions.size(), 1);
  share[0] = 0;
  share[1] = 0.5;
  LayersResult layers = layers_up(mesh, {0.25, 0.5}, share);
  layers.states[1] = VertexState::Limited;
  layers.first_achieved[24] = 0.25 * 1.5;
  const WallNames names{{"front", "back"}, {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1}};
  const LayerCells cells = number_cells(mesh.view(), layers);
  const LayerQuality quality = measure_cells(layers, cells);
  const VolumeMesh volume = make_cells(layers, cells, names, quality);
  check_cells(volume);
  const LayerReport report = report_layers(mesh.view(), layers, names, cells.facts, quality);
  CHECK(report.layers == 2);
  CHECK(report.volume == Approx(sum_of_cells(volume)).epsilon(1e-12));
  CHECK(report.all.area == Approx(1));
  CHECK(report.all.cells == 34);
  CHECK(report.all.transition_cells == 4);
  CHECK(report.all.inverted_cells == 0);
  REQUIRE(report.patches.size() == 2);
  const LayerFigures &front = report.patches[0], &back = report.patches[1];
  CHECK(front.name == "front");
  CHECK(front.cells_by_type[static_cast<std::size_t>(CellType::Pyramid)] == 4);
  CHECK(front.cells_by_type[static_cast<std::size_t>(CellType::Hexahedron)] == 14);
  CHECK(front.faces_by_role[static_cast<std::size_t>(FaceRole::Transition)] == 1);
  CHECK(front.coverage == Approx(6.0 / 8));
  CHECK(front.layers_reached == Approx(2 * (6 + 2.5 / 4 + 3.5 / 4) / 8));
  CHECK(front.reached.least == Approx(0.5 * 2.5 / 4));
  CHECK(front.reached.most == 0.5);
  CHECK(front.first_error == 0);
  CHECK(back.coverage == 1);
  CHECK(back.layers_reached == 2);
  CHECK(back.reached.mean == Approx(0.5));
  CHECK(back.first_error == Approx(0.5));
  CHECK(back.full_vertices == 15);
  CHECK(back.scaled_jacobian.least == Approx(1));
  CHECK(back.aspect_ratio.median == Approx(1));
  CHECK(back.wall_angle.most == Approx(0).margin(1e-12));

  RunFacts run;
  run.layers = report;
  const auto json = nlohmann::json::parse(report_json(layers, run));
  CHECK(json["distance"] == 0.5);
  CHECK(json["achieved"]["vertices"] == 25);
  CHECK(json["layers"]["count"] == 2);
  CHECK(json["layers"]["cells_by_type"][name(CellType::Pyramid)] == 4);
  CHECK(json["layers"]["patches"][1]["name"] == "back");
  CHECK(json["layers"]["patches"][1]["first_height"]["worst_error"] == Approx(0.5));
  CHECK_THAT(summary(report), Catch::Contains("2 layers: ") && Catch::Contains("4 transition cells"));
}
