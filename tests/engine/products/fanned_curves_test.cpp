// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/grown_curves.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using namespace vdb_offset::test::grown_curves;

namespace {

/// A symmetric foil of the four-digit kind with a sharp trailing edge, from there over the top and back, closed or of
/// two curves that meet there and at the nose.
Curves foil(int count, bool in_two) {
  const auto thickness = [](double x) {
    return 0.6 * (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
  };
  Curves curves;
  const auto place = [&](int i, double side) {
    const double x = (1 + std::cos(std::numbers::pi * i / count)) / 2;
    curves.positions.emplace_back(x, i == 0 || i == count ? 0 : side * thickness(x), 0);
  };
  for (int i = 0; i <= count; ++i) place(i, 1);
  for (int i = count - (in_two ? 0 : 1); i >= (in_two ? 0 : 1); --i) place(i, -1);
  const auto add = [&](std::uint32_t from, std::uint32_t to, bool back) {
    for (std::uint32_t p = from; p <= to; ++p) curves.corners.push_back(p);
    if (back) curves.corners.push_back(from);
    curves.close_face();
  };
  const auto n = static_cast<std::uint32_t>(count);
  if (in_two) add(0, n, false), add(n + 1, 2 * n + 1, false);
  else add(0, 2 * n - 1, true);
  return curves;
}

struct Fanned {
  Curves wall;
  GrownCurves grown;
};
Fanned grow_fanned(const Curves& curves, const std::vector<Distances>& heights, double angle = 60) {
  FannedCurveLayers fanned = grow_fanned_curve_layers(curves.view(), heights, {}, angle);
  Fanned made{fanned.wall ? *fanned.wall : curves, {std::move(fanned.layers), {}, {}}};
  made.grown.cells = make_curve_cells(made.wall.view(), made.grown.layers);
  made.grown.report = report_layers(made.grown.cells.segments.view(), made.grown.layers, {}, made.grown.cells.facts,
                                    measure_curve_cells(made.grown.cells, made.grown.layers));
  check_layers(curves, made.grown);
  for (std::size_t p = 0; p < made.wall.positions.size(); ++p) {
    const auto stack = made.grown.layers.stacks.of(p);
    CHECK(distance_to(curves, stack[0]) <= 1e-15);
    for (std::size_t k = 1; k < stack.size() && made.grown.layers.share[p] == 1; ++k)
      CHECK(distance_to(curves, stack[k]) == Approx(std::abs(heights[k - 1][0])).epsilon(1e-6));
  }
  return made;
}

/// The most that a segment of the outermost layer is longer than its neighbours.
double worst_ratio(const Fanned& made) {
  const auto& patches = made.grown.cells.mesh.patches;
  const auto outer = std::find_if(patches.begin(), patches.end(),
                                  [](const BoundaryPatch& patch) { return patch.kind == BoundaryPatch::Kind::Outer; });
  REQUIRE(outer != patches.end());
  const std::vector<Vec3d>& points = made.grown.cells.mesh.points;
  double worst = 1;
  for (std::size_t f = 0; f < outer->face_count(); ++f)
    for (std::size_t g = 0; g < outer->face_count(); ++g) {
      if (outer->face(f)[1] != outer->face(g)[0]) continue;
      const auto length = [&](std::size_t s) {
        return (points[outer->face(s)[1]] - points[outer->face(s)[0]]).length();
      };
      worst = std::max({worst, length(f) / length(g), length(g) / length(f)});
    }
  return worst;
}

}  // namespace

TEST_CASE("fanned curves: a square's corners get a triangle for each step, and quadrilaterals above",
          "[curves][layers]") {
  Curves square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const std::uint32_t p : {0, 1, 2, 3, 0}) square.corners.push_back(p);
  square.close_face();
  const Fanned made = grow_fanned(square, rising(0.2, 3), 30);
  const LayerFigures& all = made.grown.report.all;
  CHECK(all.cells_by_type[static_cast<std::size_t>(CellType::Triangle)] == 4 * 3);
  CHECK(all.cells_by_type[static_cast<std::size_t>(CellType::Quadrilateral)] == 3 * 4 + 2 * 4 * 3);
  CHECK(all.fan_cells == 3 * 4 * 3);
  const OffsetStatistics& statistics = made.grown.layers.statistics;
  CHECK(statistics.facts.vertices == 4);
  CHECK(statistics.facts.median_edge == Approx(1));
  CHECK(statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)] == 4);
  CHECK(all.coverage == 1);
  CHECK(made.grown.report.volume == Approx(0.8 + std::numbers::pi * 0.04).epsilon(0.01));
  CHECK(made.grown.cells.mesh.patches.front().face_count() == 4);
  // Inward no corner stands out.
  CHECK(!grow_fanned_curve_layers(square.view(), rising(-0.2, 3), {}, 30).wall);
  CHECK(!grow_fanned_curve_layers(square.view(), rising(0.2, 3), {}, 0).wall);
  CHECK_THROWS_AS(grow_fanned_curve_layers(square.view(), rising(0.2, 3), {}, 3), InvalidInput);
}

TEST_CASE("fanned curves: behind a trailing edge cells have about the sizes of their neighbours", "[curves][layers]") {
  std::vector<Distances> heights;
  for (double height = 1e-3; height < 20; height *= 1.25) heights.emplace_back(height);
  heights.emplace_back(20.0);
  for (const auto& [in_two, clockwise] : {std::pair{false, false}, {false, true}, {true, false}}) {
    Curves curves = foil(60, in_two);
    if (clockwise) std::reverse(curves.corners.begin(), curves.corners.end());
    const Fanned made = grow_fanned(curves, heights);
    CHECK(made.grown.report.all.coverage == 1);
    CHECK(made.grown.report.all.fan_cells == 3 * heights.size());
    CHECK(made.grown.report.all.scaled_jacobian.least > 0.5);
    CHECK(worst_ratio(made) < 1.55);
    CHECK(worst_ratio(grow_fanned(curves, heights, 0)) > 50);
  }
}
