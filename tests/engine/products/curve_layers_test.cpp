// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "ground/numbers/rounding.h"
#include "products/volume/cell_quality.h"
#include "support/curve_oracles.h"
#include "support/folder.h"
#include "support/grown_curves.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using namespace vdb_offset::test::grown_curves;
using Catch::Matchers::Contains;

namespace {

/// Twice the area of a closed polygon.
double twice_area(const std::vector<Vec3d>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

}  // namespace

TEST_CASE("curves: layers around a circle are exact, whole and of the area in between", "[curves][layers]") {
  const int n = 64;
  Curves circle = star(n, [](double) { return 1.0; });
  for (const double total : {0.2, -0.2}) {
    const GrownCurves grown = grow(circle, rising(total, 5));
    check_layers(circle, grown);
    CHECK(grown.report.all.coverage == Approx(1));
    CHECK(grown.report.all.cells_by_type[static_cast<std::size_t>(CellType::Quadrilateral)] == 5 * n);
    CHECK(grown.report.points == 6 * n);
    const std::vector<Vec3d> wall = grown.layers.stacks.surface(0), outer = grown.layers.stacks.surface(5);
    CHECK(grown.report.volume == Approx(std::abs(twice_area(outer) - twice_area(wall)) / 2));
    CHECK(grown.cells.mesh.patches.size() == 2);
    CHECK(grown.report.all.wall_angle.most < 1e-4);
    // A mesh of quadrilaterals only, as a block: cut open, and right-handed.
    const StructuredBlock block = make_curve_block(circle.view(), grown.layers);
    REQUIRE(block.ni == n + 1);
    REQUIRE(block.nj == 6);
    CHECK(block.nk == 1);
    CHECK(block.points[0] == block.points[n]);
    for (std::size_t j = 0; j + 1 < block.nj; ++j)
      for (std::size_t i = 0; i + 1 < block.ni; ++i) {
        const Vec3d& x = block.points[j * block.ni + i];
        CHECK((block.points[j * block.ni + i + 1] - x).cross(block.points[(j + 1) * block.ni + i] - x)[2] > 0);
      }
  }
}

TEST_CASE("curves: where there is no room layers get thin, and stay valid", "[curves][layers]") {
  const auto wavy = [](double a) { return 1 + 0.3 * std::cos(7 * a); };
  struct Case {
    const char* name;
    Curves curves;
    double total, least_coverage;
  };
  Curves eight = curve_through({{-1, -1, 0}, {0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {0, 0, 0}, {-1, 1, 0}}, true);
  const std::vector<Case> cases = {{"star, outward", star(200, wavy), 0.2, 1},
                                   {"star, inward", star(200, wavy), -0.3, 0.7},
                                   {"star, far inward", star(200, wavy), -2, 0},
                                   {"comb, narrow slits", comb(4, 0.2, 0.05), 0.15, 0.5},
                                   {"comb, wide slits", comb(4, 0.5, 0.05), 0.15, 0.9},
                                   {"comb, inward", comb(4, 0.3, 0.04), -0.1, 0.8},
                                   {"eight", eight, 0.2, 0},
                                   {"eight, inward", eight, -0.2, 0}};
  for (const Case& c : cases) {
    INFO(c.name);
    const GrownCurves grown = grow(c.curves, rising(c.total, 6));
    check_layers(c.curves, grown);
    CHECK(grown.report.all.coverage >= c.least_coverage);
  }
}

TEST_CASE("curves: distances of layers are those of the curves as written", "[curves][layers]") {
  const Curves curves = star(60, [](double) { return 1.0; });
  OffsetOptions options;
  options.precision = {.kind = Precision::Kind::Digits, .digits = 3};
  const LayersResult layers = grow_curve_layers(curves.view(), rising(0.1, 3), options);
  double most_off = 0;
  for (std::size_t p = 0; p < curves.positions.size(); ++p) {
    const auto positions = layers.stacks.of(p);
    CHECK(positions[0] == curves.positions[p]);
    for (const std::size_t k : {1, 2, 3})
      CHECK((positions[k] - Rounding(options.precision)(positions[k])).length() < 1e-15);
    CHECK(layers.first_achieved[p] == Approx(distance_to(curves, positions[1])).epsilon(1e-9));
    CHECK(layers.achieved[p] == Approx(distance_to(curves, positions[3])).epsilon(1e-9));
    most_off = std::max(most_off, std::abs(layers.first_achieved[p] - 0.1 / 6) * 60);
  }
  CHECK(most_off > 1e-3);  // three digits are few
}

TEST_CASE("curves: layers do not depend on the number of threads", "[curves][layers]") {
  const Curves curves = comb(4, 0.3, 0.02);
  const std::vector<Distances> heights = rising(-0.4, 6);
  OffsetOptions options;
  options.threads = 1;
  const LayersResult one = grow_curve_layers(curves.view(), heights, options);
  CHECK(one.layer_statistics.thinned_vertices > 0);
  CHECK(one.statistics.limit.limited_vertices ==
        static_cast<std::size_t>(std::count(one.states.begin(), one.states.end(), VertexState::Limited)));
  options.threads = 4;
  const LayersResult four = grow_curve_layers(curves.view(), heights, options);
  for (std::size_t k = 0; k <= one.count(); ++k) CHECK(one.stacks.surface(k) == four.stacks.surface(k));
  CHECK(one.share == four.share);
}
