// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/oracles.h"
#include "support/solids.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

std::vector<Distances> even(double total, int count) {
  std::vector<Distances> heights;
  for (int k = 1; k <= count; ++k) heights.emplace_back(total * k / count);
  return heights;
}

/// The shortest edge of the outermost layer, by that of the wall.
double least_edge(const Polygons& mesh, const LayersResult& layers) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
      const double length = (layers.stacks.of(a).back() - layers.stacks.of(b).back()).length();
      least = std::min(least, length / (mesh.positions[a] - mesh.positions[b]).length());
    }
  }
  return least;
}

void require_spread(const Polygons& mesh, double total, double least_jacobian) {
  const std::vector<Distances> heights = even(total, 6);
  const LayersResult layers = grow_layers(mesh.view(), heights, {});
  CHECK(std::ranges::all_of(layers.share, [](double share) { return share == 1; }));
  CHECK(least_edge(mesh, layers) >= 0.2);
  CHECK(layers.layer_statistics.crowded_vertices == 0);
  CHECK(layers.layer_statistics.least_edge == 1);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    for (std::size_t k = 1; k <= heights.size(); ++k)
      CHECK(test::brute_force_distance(mesh.view(), layers.stacks.of(v)[k]) ==
            Approx(std::abs(heights[k - 1][v])).epsilon(1e-6));
  const Surface surface = build_surface(mesh.view(), {}, Orient::Keep);
  std::vector<Vec3d> front;
  for (const auto v : surface.representative) front.push_back(layers.stacks.of(v).back());
  CHECK(CrossingFinder(surface, front).all().empty());
  LayerCellFacts facts;
  const VolumeMesh cells = make_cells(mesh.view(), layers, {}, &facts);
  const auto jacobian = std::ranges::find(cells.cell_fields, "scaled_jacobian", &VolumeField::name);
  REQUIRE(jacobian != cells.cell_fields.end());
  CHECK(*std::ranges::min_element(jacobian->values) > least_jacobian);
}

}  // namespace

TEST_CASE("spread ends: over a concave edge, edges keep a fifth of the wall's", "[layers]") {
  // Three spacings, and far more.
  const auto total = GENERATE(0.05, 0.12, 0.3, 0.5, -0.1, -0.12, -0.2);
  require_spread(test::l_tube(10), total, 0.5);
}

TEST_CASE("spread ends: in concave corners, vertices of edges stay on them", "[layers]") {
  const auto total = GENERATE(-0.2, -0.4);
  const Polygons box = shapes::box({2, 2, 2}, 12, false);
  require_spread(box, total, 0.1);
  const LayersResult layers = grow_layers(box.view(), even(total, 6), {});
  // An edge of the box is where two coordinates are 1; the layers' edge is at 1 - |total|. Paths that are not crowded
  // end a little off it.
  for (std::size_t v = 0; v < box.positions.size(); ++v) {
    const Vec3d &x = box.positions[v], &to = layers.stacks.of(v).back();
    int on_faces = 0;
    for (int k = 0; k < 3; ++k) on_faces += std::abs(x[k]) == 1;
    for (int k = 0; k < 3; ++k)
      if (on_faces > 1 && std::abs(x[k]) == 1)
        CHECK(std::abs(to[k]) == Approx(1 + total).margin(0.03 * std::abs(total)));
  }
}

TEST_CASE("spread ends: the wall's right angles stay in the lower third", "[layers]") {
  const Polygons mesh = test::l_tube(10);
  const LayersResult layers = grow_layers(mesh.view(), even(0.3, 12), {});
  // Over the flat faces at the concave edge, whose normals are x and y.
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d& x = mesh.positions[v];
    const bool over_y = x[1] == 1 && x[0] > 1 && x[0] < 2, over_x = x[0] == 1 && x[1] > 1 && x[1] < 2;
    if (!over_x && !over_y) continue;
    Vec3d way = layers.stacks.of(v)[4] - x;
    way.normalize();
    CHECK(way[over_y ? 1 : 0] > std::cos(0.6));
    way = layers.stacks.of(v)[1] - x;
    way.normalize();
    CHECK(way[over_y ? 1 : 0] > std::cos(0.2));
  }
}

TEST_CASE("spread ends: where all shrinks alike, vertices stay where their paths led", "[layers]") {
  // Inside of a ball and of a pipe, edges get as short as the rest.
  const Polygons ball = shapes::icosphere(1, 3);
  const LayersResult layers = grow_layers(ball.view(), even(-0.9, 3), {});
  for (std::uint32_t v = 0; v < ball.positions.size(); ++v)
    CHECK((layers.stacks.of(v).back() - ball.positions[v] * 0.1).length() < 0.02);
  CHECK(layers.layer_statistics.crowded_vertices == 0);
}

TEST_CASE("spread ends: the same for any number of threads", "[layers]") {
  const Polygons mesh = test::l_tube(10);
  OffsetOptions one, two;
  one.threads = 1, two.threads = 2;
  const LayersResult a = grow_layers(mesh.view(), even(0.3, 4), one), b = grow_layers(mesh.view(), even(0.3, 4), two);
  CHECK(a.stacks.surface(4) == b.stacks.surface(4));
}
