// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "ground/numbers/rounding.h"
#include "space/curve/curve_line.h"
#include "support/curve_oracles.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// An L of squares, whose sides have a point every tenth: its corner at 1, 1 is concave.
Curves l_shape() {
  const Vec3d corners[] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3d way = corners[(i + 1) % 6] - corners[i];
    const int steps = static_cast<int>(std::lround(way.length() * 10));
    for (int k = 0; k < steps; ++k) points.push_back(corners[i] + way * (double(k) / steps));
  }
  return curve_through(points, true);
}

OffsetResult offset_by(const Curves& curves, double distance, std::optional<Corners> corners = {}) {
  const Distances distances(distance);
  OffsetOptions options;
  options.corners = corners;
  return offset_curves(curves.view(), {&distances, 1}, options).front();
}

CheckResult check_at(const Curves& curves, const std::vector<Vec3d>& positions, double distance) {
  CheckOptions options;
  options.distance = distance;
  return check_curves(curves.view(), positions, options);
}

/// A blunt wedge from its base's lower end around the nose to the upper one, open between them.
Curves blunt(double base) {
  std::vector<Vec3d> points;
  for (int i = 0; i <= 40; ++i) {
    const double x = std::abs(1 - i / 20.0);
    points.emplace_back(x, (i < 20 ? 1 : -1) * (0.05 * std::sqrt(x) * (1 - x) + x * base / 2), 0);
  }
  return curve_through(points, false);
}

}  // namespace

TEST_CASE("curve check: what a run makes is valid, and at its distance", "[curves][check]") {
  for (const double distance : {0.3, -0.2}) {
    const Curves curves = l_shape();
    const OffsetResult result = offset_by(curves, distance);
    const CheckResult found = check_at(curves, result.positions, distance);
    CHECK(found.valid());
    CHECK(found.faults.total() == result.statistics.limit.left.total());
    CHECK(std::count(found.states.begin(), found.states.end(), VertexState::Reached) ==
          std::count(result.states.begin(), result.states.end(), VertexState::Reached));
    for (std::size_t p = 0; p < curves.positions.size(); ++p) {
      CHECK(found.achieved[p] == Approx(result.achieved[p]));
      CHECK(found.achieved[p] == Approx(distance_to(curves, result.positions[p])));
    }
    CHECK(check_curves(curves.view(), result.positions).distance == Approx(distance));
    CHECK(found.facts.components == 1);
    CHECK(found.facts.closed_components == 1);
  }
}

TEST_CASE("curve check: each point is judged at its own distance", "[curves][check]") {
  const Curves curves = l_shape();
  std::vector<double> each;
  for (const Vec3d& p : curves.positions) each.push_back(0.1 + 0.05 * p[0]);
  const Distances distances(each);
  const OffsetResult result = offset_curves(curves.view(), {&distances, 1}, {}).front();
  CheckOptions options;
  options.distance = distances;
  const CheckResult found = check_curves(curves.view(), result.positions, options);
  CHECK(found.valid());
  CHECK(found.beyond == 0);
  CHECK(found.distance == Approx(0.2));
  CHECK(found.states == result.states);
  CHECK(found.faces.mean == Approx(result.statistics.faces.mean));
  // A point that is where another one should be is off its own distance.
  std::vector<Vec3d> positions = result.positions;
  positions[5] -= Vec3d(0, 0.01, 0);
  CHECK(check_curves(curves.view(), positions, options).states[5] == VertexState::Limited);
  options.distance = Distances(std::vector<double>{0.1, 0.2});
  CHECK_THROWS_WITH(check_curves(curves.view(), positions, options),
                    Catch::Contains("a distance for each of 80 points"));
}

TEST_CASE("curve check: each fault is found", "[curves][check]") {
  const Curves curves = l_shape();
  const std::vector<Vec3d> good = offset_by(curves, 0.05).positions;
  REQUIRE(check_at(curves, good, 0.05).valid());
  SECTION("points that have overtaken each other") {
    std::vector<Vec3d> positions = good;
    std::swap(positions[4], positions[5]);
    const CheckResult found = check_at(curves, positions, 0.05);
    CHECK(found.faults.inverted == 1);
    CHECK(found.faults.crossings > 0);
    CHECK_FALSE(found.valid());
  }
  SECTION("two at one position") {
    std::vector<Vec3d> positions = good;
    positions[5] = positions[4];
    CHECK(check_at(curves, positions, 0.05).faults.collapsed == 1);
  }
  SECTION("a point on the other side, and one too far") {
    std::vector<Vec3d> positions = good;
    positions[5][1] = 0.05;
    positions[8][1] = -0.2;
    const CheckResult found = check_at(curves, positions, 0.05);
    CHECK(found.wrong_side == 1);
    CHECK(found.beyond == 1);
    CHECK_FALSE(found.valid());
  }
  SECTION("copies that have come apart") {
    Curves twice = curves;
    twice.positions.push_back(twice.positions[0]);
    twice.corners.back() = static_cast<std::uint32_t>(twice.positions.size() - 1);
    std::vector<Vec3d> positions = good;
    positions.push_back(good[0] + Vec3d(1e-3, 0, 0));
    CHECK(check_at(twice, positions, 0.05).torn == 1);
  }
  SECTION("what is no offset of it") {
    CHECK_THROWS_WITH(check_at(curves, {good.begin(), good.end() - 1}, 0.05), Catch::Contains("as many points"));
    std::vector<Vec3d> positions = good;
    positions[3][2] = 1;
    CHECK_THROWS_WITH(check_at(curves, positions, 0.05), Catch::Contains("in the plane of the source"));
  }
}

TEST_CASE("curve check: progress changes nothing, and cancels", "[curves][check]") {
  const Curves curves = l_shape();
  const std::vector<Vec3d> positions = offset_by(curves, 0.1).positions;
  CheckOptions options;
  options.distance = 0.1;
  std::vector<double> shares;
  options.progress = [&](Stage, double share) {
    shares.push_back(share);
    return true;
  };
  CHECK(check_curves(curves.view(), positions, options).achieved == check_at(curves, positions, 0.1).achieved);
  CHECK(std::is_sorted(shares.begin(), shares.end()));
  CHECK(shares.back() == 1);
  options.progress = [](Stage, double share) { return share < 0.5; };
  CHECK_THROWS_AS(check_curves(curves.view(), positions, options), Cancelled);
}

TEST_CASE("curve layers: at a concave corner, segments keep a share of the wall's", "[curves][layers]") {
  const Curves curves = l_shape();
  for (const double total : {0.15, 0.3, 0.45}) {
    std::vector<Distances> heights;
    for (int k = 1; k <= 10; ++k) heights.emplace_back(total * k / 10);
    const LayersResult layers = grow_curve_layers(curves.view(), heights, {});
    const CurveCells cells = make_curve_cells(curves.view(), layers);
    const LayerQuality quality = measure_curve_cells(cells, layers);
    // A fifth of the wall's along the front; straight across its right-angled corner that is less.
    CHECK(quality.least_segment >= 0.2 * std::sqrt(0.5));
    CHECK(*std::min_element(quality.scaled_jacobian.begin(), quality.scaled_jacobian.end()) > 0.3f);
    for (std::size_t k = 1; k <= 10; ++k) {
      const std::vector<Vec3d> front = layers.stacks.surface(k);
      for (std::size_t p = 0; p < front.size(); ++p)
        CHECK(distance_to(curves, front[p]) == Approx(total * double(k) / 10).epsilon(1e-6));
    }
    CHECK(new_crossings(curves, layers.stacks.surface(10)) == 0);
  }
}

TEST_CASE("curve ends: those near each other are told, and closed by a straight segment", "[curves]") {
  Curves curves = blunt(0.02);
  const std::vector<OpenCurve> open = open_curves(curves.view());
  REQUIRE(open.size() == 1);
  CHECK(open[0].gap == Approx(0.02));
  CHECK(open[0].is_nearly_closed());
  CHECK(open[0].first + open[0].last == 40);
  CHECK(close_curves(curves).size() == 1);
  CHECK(curves.face_count() == 1);
  CHECK(curves.corners.size() == 42);
  CHECK(curves.corners.back() == curves.corners.front());
  CHECK(open_curves(curves.view()).empty());
  // Closed, it has an inside, and its offset goes all around it.
  const OffsetResult result = offset_by(curves, 0.1, Corners::Round);
  for (std::size_t p = 0; p < curves.positions.size(); ++p) CHECK(result.achieved[p] == Approx(0.1));
  CHECK(result.positions[0][0] > 1.05);
  CHECK(result.positions[40][0] > 1.05);
}

TEST_CASE("curve ends: far from each other, or of several pieces", "[curves]") {
  Curves arc = curve_through({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, false);
  CHECK(open_curves(arc.view()).size() == 1);
  CHECK_FALSE(open_curves(arc.view())[0].is_nearly_closed());
  CHECK_THROWS_WITH(close_curves(arc), Catch::Contains("expected a closed curve, or ends nearer to each other"));
  // One that is closed by itself beside it is all that there has to be.
  Curves both = arc;
  both.positions.insert(both.positions.end(), {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}});
  both.add_face({3, 4, 5, 3});
  CHECK(close_curves(both).empty());
  CHECK(open_curves(both.view()).size() == 1);
  // Two pieces that go on as one, the second of which runs back.
  Curves pieces;
  pieces.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0.1, 0}};
  pieces.add_face({0, 1, 2});
  pieces.add_face({4, 3, 2});
  CHECK(close_curves(pieces).size() == 1);
  CHECK(pieces.face_count() == 3);
  CHECK(open_curves(pieces.view()).empty());
}

TEST_CASE("curves: where fronts merge, miters add no faults to those of round corners", "[curve][miter][random]") {
  std::size_t mitered = 0, merged = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> radius(0.4, 1.6);
    const std::size_t count = 8 + seed;
    std::vector<Vec3d> points;
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
      points.push_back(Vec3d(std::cos(angle), std::sin(angle), 0) * radius(random));
    }
    const Curves star = curve_through(points, true);
    for (const double distance : {0.1, -0.1, 0.2}) {
      INFO("seed " << seed << ", distance " << distance);
      const auto count_faults = [&](Corners corners) {
        OffsetOptions options;
        options.collision = Collision::Merge;
        options.corners = corners;
        const Distances distances(distance);
        const OffsetResult result = offset_curves(star.view(), {&distances, 1}, options).front();
        if (corners == Corners::Miter) mitered += result.statistics.miters.mitered;
        CheckOptions check;
        check.distance = distance;
        check.corners = corners;
        return check_curves(star.view(), result.positions, check).faults.total();
      };
      const std::size_t round = count_faults(Corners::Round);
      merged += round > 0;
      CHECK(count_faults(Corners::Miter) <= round);
    }
  }
  CHECK(mitered > 1000);
  CHECK(merged > 20);
}

TEST_CASE("curves: points that stay keep their digits, and a segment between them its sides", "[curve][random]") {
  // Rounded as well, such a point would be off the source by as much as tells a direction.
  const Rounding precision(Precision{Precision::Kind::Digits, 5});
  std::size_t held = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> aside(-0.3, 0.3);
    std::vector<Vec3d> points;
    for (int k = 0; k < 40; ++k) {
      const double angle = 2 * std::numbers::pi * k / 40;
      points.emplace_back(std::cos(angle) + aside(random), std::sin(angle) + aside(random), 0);
    }
    const Curves crumpled = curve_through(points, true);
    for (const double distance : {0.05, -0.05}) {
      INFO("seed " << seed << ", distance " << distance);
      OffsetOptions options;
      options.precision = precision;
      const Distances distances(distance);
      const OffsetResult result = offset_curves(crumpled.view(), {&distances, 1}, options).front();
      std::vector<Vec3d> written;
      for (std::size_t p = 0; p < result.positions.size(); ++p) {
        written.push_back(precision(crumpled.positions[p], result.positions[p]));
        held += written[p] == crumpled.positions[p];
      }
      CheckOptions check;
      check.distance = distance;
      check.precision = precision;
      const CheckResult found = check_curves(crumpled.view(), written, check);
      CHECK(found.valid());
      CHECK(found.beyond == 0);
    }
  }
  CHECK(held > 10);
}

TEST_CASE("curves: pieces of an outline are joined from wherever the file begins", "[curves]") {
  // A rectangle in four pieces, with a gap of 0.3 that lies in the middle of the file.
  Curves pieces;
  pieces.positions = {{0, 0, 0}, {0, 30, 0}, {0, 30, 0}, {50, 30, 0}, {50, 29.7, 0}, {50, 0, 0}, {50, 0, 0}, {0, 0, 0}};
  for (const std::uint32_t first : {0U, 2U, 4U, 6U}) pieces.add_face({first, first + 1});
  const std::vector<OpenCurve> open = open_curves(pieces.view());
  REQUIRE(open.size() == 1);
  CHECK(open[0].gap == Approx(0.3));
  CHECK(open[0].length == Approx(159.7));
  CHECK(close_curves(pieces).size() == 1);
  OffsetOptions options;
  options.distance = 0.1;
  const OffsetResult result = offset_curves(pieces.view(), std::vector<Distances>{0.1}, options).front();
  for (std::size_t p = 0; p < pieces.positions.size(); ++p) {
    const Vec3d& at = result.positions[p];
    CHECK((at[0] == Approx(-0.1) || at[0] == Approx(50.1)));
  }
}
