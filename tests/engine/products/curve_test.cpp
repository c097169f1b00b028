// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <numbers>
#include <random>

#include "support/curve_oracles.h"
#include "support/curve_runs.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

std::size_t reached(const OffsetResult& result) {
  return result.statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)];
}

}  // namespace

TEST_CASE("curves: the circle of 40 points goes where the exact offset of its polygon has corners", "[curves]") {
  const Curves circle = star(40, [](double) { return 0.5; });
  for (const double d : {-0.1, 0.1}) {
    const OffsetResult result = offset_of(circle, d);
    CHECK(reached(result) == 40);
    CHECK(result.statistics.faces.samples == 40 * 65);
    // Inward segments lie on parallels; outward their middles are nearer by what a chord is nearer than its arc.
    const double sag = d < 0 ? 0 : (0.5 - 0.6) * std::cos(std::numbers::pi / 40) + 0.1;
    CHECK(result.statistics.faces.worst == Approx(sag / 0.1).margin(1e-9));
    // Inward the corners lie on both neighbours' parallels; outward they are as far from the corner itself.
    const double radius = d < 0 ? 0.5 - 0.1 / std::cos(std::numbers::pi / 40) : 0.6;
    for (std::size_t p = 0; p < 40; ++p)
      CHECK((result.positions[p] - circle.positions[p].unit() * radius).length() < 1e-9);
  }
}

TEST_CASE("curves: outward is away from what is enclosed, whichever way curves run", "[curves]") {
  // A square with a square hole, a smaller square in that; each a second time with the points the other way round.
  for (const bool turned : {false, true}) {
    Curves curves;
    for (const double side : {3.0, 2.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(curves.positions.size());
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        curves.positions.emplace_back(side * x, (turned ? -side : side) * y, 0);
      curves.corners.insert(curves.corners.end(), {first, first + 1, first + 2, first + 3, first});
      curves.close_face();
    }
    const OffsetResult result = offset_of(curves, -0.25);
    CHECK(reached(result) == 12);
    for (std::size_t p = 0; p < 12; ++p) {
      // Inward, the outer one and the one in the hole shrink, and the hole grows.
      const double side = p < 4 ? 2.75 : p < 8 ? 2 + 0.25 / std::sqrt(2.0) : 0.75;
      for (int k = 0; k < 2; ++k) CHECK(std::abs(result.positions[p][k]) == Approx(side).epsilon(1e-7));
    }
  }
}

TEST_CASE("curves: a square is a larger or smaller square by default", "[curves][miter]") {
  const Curves square = curve_through({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, true);
  for (const double d : {0.1, -0.1}) {
    const Distances distance(d);
    const OffsetResult result = offset_curves(square.view(), {&distance, 1}, {}).front();
    for (std::size_t p = 0; p < 4; ++p) CHECK((result.positions[p] - square.positions[p] * (1 + d)).length() <= 1e-12);
  }
}

TEST_CASE("curves: ends that are apart by rounding alone are one", "[curves]") {
  // The sine of a whole turn is no zero.
  constexpr std::size_t kPoints = 41;
  std::vector<Vec3d> points;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double angle = kTurn * static_cast<double>(k) / (kPoints - 1);
    points.emplace_back(3 * std::cos(angle), std::sin(angle), 0);
  }
  REQUIRE(points.front() != points.back());
  const Curves nearly = curve_through(points, false);
  points.pop_back();
  const Curves exactly = curve_through(points, true);
  for (const double distance : {0.2, -0.2}) {
    const Distances asked(distance);
    const OffsetResult result = offset_curves(nearly.view(), {&asked, 1}, {}).front(),
                       expected = offset_curves(exactly.view(), {&asked, 1}, {}).front();
    CHECK(result.statistics.facts.closed_components == 1);
    CHECK(result.statistics.facts.boundary_edges == 0);
    for (std::size_t p = 0; p < points.size(); ++p)
      CHECK((result.positions[p] - expected.positions[p]).length() < 1e-9);
    CHECK(result.positions.back() == result.positions.front());
    CHECK(check_curves(nearly.view(), result.positions, {}).valid());
  }
  // Ends that are as far apart as a curve may be open are two.
  Curves open = nearly;
  open.positions.back()[1] = -1e-6;
  const Distances asked(0.2);
  CHECK(offset_curves(open.view(), {&asked, 1}, {}).front().statistics.facts.closed_components == 0);
}

TEST_CASE("curves: an open curve has its right side outward, and keeps square ends", "[curves]") {
  const Curves line = curve_through({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}}, false);
  const OffsetResult right = offset_of(line, 0.1), left = offset_of(line, -0.1);
  CHECK((right.positions[0] - Vec3d(0, -0.1, 0)).length() < 1e-9);
  CHECK((right.positions[3] - Vec3d(2.1, 1, 0)).length() < 1e-9);
  CHECK((left.positions[0] - Vec3d(0, 0.1, 0)).length() < 1e-9);
  CHECK((left.positions[2] - Vec3d(1.9, 0.1, 0)).length() < 1e-6);
  CHECK(reached(right) + reached(left) == 8);
}

TEST_CASE("curves: pieces that run to and fro are joined to one", "[curves]") {
  const Curves whole = star(24, [](double a) { return 1 + 0.2 * std::sin(3 * a); });
  Curves pieces;
  pieces.positions = whole.positions;
  for (std::uint32_t p = 0; p < 24; ++p) {
    const std::uint32_t q = (p + 1) % 24;
    if (p % 3 == 0) pieces.add_face({q, p});
    else pieces.add_face({p, q});
  }
  const OffsetResult of_whole = offset_of(whole, 0.1), of_pieces = offset_of(pieces, 0.1);
  CHECK(of_pieces.statistics.facts.closed_components == 1);
  CHECK(of_pieces.positions == of_whole.positions);
}

TEST_CASE("curves: the plane may lie anywhere", "[curves]") {
  const Curves flat = star(60, [](double a) { return 1 + 0.3 * std::cos(5 * a); });
  const OffsetResult expected = offset_of(flat, 0.1);
  const Vec3d u = Vec3d(1, 2, 2) / 3.0, v = Vec3d(2, 1, -2) / 3.0, origin(10, 20, 30);
  for (const auto& [e, f, tolerance] :
       {std::tuple{Vec3d(0, 1, 0), Vec3d(0, 0, 1), 0.0}, {Vec3d(0, 0, 1), Vec3d(1, 0, 0), 0.0}, {u, v, 1e-4}}) {
    Curves turned = flat;
    const Vec3d at = tolerance > 0 ? origin : Vec3d(0.0);
    for (Vec3d& p : turned.positions) p = at + e * p[0] + f * p[1];
    const OffsetResult result = offset_of(turned, 0.1);
    CHECK(reached(result) == reached(expected));
    for (std::size_t p = 0; p < 60; ++p) {
      const Vec3d& x = expected.positions[p];
      CHECK((result.positions[p] - (at + e * x[0] + f * x[1])).length() <= tolerance);
      CHECK(std::abs((result.positions[p] - at).dot(e.cross(f))) < 1e-12);
    }
  }
}

TEST_CASE("curves: what is not in one plane is refused, by its point", "[curves]") {
  Curves bent = star(8, [](double) { return 1.0; });
  bent.positions[5][2] = 0.1;
  CHECK_THROWS_WITH(offset_of(bent, 0.1), Catch::Contains("one plane"));
  Curves wrong = star(8, [](double) { return 1.0; });
  wrong.corners[2] = 8;
  CHECK_THROWS_WITH(offset_of(wrong, 0.1), Catch::Contains("below 8, got 8"));
}

TEST_CASE("curves: nothing crosses that did not before, in slits, stars and curves that cross themselves", "[curves]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0.6, 1.4);
  const Curves shapes[] = {
      comb(4, 0.2, 0.05), comb(3, 0.02, 0.3), star(200, [](double a) { return 1 + 0.5 * std::sin(9 * a); }),
      star(300, [&](double) { return any(random); }), star(90, [](double a) { return std::cos(2 * a + 0.1); })};
  for (const Curves& shape : shapes)
    for (const double d : {0.01, -0.01, 0.08, -0.08, 0.3})
      for (const Corners corners : {Corners::Round, Corners::Miter})
        require_honest(shape, offset_of(shape, d, corners));
}

TEST_CASE("curves: where two curves share a piece of the front, what is judged is what comes out",
          "[curves][no_races]") {
  struct Oval {
    double x, y, radius;
  };
  const std::vector<Oval> sets[] = {
      {{-2.2087, 1.1366, 1.367}, {1.6365, -0.5141, 0.4925}, {1.7296, -1.2776, 1.1084}, {-1.4902, 0.7369, 0.8528}},
      {{0.9843, -2.6399, 0.8843}, {0.0324, -2.9008, 1.4698}, {-0.9629, 1.1523, 1.1783}, {0.8193, -0.912, 1.2504}}};
  for (const auto& ovals : sets) {
    Curves curves;
    for (const auto& [x, y, radius] : ovals) {
      const auto first = static_cast<std::uint32_t>(curves.positions.size());
      for (std::uint32_t i = 0; i < 200; ++i) {
        const double a = kTurn * i / 200;
        curves.corners.push_back(first + i);
        curves.positions.emplace_back(x + radius * std::cos(a), y + radius * (1 + 0.3 * std::sin(5 * a)) * std::sin(a),
                                      0);
      }
      curves.corners.push_back(first);
      curves.close_face();
    }
    for (const double d : {0.1, -0.1, 0.25, -0.25}) require_honest(curves, offset_of(curves, d));
  }
}

TEST_CASE("curves: where a corner cuts off a piece of the offset, its points are spread over the rest", "[curves]") {
  // Each trough of this star is narrower than the offset, and all points still find a position on it.
  const bool clockwise = GENERATE(false, true);
  Curves star_of_twelve = star(1200, [](double a) { return 1 + 0.4 * std::sin(12 * a); });
  if (clockwise) std::reverse(star_of_twelve.corners.begin(), star_of_twelve.corners.end());
  const OffsetResult result = offset_of(star_of_twelve, 0.1);
  CHECK(reached(result) == 1200);
  require_honest(star_of_twelve, result);
}

TEST_CASE("curves: points of a rough curve that overtake each other are put back in order", "[curves][long]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(0, 4e-3);
  for (const bool closed : {true, false}) {
    Curves curves = star(3000, [&](double a) { return 1 + 0.05 * std::sin(9 * a) + noise(random); });
    if (!closed) curves.corners.pop_back(), curves.face_begin.back() -= 1;
    for (const double d : {-0.06, 0.06}) {
      const OffsetResult result = offset_of(curves, d);
      CHECK(reached(result) == 3000);
      require_honest(curves, result);
    }
  }
}

TEST_CASE("curves: paths stay in the curves' plane, from where points stood to where they are", "[curves]") {
  Curves tilted = star(200, [](double a) { return 1 + 0.3 * std::sin(5 * a); });
  for (Vec3d& p : tilted.positions) p = Vec3d(p[0], p[1], 0.5 * p[0] - p[1]);
  const Distances distance(-0.2);
  OffsetOptions options;
  options.keep_paths = true;
  const OffsetResult result = offset_curves(tilted.view(), {&distance, 1}, options).front();
  REQUIRE(result.paths.size() == 200);
  std::size_t positions = 0;
  for (std::size_t p = 0; p < 200; ++p) {
    const auto& path = result.paths[p];
    positions += path.size();
    CHECK(path.front() == tilted.positions[p]);
    CHECK(path.back() == result.positions[p]);
    for (const Vec3d& x : path) CHECK(x[2] == Approx(0.5 * x[0] - x[1]).margin(1e-12));
  }
  CHECK(positions > 1000);
}

TEST_CASE("curves: each point has its own distance, 0 stays put", "[curves]") {
  const Curves circle = star(120, [](double) { return 1.0; });
  std::vector<double> each;
  each.reserve(120);
  for (int p = 0; p < 120; ++p) each.push_back(p < 20 ? 0 : 0.05 + 0.04 * std::sin(kTurn * p / 120));
  OffsetOptions options;
  options.corners = Corners::Round;
  const Distances distances{std::vector<double>(each)};
  const OffsetResult result = offset_curves(circle.view(), {&distances, 1}, options).front();
  require_honest(circle, result);
  for (std::size_t p = 0; p < 20; ++p) CHECK(result.positions[p] == circle.positions[p]);
  CHECK(reached(result) == 120);
}

TEST_CASE("curves: leaf nodes are estimated before they are made", "[curves]") {
  for (const double d : {0.005, 0.05, -0.3}) {
    const Curves shape = star(500, [](double a) { return 1 + 0.3 * std::sin(5 * a); });
    const Distances distances(d);
    const std::size_t planned = plan_curves(shape.view(), {&distances, 1}, {}).plan.leaf_nodes,
                      made = offset_of(shape, d).statistics.leaf_nodes;
    CHECK(planned > made / 2);
    CHECK(2 * planned < 5 * made);
  }
}

TEST_CASE("curves: the same bytes for any number of threads", "[curves]") {
  const Curves shape = star(3000, [](double a) { return 1 + 0.3 * std::sin(11 * a) + 0.02 * std::sin(190 * a); });
  const Distances distances(0.06);
  OffsetOptions options;
  options.threads = 1;
  const OffsetResult one = offset_curves(shape.view(), {&distances, 1}, options).front();
  options.threads = 0;
  const OffsetResult all = offset_curves(shape.view(), {&distances, 1}, options).front();
  CHECK(one.positions == all.positions);
  CHECK(one.states == all.states);
}

TEST_CASE("curves: crossings of the source are counted up to a bound", "[curve][no_races]") {
  // A zigzag whose teeth are out of order: each segment crosses a third of the others.
  const auto zigzag = [](std::size_t count) {
    Curves curves;
    for (std::size_t i = 0; i < count; ++i) {
      curves.positions.emplace_back(10.0 * static_cast<double>(i * 7919 % count) / static_cast<double>(count),
                                    10.0 * static_cast<double>(i % 2), 0);
      curves.corners.push_back(static_cast<std::uint32_t>(i));
    }
    curves.close_face();
    return curves;
  };
  const LimitStatistics few = offset_of(zigzag(400), 0.05).statistics.limit;
  CHECK(few.source_crossings > 10000);
  CHECK(few.source_crossings < 1000000);
  CHECK_FALSE(few.more_source_crossings);
  const LimitStatistics many = offset_of(zigzag(3000), 0.05).statistics.limit;
  CHECK(many.source_crossings == 1000000);
  CHECK(many.more_source_crossings);
}

TEST_CASE("curves: a segment that is run through many times is one", "[curve]") {
  Curves curves;
  for (std::size_t i = 0; i < 20000; ++i) {
    curves.positions.emplace_back(static_cast<double>(i % 2), 0, 0);
    curves.corners.push_back(static_cast<std::uint32_t>(i));
  }
  curves.close_face();
  const OffsetResult result = offset_of(curves, 0.1);
  CHECK(result.statistics.limit.source_crossings == 0);
  CHECK(result.statistics.limit.left.total() == 0);
}

TEST_CASE("curves: points that are only rounded have reached their distance, points that are short have not",
          "[curves]") {
  // A square hole in a square. Outward of the outer one a corner goes along its diagonal, to coordinates that no number
  // of digits holds: rounding moves it by up to half a unit of the last one.
  Curves curves;
  for (const auto& [x0, y0, x1, y1] : {std::array{0.0, 0.0, 40.0, 30.0}, std::array{15.0, 10.0, 25.0, 20.0}}) {
    const auto first = static_cast<std::uint32_t>(curves.positions.size());
    for (const Vec3d& p : {Vec3d(x0, y0, 0), Vec3d(x1, y0, 0), Vec3d(x1, y1, 0), Vec3d(x0, y1, 0)})
      curves.positions.push_back(p);
    curves.add_face({first, first + 1, first + 2, first + 3, first});
  }
  const auto offset_with = [&](const Distances& distances, int digits) {
    OffsetOptions options;
    options.precision = {.kind = Precision::Kind::Digits, .digits = digits};
    options.corners = Corners::Round;
    return offset_curves(curves.view(), {&distances, 1}, options).front();
  };
  for (const int digits : {4, 5, 6, 7, 8})
    for (const double d : {0.1, -0.1}) {
      const OffsetResult result = offset_with(d, digits);
      CHECK(reached(result) == 8);
      const double rounding = 5 * std::pow(10.0, -digits) * std::hypot(40.1, 30.1);
      for (std::size_t p = 0; p < 8; ++p) CHECK(result.achieved[p] == Approx(0.1).margin(rounding));
    }
  // The hole is 10 wide: nothing in it is 6 from its walls, however coarse the coordinates.
  const OffsetResult short_of = offset_with(6, 6);
  for (std::size_t p = 4; p < 8; ++p) CHECK(short_of.states[p] != VertexState::Reached);
}
