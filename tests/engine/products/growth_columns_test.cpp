// SPDX-License-Identifier: Apache-2.0
#include "products/layers/growth_columns.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "space/query/closest_query.h"
#include "space/surface/surface.h"

using namespace vdb_offset;

namespace {

/// Columns on a mesh, with stacks that rise straight along z, a layer a unit.
struct ColumnsFixture {
  Surface surface;
  ClosestQuery query;
  ConstrainedSurface constrained;
  std::vector<Vec3d> source;
  GrowthColumns columns;
  VertexStacks stacks;

  explicit ColumnsFixture(const Polygons& mesh, std::size_t layers = 2)
      : surface(framed(mesh)),
        query(surface),
        constrained{query, surface, {}, {}, {}},
        source(surface.vertices),
        columns(mesh.view(), constrained, source),
        stacks(source.size(), layers) {
    for (std::size_t v = 0; v < source.size(); ++v)
      for (std::size_t k = 0; k <= layers; ++k) stacks.of(v)[k] = source[v] + Vec3d(0, 0, static_cast<double>(k));
  }
  static Surface framed(const Polygons& mesh) {
    Surface made = build_surface(mesh.view(), {});
    to_local_frame(made, 1);
    return made;
  }
  std::uint32_t at(double x, double y) const {
    for (std::uint32_t v = 0; v < source.size(); ++v)
      if ((source[v] + surface.origin - Vec3d(x, y, 0)).length() < 1e-12) return v;
    return kNone;
  }
  bool valid(std::size_t column, int side = 1) const { return columns.is_valid(column, stacks, side); }
};

/// One face in the plane z = 0, seen from above.
Polygons one_face(std::initializer_list<std::array<double, 2>> corners) {
  Polygons mesh;
  for (const auto& [x, y] : corners) {
    mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.emplace_back(x, y, 0);
  }
  mesh.close_face();
  return mesh;
}

const std::array<Polygons, 3>& one_of_each_kind() {
  static const std::array<Polygons, 3> kFaces{one_face({{0, 0}, {2, 0}, {0, 2}}),
                                              one_face({{0, 0}, {2, 0}, {2, 2}, {0, 2}}),
                                              one_face({{0, 0}, {2, 0}, {3, 1}, {2, 2}, {0, 2}})};
  return kFaces;
}

}  // namespace

TEST_CASE("columns: one a face, its base as the face runs, its normal that of the face", "[layers][columns][oracle]") {
  for (const Polygons& mesh : one_of_each_kind()) {
    const ColumnsFixture of(mesh);
    REQUIRE(of.columns.size() == 1);
    const auto base = of.columns.base(0);
    REQUIRE(base.size() == mesh.corners.size());
    for (std::size_t k = 0; k < base.size(); ++k) {
      const Vec3d n = of.columns.normal(0, k, of.stacks, 1);
      CHECK(n.unit() == Vec3d(0, 0, 1));
      CHECK(of.columns.around(base[k]).size() == 1);
    }
    CHECK(of.columns.split_quads().empty());
    CHECK(of.columns.without_area().empty());
  }
}

TEST_CASE("columns: cells that rise are valid, on one side alone", "[layers][columns]") {
  for (const Polygons& mesh : one_of_each_kind()) {
    const ColumnsFixture of(mesh);
    CHECK(of.valid(0, 1));
    CHECK_FALSE(of.valid(0, -1));
  }
}

TEST_CASE("columns: a corner that sinks, lies in the layer below, or leans over its neighbour makes cells invalid",
          "[layers][columns]") {
  for (const Polygons& mesh : one_of_each_kind())
    for (const Vec3d& moved : {Vec3d(0, 0, -1.5), Vec3d(0, 0, -1), Vec3d(5, 0, 0)}) {
      CAPTURE(mesh.corners.size(), moved[0], moved[2]);
      ColumnsFixture of(mesh);
      of.stacks.of(of.at(0, 0))[2] += moved;
      CHECK_FALSE(of.valid(0));
      // A third of the way back is none of these.
      of.stacks.of(of.at(0, 0))[2] -= moved * 0.9;
      CHECK(of.valid(0));
    }
}

TEST_CASE("columns: a vertex without any height leaves valid cells, and so do all", "[layers][columns]") {
  for (const Polygons& mesh : one_of_each_kind()) {
    ColumnsFixture of(mesh);
    const std::size_t most = mesh.corners.size() > 4 ? 1 : mesh.corners.size();  // of flat corners
    for (std::size_t k = 0; k < most; ++k) {
      const auto stack = of.stacks.of(of.columns.base(0)[k]);
      std::fill(stack.begin(), stack.end(), stack.front());
      CAPTURE(mesh.corners.size(), k);
      CHECK(of.valid(0));
    }
  }
}

TEST_CASE("columns: a quad with a corner that turns inwards carries two columns of prisms", "[layers][columns]") {
  // The reflex corner is the third.
  const ColumnsFixture of(one_face({{0, 0}, {4, 0}, {1, 1}, {0, 4}}));
  REQUIRE(of.columns.size() == 2);
  REQUIRE(of.columns.split_quads().size() == 1);
  CHECK(of.columns.split_quads()[0].face == 0);
  CHECK(of.columns.split_quads()[0].from == 0);  // the diagonal from the corner across
  for (const std::size_t c : {0u, 1u}) {
    CHECK(of.columns.base(c).size() == 3);
    CHECK(of.valid(c));
  }
  for (const auto v : {of.at(0, 0), of.at(1, 1)}) CHECK(of.columns.around(v).size() == 2);
  for (const auto v : {of.at(4, 0), of.at(0, 4)}) CHECK(of.columns.around(v).size() == 1);
}

TEST_CASE("columns: a face without area carries none", "[layers][columns]") {
  Polygons mesh = one_face({{0, 0}, {2, 0}, {0, 2}});
  mesh.positions.emplace_back(1, 0, 0);
  mesh.add_face({0, 3, 1});
  const ColumnsFixture of(mesh);
  CHECK(of.columns.size() == 1);
  REQUIRE(of.columns.without_area().size() == 1);
  CHECK(of.columns.without_area()[0] == 1);
}

TEST_CASE("columns: two at once are judged as one by one", "[layers][columns]") {
  Polygons mesh;
  for (const auto& [x, y] : {std::array{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {4.0, 1.0}})
    mesh.positions.emplace_back(x, y, 0);
  mesh.add_face({0, 1, 2});
  mesh.add_face({0, 2, 3});
  mesh.add_face({1, 4, 2});
  ColumnsFixture of(mesh);
  of.stacks.of(of.at(4, 1))[1] += Vec3d(0, 0, 1.5);  // above the layer beyond it
  std::size_t valid = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    valid += of.valid(a);
    for (std::size_t b = 0; b < 3; ++b)
      CHECK(of.columns.are_valid(a, b, of.stacks, 1) == std::array{of.valid(a), of.valid(b)});
  }
  CHECK(valid == 2);
}
