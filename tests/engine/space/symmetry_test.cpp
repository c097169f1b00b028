// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "support/oracles.h"
#include "support/solids.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

namespace {

/// An open tube of quads, whose rings stand at the heights 0 .. 1: position(turn, height) for each, turns being 0 .. 1.
Polygons open_tube(std::uint32_t segments, std::uint32_t stacks, const std::function<Vec3d(double, double)>& position) {
  Polygons mesh;
  for (std::uint32_t j = 0; j <= stacks; ++j)
    for (std::uint32_t i = 0; i < segments; ++i)
      mesh.positions.push_back(position(double(i) / segments, double(j) / stacks));
  for (std::uint32_t j = 0; j < stacks; ++j)
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t next = (i + 1) % segments;
      mesh.add_face({j * segments + i, j * segments + next, (j + 1) * segments + next, (j + 1) * segments + i});
    }
  return mesh;
}

/// A cone's side that gets wider upwards: radius 1 at z = 0, `top` at z = 1.
Polygons cone(double top, std::uint32_t segments = 48, std::uint32_t stacks = 12) {
  return open_tube(segments, stacks, [&](double turn, double z) {
    const double r = 1 + (top - 1) * z, a = 2 * std::numbers::pi * turn;
    return Vec3d(r * std::cos(a), r * std::sin(a), z);
  });
}

/// A box of side 10 with edges rounded by radius 1, in so many steps, without the fillet above one of its sides. Rows
/// go from pole to pole; columns around, those of each of the four quarters with the centre of its corner.
Polygons rounded_box_without_fillet(std::uint32_t steps) {
  const std::uint32_t columns = 4 * (steps + 1), rows = 2 * (steps + 1);
  const auto angle = [&](std::uint32_t i) { return (i % (steps + 1)) * std::numbers::pi / 2 / steps; };
  Polygons mesh;
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t quarter = i / (steps + 1);
      const double turn = angle(i) + quarter * std::numbers::pi / 2,
                   rise = angle(j) - (j <= steps ? std::numbers::pi / 2 : 0);
      mesh.positions.emplace_back((quarter % 3 == 0 ? 4 : -4) + std::cos(rise) * std::cos(turn),
                                  (quarter < 2 ? 4 : -4) + std::cos(rise) * std::sin(turn),
                                  (j <= steps ? -4 : 4) + std::sin(rise));
    }
  for (std::uint32_t j = 0; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t next = (i + 1) % columns, low = j * columns, high = low + columns;
      if (i == steps && j > steps) continue;
      if (j == 0) mesh.add_face({low + i, high + next, high + i});
      else if (j + 2 == rows) mesh.add_face({low + i, low + next, high + i});
      else mesh.add_face({low + i, low + next, high + next, high + i});
    }
  const auto corner = [&](std::uint32_t row, std::uint32_t quarter) { return row * columns + quarter * (steps + 1); };
  mesh.add_face({corner(0, 3), corner(0, 2), corner(0, 1), corner(0, 0)});
  const std::uint32_t top = rows - 1;
  mesh.add_face({corner(top, 0), corner(top, 1), corner(top, 2), corner(top, 3)});
  return mesh;
}

OffsetOptions options_at(double distance) {
  OffsetOptions options;
  options.distance = distance;
  return options;
}

Polygons turned_about(Polygons mesh) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Vec3d& p : mesh.positions) {
    p = Vec3d(c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]);
    p = Vec3d(p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]) + Vec3d(0.3, -0.2, 0.1);
  }
  return mesh;
}

}  // namespace

TEST_CASE("symmetry: borders in a plane stay in it to the last bit, whatever faces do there", "[symmetry]") {
  const Polygons mesh = test::oblique_tube();
  for (const double distance : {0.1, -0.1, 0.37})
    for (const Corners corners : {Corners::Round, Corners::Miter}) {
      OffsetOptions options = options_at(distance);
      options.corners = corners;
      const OffsetResult result = offset(mesh.view(), options);
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) CHECK(result.positions[v][2] == mesh.positions[v][2]);
      const bool is_farther = corners == Corners::Miter && distance > 0;
      CHECK(test::share(result, is_farther ? VertexState::Mitered : VertexState::Reached) == 1);
      CHECK(test::judge(mesh.view(), result, distance, 1, false).worst_reached <= 1e-6);
      CHECK(result.statistics.borders.planes.size() == 2);
      CHECK(result.statistics.borders.held_vertices == 8);
    }
}

TEST_CASE("symmetry: all layers of such borders, and their sides", "[symmetry][layers]") {
  for (const Polygons& mesh : {test::oblique_tube(), cone(1.8)}) {
    std::vector<Distances> heights;
    for (const double h : {0.02, 0.05, 0.1}) heights.emplace_back(h);
    const LayersResult layers = grow_layers(mesh.view(), heights, {});
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      for (std::size_t k = 1; k <= 3; ++k) {
        const double z = mesh.positions[v][2], now = layers.stacks.surface(k)[v][2];
        if (z == 0 || z == 1) CHECK(now == z);
        CHECK(now >= 0);
        CHECK(now <= 1);
      }
    CHECK(std::count(layers.states.begin(), layers.states.end(), VertexState::Reached) >=
          static_cast<std::ptrdiff_t>(mesh.positions.size() * 9 / 10));
  }
}

TEST_CASE("symmetry: planes that lie anywhere hold to rounding", "[symmetry]") {
  const Polygons straight = cone(1.5), mesh = turned_about(straight);
  const OffsetResult result = offset(mesh.view(), options_at(-0.1));
  const Vec3d normal = turned_about({{{0, 0, 0}, {0, 0, 1}}, {}, {0}}).positions[1] -
                       turned_about({{{0, 0, 0}, {0, 0, 1}}, {}, {0}}).positions[0];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double z = straight.positions[v][2];
    if (z == 0 || z == 1) CHECK(std::abs(normal.dot(result.positions[v] - mesh.positions[v])) <= 1e-12);
  }
  CHECK(result.statistics.borders.held_vertices == 96);
}

TEST_CASE("symmetry: the rim of a shell lies flush in the plane of its opening", "[symmetry][shell]") {
  for (const double top : {0.5, 1.0, 1.8}) {
    const Polygons mesh = cone(top);
    for (const double distance : {-0.15, 0.15}) {
      OffsetOptions options = options_at(distance);
      options.off_source = true;
      const OffsetResult result = offset(mesh.view(), options);
      double lowest = 0, highest = 1;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const double z = mesh.positions[v][2], now = result.positions[v][2];
        if (z == 0 || z == 1) CHECK(now == z);
        lowest = std::min(lowest, now), highest = std::max(highest, now);
      }
      CHECK(lowest >= 0);
      CHECK(highest <= 1);
      CHECK(result.statistics.borders.beyond == 0);
      CHECK(result.statistics.limit.left.total() == 0);
      CHECK(test::share(result, VertexState::Reached) >= 0.9);
    }
  }
}

TEST_CASE("symmetry: a flat sheet leaves its own plane, and its sides stay in those across it", "[symmetry]") {
  const Polygons mesh = shapes::patch(1, 1e-30, 6);
  const OffsetResult result = offset(mesh.view(), options_at(0.2));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    CHECK(result.positions[v][0] == mesh.positions[v][0]);
    CHECK(result.positions[v][1] == mesh.positions[v][1]);
    CHECK(result.positions[v][2] == Approx(0.2));
  }
}

TEST_CASE("symmetry: what rounding leaves of a flat sheet's normal does not hold its border", "[symmetry]") {
  // Its border lies in its own plane, wherever that is, and turns at every vertex.
  Polygons mesh = shapes::patch(1, 1e-30, 8);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    for (const int k : {0, 1}) mesh.positions[v][k] += 0.03 * std::sin(double(7 * v + 3 * std::size_t(k)));
  for (const Polygons& sheet : {mesh, turned_about(mesh)}) {
    const OffsetResult result = offset(sheet.view(), options_at(0.2));
    CHECK(result.statistics.borders.held_vertices == 0);
    for (std::size_t v = 0; v < sheet.positions.size(); ++v)
      CHECK((result.positions[v] - sheet.positions[v]).length() == Approx(0.2));
  }
}

TEST_CASE("symmetry: a wavy patch keeps to the four planes of its sides, and its corners to two", "[symmetry]") {
  Polygons mesh = shapes::patch(1, 0.1, 24);
  for (Vec3d& p : mesh.positions) p[2] += 0.3 * p[0] * p[1] + 0.2 * std::cos(4 * p[0] + 3 * p[1]);
  const double distance = 0.05;
  const OffsetResult result = offset(mesh.view(), options_at(distance));
  double low = 1e9, high = -1e9;
  for (const Vec3d& p : mesh.positions) low = std::min(low, p[0]), high = std::max(high, p[0]);
  std::size_t corners = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d &was = mesh.positions[v], &is = result.positions[v];
    int sides = 0;
    for (const int k : {0, 1})
      if (was[k] == low || was[k] == high) {
        ++sides;
        CHECK(is[k] == was[k]);
      }
    corners += sides == 2;
  }
  CHECK(corners == 4);
  CHECK(test::share(result, VertexState::Reached) >= 0.99);
  CHECK(result.statistics.borders.planes.size() == 4);
}

TEST_CASE("symmetry: what of a smooth border lies in a plane by chance is not held", "[symmetry]") {
  // A tube whose rims are waves: each has points where it hardly turns, and where it is highest.
  const Polygons mesh = open_tube(600, 4, [](double turn, double z) {
    const double a = 2 * std::numbers::pi * turn;
    return Vec3d(std::cos(a), std::sin(a), z + 0.2 * std::sin(3 * a) * (2 * z - 1) + 0.1 * std::cos(2 * a));
  });
  CHECK(offset(mesh.view(), options_at(0.05)).statistics.borders.held_vertices == 0);
}

TEST_CASE("symmetry: a border's plane is no wall for what lies in it by chance", "[symmetry]") {
  // A rounded box without one of its fillets: the arcs at that one's ends lie in the planes in which fillets begin.
  const Polygons mesh = rounded_box_without_fillet(6);
  for (const double d : {0.1, -0.1}) {
    const OffsetResult result = offset(mesh.view(), options_at(d));
    CHECK(result.statistics.borders.planes.size() >= 2);
    CHECK(test::share(result, VertexState::Reached) == 1);
    CHECK(result.statistics.faces.mean < 0.01);  // 0.07 with a wall
  }
}

TEST_CASE("symmetry: a named plane holds what lies on it, where it cannot be told from the border", "[symmetry]") {
  // One quad that rises by 20 degrees from its straight edge in y = 0.
  Polygons mesh;
  const double c = std::cos(20 * std::numbers::pi / 180), s = std::sin(20 * std::numbers::pi / 180);
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, c, s}, {0, c, s}};
  mesh.add_face({0, 1, 2, 3});
  OffsetOptions options = options_at(0.1);
  const OffsetResult across = offset(mesh.view(), options);
  CHECK(across.positions[0][1] == Approx(-0.1 * s));
  options.symmetry.planes = {{Vec3d(0, 1, 0), 0}};
  const OffsetResult held = offset(mesh.view(), options);
  for (const std::size_t v : {0u, 1u}) {
    CHECK(held.positions[v][1] == 0);
    CHECK(held.positions[v][2] == Approx(0.1 / c));
  }
  options.symmetry.planes = {{Vec3d(0, 1, 0), 7}};
  CHECK_THROWS_WITH(offset(mesh.view(), options), Catch::Contains("expected vertices on the plane y = 7"));
}

TEST_CASE("symmetry: on a closed body, what lies in a named plane stays in it", "[symmetry]") {
  Polygons mesh = shapes::cylinder(0.5, 1, 32, 4, 3);
  OffsetOptions options = options_at(0.1);
  options.symmetry.planes = {{Vec3d(0, 0, 1), -0.5}};
  const OffsetResult result = offset(mesh.view(), options);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (mesh.positions[v][2] != -0.5) continue;
    CHECK(result.positions[v][2] == -0.5);
    const Vec3d out(mesh.positions[v][0], mesh.positions[v][1], 0);
    if (out.length() > 0.49) CHECK((result.positions[v] - mesh.positions[v]).length() >= 0.0999);
  }
}

TEST_CASE("symmetry: at the edge of a part, where what stays lies in the plane", "[symmetry][part]") {
  const Polygons mesh = shapes::cylinder(0.5, 1, 32, 4, 3);
  OffsetOptions options = options_at(0.1);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    bool flat = true;
    for (const auto v : mesh.view().face(f)) flat = flat && mesh.positions[v][2] == -0.5;
    options.only.push_back(!flat);
  }
  const OffsetResult result = offset(mesh.view(), options);
  std::size_t there = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d out(mesh.positions[v][0], mesh.positions[v][1], 0);
    if (mesh.positions[v][2] != -0.5 || out.length() < 0.49) continue;
    ++there;
    CHECK(result.positions[v][2] == -0.5);
    CHECK(result.achieved[v] == Approx(0.1));
  }
  CHECK(there == 32);
}

TEST_CASE("symmetry: results do not depend on the number of threads", "[symmetry]") {
  const Polygons mesh = turned_about(cone(1.8, 96, 24));
  OffsetOptions options = options_at(-0.2);
  options.threads = 1;
  const auto one = offset(mesh.view(), options).positions;
  options.threads = 4;
  CHECK(offset(mesh.view(), options).positions == one);
}

TEST_CASE("symmetry: vertices that stay in planes may slide within them", "[symmetry][limit]") {
  // A rough nose between two planes: its corners' own faces lead them away from what is beside them.
  Polygons strip = test::nose_strip(2.2, 1.67, 2, 192, 400);
  std::mt19937 dice(3);
  for (std::size_t v = 0; v < strip.positions.size(); v += 2)
    for (int k = 0; k < 2; ++k) {
      const double off = 0.006 * (static_cast<double>(dice()) / 4294967296.0 - 0.5);
      for (const std::size_t end : {v, v + 1}) strip.positions[end][k] += off;
    }
  OffsetOptions options = options_at(0.96);
  options.corners = Corners::Round;
  const OffsetResult result = offset(strip.view(), options);
  CHECK(result.statistics.borders.planes.size() == 2);
  CHECK(result.statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)] == strip.positions.size());
  for (std::size_t v = 0; v < strip.positions.size(); ++v) CHECK(result.positions[v][2] == strip.positions[v][2]);
  CHECK(result.statistics.faces.at_distance > 0.999);  // 0.848 where corners may not slide
}
