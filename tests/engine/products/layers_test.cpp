// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layers.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "ground/numbers/rounding.h"
#include "products/cells/make_cells.h"
#include "products/layers/growth_columns.h"
#include "products/volume/cell_quality.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// Heights of layers that grow from one to the next.
std::vector<Distances> growing(double first, double growth, std::size_t count) {
  std::vector<Distances> heights;
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) heights.emplace_back(sum += first * std::pow(growth, k));
  return heights;
}

struct Grown {
  LayersResult layers;
  VolumeMesh volume;
  LayerReport report;
};

/// Cells are the same where nothing is known of the mesh's edges and faces, and all has to be looked for.
void check_numbered(const Polygons& mesh, LayersResult layers, const LayerCells& cells) {
  layers.known = {};
  const LayerCells searched = number_cells(mesh.view(), layers);
  CHECK(searched.columns.corners == cells.columns.corners);
  CHECK(searched.columns.open == cells.columns.open);
  CHECK(searched.points.vertex == cells.points.vertex);
  CHECK(searched.facts.role == cells.facts.role);
  CHECK(searched.facts.border_sides == cells.facts.border_sides);
  CHECK(searched.facts.unpaired_sides == cells.facts.unpaired_sides);
}

Grown grow(const Polygons& mesh, std::span<const Distances> heights, const OffsetOptions& options = {}) {
  Grown grown{grow_layers(mesh.view(), heights, options), {}, {}};
  const LayerCells cells = number_cells(mesh.view(), grown.layers);
  check_numbered(mesh, grown.layers, cells);
  const LayerQuality quality = measure_cells(grown.layers, cells);
  grown.volume = make_cells(grown.layers, cells, {}, quality);
  test::check_measured(quality, grown.volume, grown.layers, cells);
  grown.report = report_layers(mesh.view(), grown.layers, {}, cells.facts, quality);
  return grown;
}

/// Every vertex that keeps all of its heights is at each of them, by brute force.
void check_heights(const Polygons& mesh, const LayersResult& layers, std::size_t stride) {
  double worst = 0;
  std::size_t seen = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); v += stride) {
    if (layers.states[v] == VertexState::Unused) continue;
    for (std::size_t k = 0; k < layers.count(); ++k) {
      const double height = layers.share[v] * std::abs(layers.heights[k][v]);
      if (height == 0) continue;
      const double distance = test::brute_force_distance(mesh.view(), layers.stacks.of(v)[k + 1]);
      worst = std::max(worst, std::abs(distance - height) / height);
      ++seen;
    }
  }
  CHECK(seen > 0);
  CHECK(worst < 1e-6);
}

double positive_cells(const VolumeMesh& volume) {
  std::size_t positive = 0;
  for (std::size_t c = 0; c < volume.cell_count(); ++c)
    positive += scaled_jacobian(volume, c) > 0 && cell_volume(volume, c) > 0;
  return static_cast<double>(positive) / static_cast<double>(volume.cell_count());
}

/// Pairs of the boundary's triangles that meet elsewhere than in corners and edges they share, by exact predicates.
/// With none, and positive Jacobians inside, no two cells have a point in common that is not on their faces.
std::size_t boundary_crossings(const VolumeMesh& volume) {
  Polygons boundary;
  boundary.positions = volume.points;
  for (const BoundaryPatch& patch : volume.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      boundary.corners.insert(boundary.corners.end(), patch.face(f).begin(), patch.face(f).end());
      boundary.close_face();
    }
  const Surface surface = build_surface(boundary.view(), {}, Orient::Keep);
  std::vector<Vec3d> positions;
  for (const auto v : surface.representative) positions.push_back(volume.points[v]);
  return CrossingFinder(surface, positions).all().size();
}

/// Vertices of one edge differ in thickness by no more than half of its length.
void check_evenness(const Polygons& mesh, const LayersResult& layers) {
  double worst = 0;
  const auto thickness = [&](std::uint32_t v) { return layers.share[v] * std::abs(layers.heights.back()[v]); };
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
      const double length = (mesh.positions[a] - mesh.positions[b]).length();
      worst = std::max(worst, std::abs(thickness(a) - thickness(b)) / length);
    }
  }
  CHECK(worst < 0.5 + 0.02);  // what is below a hundredth of the thickness becomes none
}

}  // namespace

TEST_CASE("layers: on a plane, heights and volumes are exact", "[layers]") {
  const Polygons mesh = shapes::patch(1, 0, 10);
  const Grown grown = grow(mesh, growing(0.001, 1.2, 10));
  CHECK(grown.report.all.coverage == Approx(1));
  for (std::size_t k = 0; k < 10; ++k)
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3d up = grown.layers.stacks.of(v)[k + 1] - mesh.positions[v];
      CHECK((up - Vec3d(0, 0, grown.layers.heights[k][v])).length() < 1e-9);
    }
  const double thickness = grown.layers.heights.back()[0];
  CHECK(grown.report.volume == Approx(thickness).epsilon(1e-9));
  for (std::size_t c = 0; c < grown.volume.cell_count(); ++c) {
    const std::size_t layer = c / mesh.face_count();
    const double height = 0.001 * std::pow(1.2, layer);
    CHECK(cell_volume(grown.volume, c) == Approx(height / static_cast<double>(mesh.face_count())).epsilon(1e-6));
  }
}

TEST_CASE("layers: corners are round unless miters are asked for", "[layers][miter]") {
  const Polygons cube = shapes::box(Vec3d(1), 3, false);
  const std::vector<Distances> heights = growing(0.02, 1.2, 3);
  OffsetOptions round, mitered;
  round.corners = Corners::Round;
  mitered.corners = Corners::Miter;
  const LayersResult as_grown = grow_layers(cube.view(), heights, {}),
                     of_round = grow_layers(cube.view(), heights, round),
                     of_miters = grow_layers(cube.view(), heights, mitered);
  for (std::size_t k = 1; k <= heights.size(); ++k) {
    const std::vector<Vec3d> positions = as_grown.stacks.surface(k), on_planes = of_miters.stacks.surface(k);
    CHECK(positions == of_round.stacks.surface(k));
    const double height = heights[k - 1][0];
    for (std::size_t v = 0; v < cube.positions.size(); ++v) {
      const Vec3d& from = cube.positions[v];
      CHECK((positions[v] - from).length() == Approx(height));
      for (int i = 0; i < 3; ++i)
        if (std::abs(from[i]) == 0.5) CHECK(std::abs(on_planes[v][i]) == Approx(0.5 + height).epsilon(1e-9));
    }
  }
}

TEST_CASE("layers: on a sphere and in a tube, heights are exact and cells fill what is between", "[layers][oracle]") {
  const auto [mesh, heights] =
      GENERATE(table<Polygons, std::vector<Distances>>({{shapes::icosphere(0.5, 4), growing(0.002, 1.2, 8)},
                                                        {shapes::icosphere(0.5, 3), growing(-0.002, 1.3, 6)},
                                                        {shapes::torus(1, 0.4, 48, 24), growing(0.004, 1.2, 8)}}));
  const Grown grown = grow(mesh, heights);
  CHECK(grown.report.all.coverage == Approx(1));
  CHECK(positive_cells(grown.volume) == 1);
  check_heights(mesh, grown.layers, 23);
  // Between the facets of wall and outermost surface.
  const auto enclosed = [&mesh = mesh](const std::vector<Vec3d>& positions) {
    double sum = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      sum += six_volumes_below(positions, mesh.view().face(f), {}) / 6;
    return sum;
  };
  const double between = enclosed(grown.layers.stacks.surface(grown.layers.count())) - enclosed(mesh.positions);
  CHECK(grown.report.volume == Approx(std::abs(between)).epsilon(1e-9));
}

TEST_CASE("layers: the outermost surface of a cylinder's side has its radius", "[layers]") {
  // Open at both ends: the flat sides of a prism of 64 sides, offset outwards.
  Polygons mesh = shapes::cylinder(0.5, 1, 64, 8, 2);
  Polygons tube;
  tube.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    const bool side = std::all_of(face.begin(), face.end(), [&](std::uint32_t v) {
      return std::hypot(mesh.positions[v][0], mesh.positions[v][1]) > 0.499;
    });
    if (!side) continue;
    tube.corners.insert(tube.corners.end(), face.begin(), face.end());
    tube.close_face();
  }
  const Grown grown = grow(tube, growing(0.005, 1.2, 5));
  CHECK(grown.report.all.coverage == Approx(1));
  const double thickness = grown.layers.heights.back()[0], angle = 2 * std::numbers::pi / 64;
  const double r = 0.5, outer = r + thickness;  // an edge of a convex prism goes straight out
  CHECK(grown.report.volume == Approx(64 * std::sin(angle) / 2 * (outer * outer - r * r)).epsilon(1e-6));
  for (const auto v : tube.corners)
    CHECK(std::hypot(grown.layers.stacks.of(v).back()[0], grown.layers.stacks.of(v).back()[1]) ==
          Approx(outer).epsilon(1e-6));
}

TEST_CASE("layers: quads with straight or reflex corners carry prisms, others hexahedra", "[layers]") {
  Polygons mesh;
  const auto add = [&](const std::vector<Vec3d>& points, const std::vector<std::vector<std::uint32_t>>& faces) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), points.begin(), points.end());
    for (const auto& face : faces) {
      for (const auto v : face) mesh.corners.push_back(first + v);
      mesh.close_face();
    }
  };
  // A dart and the kite that makes a square of it, by each first corner of the dart; then a straight corner.
  for (std::uint32_t k = 0; k < 4; ++k)
    add({{3. * k, 0, 0}, {3. * k + 1, 0, 0}, {3. * k + 0.3, 0.3, 0}, {3. * k, 1, 0}, {3. * k + 1, 1, 0}},
        {{k, (k + 1) % 4, (k + 2) % 4, (k + 3) % 4}, {1, 4, 3, 2}});
  add({{0, -3, 0}, {0.5, -3, 0}, {1, -3, 0}, {0.5, -2, 0}, {0, -4, 0}, {0.5, -4, 0}, {1, -4, 0}},
      {{0, 1, 2, 3}, {4, 5, 1, 0}, {5, 6, 2, 1}});
  for (const double sign : {1.0, -1.0}) {
    const Grown grown = grow(mesh, growing(sign * 0.01, 1.2, 3));
    CHECK(grown.layers.layer_statistics.flat_vertices == 0);
    CHECK(grown.report.all.coverage == Approx(1));
    CHECK(grown.report.all.cells_by_type[static_cast<std::size_t>(CellType::Prism)] == 3 * 2 * 5);
    CHECK(grown.report.all.cells_by_type[static_cast<std::size_t>(CellType::Hexahedron)] == 3 * (4 + 2));
    CHECK(positive_cells(grown.volume) == 1);
    CHECK(grown.volume.patches[0].face_count() == 2 * 5 + 6);
    CHECK(grown.report.volume == Approx((4 + 0.5 + 1) * 0.01 * (1 + 1.2 + 1.44)).epsilon(1e-6));
  }
}

namespace {
struct GrownCase {
  const char* name;
  Polygons mesh;
  double total, least_coverage;
};

void check_grown_cases(const std::vector<GrownCase>& cases) {
  for (const GrownCase& c : cases) {
    INFO(c.name);
    const double first = c.total * 0.2 / (std::pow(1.2, 8) - 1);
    const Grown grown = grow(c.mesh, growing(first, 1.2, 8));
    CHECK(positive_cells(grown.volume) == 1);
    CHECK(grown.report.all.inverted_cells == 0);
    CHECK(grown.report.all.coverage >= c.least_coverage);
    CHECK(grown.layers.statistics.limit.left.total() == 0);
    CHECK(boundary_crossings(grown.volume) == 0);
    check_heights(c.mesh, grown.layers, 37);
    check_evenness(c.mesh, grown.layers);
  }
}
}  // namespace

TEST_CASE("layers: scenes with corners, creases and narrow places have valid cells", "[layers][no_races]") {
  check_grown_cases(
      {{"quads, inward", shapes::box({1, 1, 1}, 12, false), -0.05, 0.97},
       {"wedge", shapes::wedge(40, 1, 1, 16), 0.03, 0.93},  // the first row from the crease has no room for all
       {"plates", shapes::plates(1, 0.1, 0.1, 24), 0.08, 0.3}});
}

TEST_CASE("layers: other scenes with corners, creases and narrow places have valid cells", "[layers][long]") {
  check_grown_cases({{"diffuser", shapes::diffuser(0.4, 0.8, 2, 24), 0.012, 0.97},
                     {"box, outward", shapes::box({1, 1, 1}, 12, true), 0.05, 1},
                     {"box, inward", shapes::box({1, 1, 1}, 12, true), -0.05, 0.97},
                     {"room corner", shapes::room_corner(1, 16), 0.05, 0.97},
                     {"wing", shapes::naca_wing("0012", 1, 0.5, 60, 12), 0.01, 0.97},
                     {"gear", shapes::gear(12, 0.8, 1, 0.3, 0.3, 4), 0.01, 0.97},
                     {"walls", shapes::hollow_box(1, 0.05, 12), -0.04, 0},
                     {"bumps", shapes::bumpy_sphere(1, 0.3, 4, 7, 4), 0.1, 0.8}});
}

TEST_CASE("layers: on random scenes, all cells are valid", "[layers][property][random]") {
  const test::Seeds seeds = test::random_seeds(60);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    INFO("seed " << seed);
    const test::RandomScene scene = test::random_scene(seed);
    const Grown grown = grow(scene.mesh, growing(scene.distance * 0.2 / (std::pow(1.2, 6) - 1), 1.2, 6));
    CHECK(grown.report.all.inverted_cells == 0);
    CHECK(grown.layers.statistics.limit.left.total() == 0);
    check_evenness(scene.mesh, grown.layers);
  }
}

TEST_CASE("layers: a hexahedron that is inside out in its middle alone is not valid", "[layers]") {
  Polygons mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.add_face({0, 1, 2, 3});
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.5);
  const ClosestQuery query(surface);
  const ConstrainedSurface constrained{query, surface, {}, {}, {}};
  std::vector<Vec3d> source;
  for (const auto v : surface.representative) source.push_back(mesh.positions[v]);
  const GrowthColumns columns(mesh.view(), constrained, source);
  REQUIRE(columns.size() == 1);
  const bool turned = GENERATE(false, true);  // by half a turn, as all corners still see the other base above them
  VertexStacks stacks(4, 1);
  for (std::uint32_t v = 0; v < 4; ++v) {
    stacks.of(v)[0] = source[v];
    stacks.of(v)[1] = Vec3d(0, 0, 1) + source[v] * (turned ? -1.0 : 1.0);
  }
  CHECK(columns.is_valid(0, stacks, 1) == !turned);
}

TEST_CASE("layers: those of two plates stop before each other", "[layers]") {
  const Polygons mesh = shapes::plates(1, 0.1, 0.1, 24);
  const Grown grown = grow(mesh, growing(0.005, 1.2, 8));  // 0.082 in all, in a gap of 0.1
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double wall = mesh.positions[v][2], outer = grown.layers.stacks.of(v).back()[2];
    if (std::abs(wall) < 0.051) CHECK(wall * outer > 0);
  }
  CHECK(grown.layers.layer_statistics.thinned_vertices > 0);
  // What is told of vertices that were held back is so of the layers as they ended.
  const LimitStatistics& limit = grown.layers.statistics.limit;
  const auto& states = grown.layers.states;
  CHECK(limit.limited_vertices > 0);
  CHECK(limit.limited_vertices ==
        static_cast<std::size_t>(std::count(states.begin(), states.end(), VertexState::Limited)));
  CHECK(limit.thickness_lost > 0);
  CHECK(limit.thickness_lost < 1);
}

TEST_CASE("layers: distances and the gap to obstacles are those of the surfaces as written", "[layers]") {
  const Polygons mesh = shapes::icosphere(1, 2);
  Polygons above;
  above.positions = {{-3, -3, 1.2}, {3, -3, 1.2}, {3, 3, 1.2}, {-3, 3, 1.2}};
  above.add_face({0, 1, 2, 3});
  OffsetOptions options;
  options.obstacles = above.view();
  options.precision = {.kind = Precision::Kind::Digits, .digits = 3};
  const LayersResult layers = grow_layers(mesh.view(), growing(0.0333, 1.2, 2), options);
  double highest = 0, most_off = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto positions = layers.stacks.of(v);
    CHECK(positions[0] == mesh.positions[v]);
    for (const std::size_t k : {1, 2}) CHECK(positions[k] == Rounding(options.precision)(positions[k]));
    CHECK(layers.first_achieved[v] == Approx(test::brute_force_distance(mesh.view(), positions[1])).epsilon(1e-9));
    CHECK(layers.achieved[v] == Approx(test::brute_force_distance(mesh.view(), positions[2])).epsilon(1e-9));
    most_off = std::max(most_off, std::abs(layers.first_achieved[v] - 0.0333) / 0.0333);
    highest = std::max(highest, positions[2][2]);
  }
  CHECK(most_off > 1e-3);  // three digits are few
  REQUIRE(layers.statistics.obstacles);
  CHECK(layers.statistics.obstacles->gap == Approx(1.2 - highest).epsilon(1e-9));
}

TEST_CASE("layers: copies of a vertex that disagree at one height alone are counted", "[layers]") {
  const Polygons mesh = test::torn(shapes::icosphere(1, 1));
  std::vector<double> first(mesh.positions.size(), 0.01);
  first[0] = 0.02;
  const std::vector<Distances> heights = {Distances(first), Distances(0.05)};
  const auto others = std::count(mesh.positions.begin(), mesh.positions.end(), mesh.positions[0]) - 1;
  REQUIRE(others > 0);
  // Those that are not asked what the first one is.
  CHECK(grow_layers(mesh.view(), heights, {}).statistics.disagreeing_distances == static_cast<std::size_t>(others));
  CHECK(grow_layers(mesh.view(), growing(0.01, 1.2, 2), {}).statistics.disagreeing_distances == 0);
}

TEST_CASE("layers: a vertex that no way up suits keeps none, and cells close around it", "[layers]") {
  // Two tetrahedra that meet in a point, like an hour-glass: its middle sees no side of all faces.
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {-1, 1, -1}, {-1, -1, -1}};
  for (const auto& face : {std::initializer_list<std::uint32_t>{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}})
    mesh.add_face(face);
  for (const auto& face : {std::initializer_list<std::uint32_t>{0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}})
    mesh.add_face(face);
  const Grown grown = grow(mesh, growing(0.01, 1.2, 4));
  CHECK(grown.layers.share[0] == 0);
  CHECK(grown.layers.layer_statistics.flat_vertices >= 1);
  CHECK(grown.report.all.transition_cells > 0);
  CHECK(positive_cells(grown.volume) == 1);
}

TEST_CASE("layers: on a part of a box whose edge slides, the sides stay flat", "[layers]") {
  const Polygons mesh = shapes::box({1, 1, 1}, 10, true);
  OffsetOptions options;
  options.only.resize(mesh.face_count());
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    options.only[f] =
        std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return mesh.positions[v][2] > 0.499; });
  }
  options.border = GENERATE(Border::Slide, Border::Free, Border::Fixed);
  const std::vector<Distances> heights = growing(0.004, 1.2, 5);
  const Grown grown = grow(mesh, heights, options);
  CHECK(positive_cells(grown.volume) == 1);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d& wall = mesh.positions[v];
    const Vec3d& outer = grown.layers.stacks.of(v).back();
    if (wall[2] < 0.499) CHECK(outer == wall);
    for (int k = 0; k < 2; ++k)
      if (std::abs(wall[k]) == 0.5) CHECK(outer[k] == wall[k]);
  }
  if (options.border != Border::Fixed) CHECK(grown.report.all.coverage == Approx(1));
  if (options.border != Border::Fixed) CHECK(grown.report.volume == Approx(heights.back()[0]).epsilon(1e-6));
}

TEST_CASE("layers: where the edge of a part slides on a bent surface, all layers end on that", "[layers][oracle]") {
  // A bowl, part of a sphere, with a flat lid, from which layers grow down into it. Rings from the lid's middle on.
  constexpr std::uint32_t kAround = 64, kLid = 8, kSide = 24;
  Polygons bowl, lid;
  OffsetOptions options;
  const auto add = [&](std::uint32_t ring, std::initializer_list<std::uint32_t> face) {
    bowl.add_face(face);
    if (ring < kLid) lid.add_face(face);
    options.only.push_back(ring < kLid);
  };
  const double top = 0.3, lid_radius = std::sqrt(1 - top * top);
  bowl.positions.emplace_back(0, 0, top);
  for (std::uint32_t ring = 0; ring < kLid + kSide; ++ring) {
    const double z = ring < kLid ? top : top - (ring + 1 - kLid) * 1.2 / kSide;
    const double radius = ring < kLid ? lid_radius * (ring + 1) / kLid : std::sqrt(1 - z * z);
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      bowl.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
      const std::uint32_t next = (k + 1) % kAround, base = 1 + ring * kAround, below = base - kAround;
      if (ring == 0) add(ring, {0, base + k, base + next});
      else add(ring, {below + k, base + k, base + next, below + next});
    }
  }
  bowl.positions.emplace_back(0, 0, -1);
  const std::uint32_t bottom = (kLid + kSide) * kAround + 1, last = bottom - kAround;
  for (std::uint32_t k = 0; k < kAround; ++k) add(kLid, {last + k, bottom, last + (k + 1) % kAround});

  const Grown grown = grow(bowl, growing(-0.015, 1.2, 6), options);  // over three rings of the side
  CHECK(positive_cells(grown.volume) == 1);
  CHECK(grown.report.all.coverage == Approx(1));
  lid.positions = bowl.positions;
  check_heights(lid, grown.layers, 7);
  double off_side = 0, off_chord = 0;
  for (std::size_t v = 1 + (kLid - 1) * kAround; v < 1 + kLid * kAround; ++v)
    for (std::size_t k = 1; k <= grown.layers.count(); ++k) {
      const Vec3d &x = grown.layers.stacks.of(v)[k], &wall = bowl.positions[v];
      const Vec3d chord = grown.layers.stacks.of(v).back() - wall;
      off_side = std::max(off_side, test::brute_force_distance(bowl.view(), x));
      off_chord = std::max(off_chord, chord.cross(x - wall).length() / chord.length());
    }
  CHECK(off_side < 1e-9);
  CHECK(off_chord > 1e-3);
}

TEST_CASE("layers: what rests at the edge of a part is in the way of what rises under it", "[layers][no_races]") {
  // A floor, and from one edge of it a wall that leans over it.
  constexpr std::uint32_t kLong = 80, kWide = 32;
  constexpr double kSteepness = 0.3;
  Polygons mesh;
  for (std::uint32_t i = 0; i <= kLong; ++i)
    for (std::uint32_t j = 0; j <= kWide; ++j) mesh.positions.emplace_back(i / 80.0, j / 32.0, 0);
  for (std::uint32_t j = 0; j <= kWide; ++j) mesh.positions.emplace_back(0.5, j / 32.0, 0.5 * kSteepness);
  const std::uint32_t row = kWide + 1, wall = (kLong + 1) * row;
  OffsetOptions options;
  for (std::uint32_t i = 0; i < kLong; ++i)
    for (std::uint32_t j = 0; j < kWide; ++j) {
      mesh.add_face({i * row + j, (i + 1) * row + j, (i + 1) * row + j + 1, i * row + j + 1});
      options.only.push_back(1);
    }
  for (std::uint32_t j = 0; j < kWide; ++j) {
    mesh.add_face({j + 1, wall + j + 1, wall + j, j});
    options.only.push_back(0);
  }
  const Grown grown = grow(mesh, growing(0.02, 1.2, 4), options);
  CHECK(positive_cells(grown.volume) == 1);
  std::size_t high = 0;
  for (std::uint32_t v = 0; v < wall; ++v) {
    const Vec3d& x = grown.layers.stacks.of(v).back();
    if (x[0] < 0.5) CHECK(x[2] <= kSteepness * x[0] + 1e-9);
    high += x[2] > 0.1;
  }
  CHECK(high > 40 * row);
}

TEST_CASE("layers: heights may differ from vertex to vertex", "[layers][oracle]") {
  const Polygons mesh = shapes::icosphere(0.5, 4);
  std::vector<Distances> heights;
  for (const double factor : {0.2, 0.5, 1.0}) {
    std::vector<double> each;
    for (const Vec3d& p : mesh.positions) each.push_back(factor * 0.03 * std::max(0.0, 0.5 + p[2]));
    heights.emplace_back(std::move(each));
  }
  const Grown grown = grow(mesh, heights);
  CHECK(positive_cells(grown.volume) == 1);
  check_heights(mesh, grown.layers, 31);
}

TEST_CASE("layers: the same for any number of threads", "[layers]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 4, 7, 4);
  OffsetOptions one;
  one.threads = 1;
  const auto heights = growing(0.01, 1.2, 6);
  const LayersResult a = grow_layers(mesh.view(), heights, one), b = grow_layers(mesh.view(), heights, {});
  for (std::size_t k = 0; k <= a.count(); ++k) CHECK(a.stacks.surface(k) == b.stacks.surface(k));
  CHECK(a.share == b.share);
}

TEST_CASE("layers: heights that do not rise or are of both signs are refused", "[layers]") {
  const Polygons mesh = shapes::icosphere(0.5, 2);
  const auto refused = [&](std::vector<Distances> heights, const std::string& why) {
    CHECK_THROWS_WITH(grow_layers(mesh.view(), heights, {}), Catch::Contains(why));
  };
  refused({}, "expected a height, got none");
  refused({0.1, 0.1}, "expected heights that rise");
  refused({0.1, -0.2}, "expected heights that rise");
  std::vector<double> both(mesh.positions.size(), 0.1);
  both[3] = -0.1;
  refused({Distances(both)}, "to one side");
  refused({0.0}, "other than 0");
}

TEST_CASE("layers: a grid of quads gives a structured block", "[layers]") {
  const bool closed = GENERATE(false, true);
  const Polygons mesh = closed ? shapes::torus(1, 0.4, 24, 12) : shapes::patch(1, 0.05, 12);
  const double sign = GENERATE(1, -1);
  const LayersResult layers = grow_layers(mesh.view(), growing(sign * 0.005, 1.2, 4), {});
  const StructuredBlock block = make_block(mesh.view(), layers);
  CHECK(block.nk == 5);
  CHECK(std::minmax(block.ni, block.nj) == (closed ? std::minmax(25u, 13u) : std::minmax(13u, 13u)));
  const auto at = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return block.points[(k * block.nj + j) * block.ni + i];
  };
  std::size_t wrong = 0;
  for (std::uint32_t k = 0; k + 1 < block.nk; ++k)
    for (std::uint32_t j = 0; j + 1 < block.nj; ++j)
      for (std::uint32_t i = 0; i + 1 < block.ni; ++i) {
        const Vec3d p = at(i, j, k);
        wrong += !((at(i + 1, j, k) - p).cross(at(i, j + 1, k) - p).dot(at(i, j, k + 1) - p) > 0);
      }
  CHECK(wrong == 0);
  CHECK_THROWS_AS(make_block(shapes::icosphere(1, 1).view(), layers), InvalidInput);
}

TEST_CASE("layers: polygons that repeat each other are told, wherever they begin", "[layers]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.corners = {0, 1, 2, 3, 3, 2, 1, 0};
  mesh.face_begin = {0, 4, 8};
  const Grown grown = grow(mesh, growing(0.01, 1.2, 3));
  CHECK(grown.report.all.faces_by_role[static_cast<std::size_t>(FaceRole::Repeated)] == 1);
}
