// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layer_plan.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using Catch::Matchers::Contains;

namespace {

/// The thickness of each layer at a vertex.
std::vector<double> steps_of(const std::vector<Distances>& heights, std::size_t vertex = 0) {
  std::vector<double> steps;
  double below = 0;
  for (const Distances& height : heights) {
    steps.push_back(height[vertex] - below);
    below = height[vertex];
  }
  return steps;
}

}  // namespace

TEST_CASE("layer plan: two lengths, a number and a growth each follow from the others", "[layers][plan]") {
  // 0.01, 0.02, 0.04, 0.08
  const std::vector<LayerPlan> plans = {
      {.count = 4, .growth = 2, .first = 0.01},    {.count = 4, .growth = 2, .total = 0.15},
      {.count = 4, .growth = 2, .last = 0.08},     {.count = 4, .first = 0.01, .total = 0.15},
      {.count = 4, .first = 0.01, .last = 0.08},   {.count = 4, .total = 0.15, .last = 0.08},
      {.growth = 2, .first = 0.01, .total = 0.15}, {.growth = 2, .first = 0.01, .last = 0.08}};
  for (const LayerPlan& plan : plans)
    for (const double side : {1.0, -1.0}) {
      LayerPlan turned = plan;
      for (auto* const length : {&turned.first, &turned.total, &turned.last})
        if (*length) *length = Distances(side * (**length)[0]);
      const std::vector<Distances> heights = plan_layers(turned);
      const std::vector<double> steps = steps_of(heights);
      REQUIRE(steps.size() == 4);
      for (std::size_t k = 0; k < 4; ++k) CHECK(steps[k] == Approx(side * 0.01 * std::pow(2, k)).epsilon(1e-12));
      CHECK(growth_of(heights).least == 2);
      CHECK(growth_of(heights).largest == 2);
      if (turned.total) CHECK(heights.back()[0] == (*turned.total)[0]);
    }
}

TEST_CASE("layer plan: without a number there are as many layers as the growth needs, which then grow less",
          "[layers][plan]") {
  const std::vector<Distances> heights = plan_layers({.growth = 1.3, .first = 0.001, .total = 0.05});
  // The sum of 10 layers is 0.0426, that of 11 is 0.0564.
  CHECK(heights.size() == 11);
  CHECK(growth_of(heights).largest < 1.3);
  CHECK(growth_of(heights).largest > 1.2);
  CHECK(heights.back()[0] == 0.05);
  CHECK(plan_layers({.growth = 1, .first = 0.01, .total = 0.05}).size() == 5);
  CHECK(plan_layers({.growth = 1.2, .first = 0.01, .last = 0.01}).size() == 1);
  CHECK(plan_layers({.growth = 1.2, .first = 0.01, .total = 0.01}).size() == 1);
}

TEST_CASE("layer plan: each vertex has its own lengths, and the count is that of all", "[layers][plan]") {
  const std::vector<Distances> heights =
      plan_layers({.growth = 1.5, .first = 0.01, .last = Distances(std::vector{0.01, 0.05, 0.0, 0.005})});
  REQUIRE(heights.size() == 5);
  CHECK(steps_of(heights, 0).back() == Approx(0.01));
  CHECK(steps_of(heights, 1).back() == Approx(0.05));
  CHECK(steps_of(heights, 3).back() == Approx(0.005));
  for (const Distances& height : heights) CHECK(height[2] == 0);
  CHECK(growth_of(heights).least == Approx(std::pow(0.5, 0.25)).epsilon(1e-6));
  CHECK(growth_of(heights).largest == Approx(std::pow(5, 0.25)).epsilon(1e-6));
}

TEST_CASE("layer plan: what cannot be is refused, with what was expected", "[layers][plan]") {
  const auto refused = [](const LayerPlan& plan, const std::string& why) {
    CHECK_THROWS_WITH(plan_layers(plan), Contains(why));
  };
  refused({.count = 3}, "expected their number with two of");
  refused({.count = 3, .growth = 1.2, .first = 0.1, .total = 1}, "expected their number with two of");
  refused({.growth = 1.2, .total = 1, .last = 0.1}, "or the first height, one of the other two and the growth");
  refused({.count = 3, .first = 0.1, .total = -1}, "lengths of one sign");
  refused({.count = 3, .first = 0.2, .total = 0.1}, "a first height below the total thickness of 0.1, got 0.2");
  refused({.count = 3, .total = 0.1, .last = 0.2}, "a last height below the total thickness");
  refused({.count = 2, .first = 0.001, .last = 1}, "2 layers grow by no more than 10");
  refused({.count = 1, .first = 0.001, .last = 1}, "for one layer");
  refused({.growth = 0.9, .first = 0.01, .total = 1},
          "with which 1000 layers or less come from a first height of 0.01 to 1, got 0.9");
  refused({.count = 400, .growth = 10, .total = 1}, "expected fewer layers, or a growth below 10");
  refused({.count = 0, .growth = 1, .first = 1}, "expected 1 to 1000, got 0");
  refused({.count = 3, .growth = 11, .first = 1}, "a growth above 0, up to 10, got 11");
  refused({.count = 3, .first = Distances(std::vector{1.0, 2.0}), .total = Distances(std::vector{9.0})},
          "as many vertices, got 2 and 1");
  refused({.count = 3, .first = Distances(std::vector{0.1, 0.3}), .total = 0.2}, "at vertex 1 (counted from 0)");
}

TEST_CASE("layer plan: the height of y+ is that of the law for a flat plate", "[layers][plan]") {
  // c_f at 1e6 is 11.35^-2.3 = 0.00374550.
  CHECK(height_of_y_plus(1, 1e6) == Approx(1 / (1e6 * std::sqrt(0.0037455 / 2))).epsilon(1e-5));
  CHECK(height_of_y_plus(30, 1e6) == Approx(30 * height_of_y_plus(1, 1e6)).epsilon(1e-5));
  // Laminar: c_f = 0.664 / sqrt(100).
  CHECK(height_of_y_plus(1, 100) == Approx(1 / (100 * std::sqrt(0.0332))).epsilon(1e-5));
  CHECK_THROWS_AS(height_of_y_plus(0, 1e6), InvalidInput);
  CHECK_THROWS_AS(height_of_y_plus(1, -1), InvalidInput);
}

TEST_CASE("expression: 'edge' is the mean length of a vertex's edges, of copies as well", "[distances]") {
  const Polygons box = shapes::box(Vec3d(2, 2, 2), 4, false);
  for (const double length : mean_edges(box.view())) CHECK(length == Approx(0.5));
  // A quad of 1 x 3 and a triangle beside it, which has copies of two of its corners.
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 3, 0}, {0, 3, 0}, {1, 0, 0}, {1, 3, 0}, {2, 0, 0}, {9, 9, 9}};
  mesh.add_face({0, 1, 2, 3});
  mesh.add_face({4, 6, 5});
  const std::vector<double> edges = mean_edges(mesh.view());
  CHECK(edges[0] == Approx(2));
  CHECK(edges[1] == Approx((1 + 3 + 3 + 1) / 4.0));
  CHECK(edges[4] == edges[1]);
  CHECK(edges[6] == Approx((1 + std::sqrt(10)) / 2));
  CHECK(edges[7] == 0);
  Curves line;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}};
  line.add_face({0, 1, 2});
  CHECK(curve_edges(line.view()) == std::vector{1.0, 2.0, 3.0});
  const auto sources = VariableSources{{}, {}, [&] { return edges; }};
  CHECK(distances_of(parse_distance_or_expression("2*edge"), mesh.view(), sources)[0] == Approx(4));
}
