// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>

#include "products/cells/make_cells.h"
#include "products/volume/cell_quality.h"
#include "products/volume/foam_measures.h"
#include "products/volume/polygon_prism.h"
#include "support/volume_meshes.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A mesh's faces, some of which have been joined with a neighbour, again and again: polygons of up to `most` corners,
/// as concave and bent as may be.
Polygons joined(const Polygons& mesh, std::size_t joins, std::size_t most, std::mt19937& random) {
  std::vector<CornerList> faces;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    faces.emplace_back(mesh.view().face(f).begin(), mesh.view().face(f).end());
  for (; joins > 0; --joins) {
    const std::size_t i = random() % faces.size(), k = random() % faces[i].size();
    const std::uint32_t a = faces[i][k], b = faces[i][(k + 1) % faces[i].size()];
    const auto follows = [&](const CornerList& face) {
      const auto at = std::find(face.begin(), face.end(), b);
      return at != face.end() && face[static_cast<std::size_t>(at + 1 - face.begin()) % face.size()] == a;
    };
    const auto other = std::find_if(faces.begin(), faces.end(), follows);
    if (other == faces.end() || faces[i].size() + other->size() - 2 > most) continue;
    CornerList ring = faces[i], rest = *other;
    std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), b), ring.end());
    std::rotate(rest.begin(), std::find(rest.begin(), rest.end(), a), rest.end());
    ring.insert(ring.end(), rest.begin() + 1, rest.end() - 1);
    if (std::set(ring.begin(), ring.end()).size() < ring.size()) continue;
    faces[i] = ring;
    faces.erase(other);
  }
  Polygons result;
  result.positions = mesh.positions;
  for (const CornerList& face : faces) {
    result.corners.insert(result.corners.end(), face.begin(), face.end());
    result.close_face();
  }
  return result;
}

double uniform(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

/// A square of triangles whose points have been moved within it, and out of it by so much.
Polygons uneven_square(double aside, double out, std::mt19937& random) {
  Polygons mesh;
  constexpr std::uint32_t kCells = 7;
  for (std::uint32_t j = 0; j <= kCells; ++j)
    for (std::uint32_t i = 0; i <= kCells; ++i) {
      const double u = uniform(random) - 0.5, v = uniform(random) - 0.5, w = uniform(random) - 0.5;
      mesh.positions.emplace_back((i + aside * u) / kCells, (j + aside * v) / kCells, out * w / kCells);
    }
  for (std::uint32_t j = 0; j < kCells; ++j)
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t a = j * (kCells + 1) + i, b = a + 1, d = a + kCells + 1, c = d + 1;
      if ((i + j) % 2 == 0) mesh.add_face({a, b, c}), mesh.add_face({a, c, d});
      else mesh.add_face({a, b, d}), mesh.add_face({b, c, d});
    }
  return mesh;
}

struct GrownCells {
  LayersResult layers;
  VolumeMesh volume;
  LayerReport report;
};
GrownCells grow_cells(const Polygons& mesh, double thickness, CellRules rules) {
  const std::vector<Distances> heights = {thickness * 0.3, thickness * 0.6, thickness};
  GrownCells grown{grow_layers(mesh.view(), heights, {}, rules), {}, {}};
  const LayerCells cells = number_cells(mesh.view(), grown.layers);
  LayerQuality quality = measure_cells(grown.layers, cells);
  grown.report = report_layers(mesh.view(), grown.layers, {}, cells.facts, quality);
  grown.volume = make_cells(grown.layers, cells, {}, std::move(quality));
  return grown;
}

void check_cells_valid(const GrownCells& grown, CellRules rules) {
  CHECK(grown.report.all.inverted_cells == 0);
  std::size_t wrong = 0, unseen = 0;
  for (std::size_t c = 0; c < grown.volume.cell_count(); ++c) {
    wrong += !(scaled_jacobian(grown.volume, c) > 0) || !(cell_volume(grown.volume, c) > 0);
    unseen += !has_foam_pyramids(grown.volume, c);
  }
  CHECK(wrong == 0);
  if (rules == CellRules::OpenFoam) CHECK(unseen == 0);
}

PolygonPrism prism_over(const std::vector<std::pair<double, double>>& base,
                        const std::vector<std::pair<double, double>>& top, double height) {
  PolygonPrism prism;
  for (const auto& [x, y] : base) prism.below.emplace_back(x, y, 0);
  for (const auto& [x, y] : top) prism.above.emplace_back(x, y, height);
  prism.flat.assign(base.size(), 0);
  return prism;
}

}  // namespace

TEST_CASE("polygon prism: right ones are valid over any polygon, inverted ones over none", "[polygon_prism]") {
  const std::vector<std::pair<double, double>> hexagon = {{2, 0}, {1, 1.7}, {-1, 1.7}, {-2, 0}, {-1, -1.7}, {1, -1.7}};
  const std::vector<std::pair<double, double>> l_shape = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const std::vector<std::pair<double, double>> hanging = {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}};  // a straight corner
  for (const auto& base : {hexagon, l_shape, hanging}) {
    CHECK(scaled_jacobian(prism_over(base, base, 1)) > 0.8);
    CHECK(scaled_jacobian(prism_over(base, base, -1)) < 0);
    CHECK(scaled_jacobian(prism_over(base, base, 0)) == 0);
  }
  // All corners of a right angle.
  CHECK(scaled_jacobian(prism_over(l_shape, l_shape, 2)) == Approx(1));
  // A corner that turns outwards below and inwards above is none of either.
  auto bent = hanging;
  bent[1].second = -0.1;
  auto notched = hanging;
  notched[1].second = 0.1;
  CHECK(scaled_jacobian(prism_over(bent, notched, 1)) > 0.8);
  // The notch goes through the other side.
  notched[1].second = 2.1;
  CHECK(scaled_jacobian(prism_over(hanging, notched, 1)) <= 0);
  // Many corners: as few ones.
  std::vector<std::pair<double, double>> circle;
  for (int k = 0; k < 100; ++k) circle.emplace_back(std::cos(k * 0.0628), std::sin(k * 0.0628));
  CHECK(scaled_jacobian(prism_over(circle, circle, 1)) > 0);
  CHECK(scaled_jacobian(prism_over(circle, circle, -1)) < 0);
}

TEST_CASE("layers: concave, bent and straight-cornered polygons carry valid cells or none",
          "[layers][polygons][no_races]") {
  for (unsigned seed = 0; seed < 24; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    random.discard(10);
    const std::size_t most = 4 + random() % 5;
    const Polygons mesh = seed % 3 == 0   ? joined(shapes::icosphere(0.5, 2), 200, most, random)
                          : seed % 3 == 1 ? joined(uneven_square(0, 0, random), 100, most, random)
                                          : joined(uneven_square(0.6, 0.5, random), 100, most, random);
    const CellRules rules = seed % 2 == 0 ? CellRules::AnySolver : CellRules::OpenFoam;
    const GrownCells grown = grow_cells(mesh, seed % 4 < 2 ? 0.04 : -0.04, rules);
    check_cells_valid(grown, rules);
    const bool flat = seed % 3 == 1;
    if (flat && rules == CellRules::AnySolver &&
        grown.layers.statistics.limit.source_crossings == 0)  // no fan is folded
      CHECK(grown.report.all.coverage == Approx(1));
  }
}

TEST_CASE("layers: cells of slivers and of nearly repeated points are valid", "[layers][polygons]") {
  for (unsigned seed = 0; seed < 12; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random(seed + 100);
    random.discard(10);
    Polygons mesh = joined(uneven_square(0.3, 0.3, random), 60, 5, random);
    for (int i = 0; i < 4; ++i) {
      const auto face = mesh.view().face(random() % mesh.face_count());
      const Vec3d to = mesh.positions[face[1]];
      mesh.positions[face[0]] = to + (mesh.positions[face[0]] - to) * (seed % 2 == 0 ? 1e-7 : 1e-3);
    }
    const CellRules rules = seed % 3 == 0 ? CellRules::OpenFoam : CellRules::AnySolver;
    check_cells_valid(grow_cells(mesh, 0.03, rules), rules);
  }
}

TEST_CASE("layers: a block's cells without height, and those that bend inwards, are told", "[layers]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  mesh.add_face({0, 1, 4, 3});
  mesh.add_face({4, 1, 2, 5});  // from the corner that will bend inwards: its fan is not folded then
  const std::vector<Distances> heights = {0.1, 0.2};
  CHECK(inverted_cells(make_block(mesh.view(), grow_layers(mesh.view(), heights, {}))) == 0);
  mesh.positions[4] = {1.6, 0.3, 0};  // the second is a dart
  CHECK(inverted_cells(make_block(mesh.view(), grow_layers(mesh.view(), heights, {}))) == 2);
}
