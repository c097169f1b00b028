// SPDX-License-Identifier: Apache-2.0
// Curved shapes of drawings: where their points are, beside closed forms and dense samples.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "vdb_offset/io/curve_file.h"

using namespace vdb_offset;

// Names of its own, and tests among them, as tests are compiled several files at once.
namespace svg_shapes {
namespace {

constexpr double kPi = std::numbers::pi;

Curves drawn(const std::string& inside, double tolerance) {
  const std::string text = "<svg xmlns='http://www.w3.org/2000/svg'>" + inside + "</svg>";
  return io::parse_curves("t.svg", io::CurveFormat::Svg, text, {0, tolerance}).file.polygons;
}

std::vector<Vec2d> points_of(const Curves& curves, std::size_t curve = 0) {
  std::vector<Vec2d> points;
  for (const auto p : curves.view().face(curve)) points.emplace_back(curves.positions[p][0], curves.positions[p][1]);
  return points;
}

double distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const Vec2d along = b - a;
  const double length = along.dot(along), t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (p - a - along * t).length();
}

double distance_to_line(const Vec2d& p, const std::vector<Vec2d>& line) {
  double least = (p - line.front()).length();
  for (std::size_t k = 1; k < line.size(); ++k) least = std::min(least, distance_to_segment(p, line[k - 1], line[k]));
  return least;
}

/// The largest distance of either of two lines from the other: of points on the first, and of points on its own
/// segments.
double apart(const std::vector<Vec2d>& dense, const std::vector<Vec2d>& line) {
  double most = 0;
  for (const Vec2d& p : dense) most = std::max(most, distance_to_line(p, line));
  for (std::size_t k = 1; k < line.size(); ++k)
    for (int i = 0; i <= 8; ++i)
      most = std::max(most, distance_to_line(line[k - 1] + (line[k] - line[k - 1]) * (i / 8.0), dense));
  return most;
}

double length_of(const std::vector<Vec2d>& line) {
  double length = 0;
  for (std::size_t k = 1; k < line.size(); ++k) length += (line[k] - line[k - 1]).length();
  return length;
}

}  // namespace

TEST_CASE("drawings: a circle has the fewest points in four like quarters that keep to the tolerance", "[curves][io]") {
  for (const double tolerance : {3.0, 0.5, 0.1, 1e-3, 1e-6}) {
    const std::vector<Vec2d> circle = points_of(drawn("<circle cx='24' cy='-24' r='2'/>", tolerance));
    CHECK(circle.front() == circle.back());
    const std::size_t count = circle.size() - 1;
    REQUIRE(count % 4 == 0);
    const auto sagitta = [](double n) { return 2 * (1 - std::cos(kPi / n)); };
    CHECK(sagitta(static_cast<double>(count)) <= tolerance * (1 + 1e-9));
    if (count > 4) CHECK(sagitta(static_cast<double>(count - 4)) > tolerance);
    for (const Vec2d& p : circle) {
      CHECK(std::hypot(p[0] - 24, p[1] + 24) == Approx(2).epsilon(1e-14));
      // It is symmetric to both axes, to the last bit.
      for (const Vec2d& mirrored : {Vec2d(48 - p[0], p[1]), Vec2d(p[0], -48 - p[1])})
        CHECK(std::find(circle.begin(), circle.end(), mirrored) != circle.end());
    }
  }
}

TEST_CASE("drawings: ellipses keep to the tolerance after their transform", "[curves][io][no_races]") {
  const std::string ellipse = "<ellipse cx='1' cy='2' rx='3' ry='0.5' transform='matrix(2 1 -7 4 5 6)'/>";
  for (const double tolerance : {1.0, 0.01}) {
    const std::vector<Vec2d> line = points_of(drawn(ellipse, tolerance));
    std::vector<Vec2d> dense;
    for (int k = 0; k <= 20000; ++k) {
      const double a = k * kPi / 10000, x = 1 + 3 * std::cos(a), y = 2 + 0.5 * std::sin(a);
      dense.emplace_back(2 * x - 7 * y + 5, x + 4 * y + 6);
    }
    // Samples are so near each other that what lies between two of them adds less than a thousandth.
    CHECK(apart(dense, line) <= tolerance * 1.001);
    CHECK(apart(dense, line) > tolerance / 10);
  }
  CHECK(drawn("<ellipse rx='2' ry='2'/>", 0.1).positions == drawn("<circle r='2'/>", 0.1).positions);
  CHECK(drawn("<ellipse rx='2' ry='auto'/>", 0.1).positions == drawn("<circle r='2'/>", 0.1).positions);
}

TEST_CASE("drawings: arcs with each pair of flags lie on the circle that these choose", "[curves][io]") {
  for (const int large : {0, 1})
    for (const int sweep : {0, 1}) {
      // Between (10, 0) and (0, 10), the circles of radius 10 have their centres at (0, 0) and (10, 10).
      const std::vector<Vec2d> arc =
          points_of(drawn(fmt::format("<path d='M10 0A10 10 0 {}{}0 10'/>", large, sweep), 1e-4));
      const Vec2d centre = large == sweep ? Vec2d(10.0, 10.0) : Vec2d(0.0, 0.0);
      const bool own = large != sweep;
      const Vec2d of = own ? Vec2d(0.0, 0.0) : centre;
      for (const Vec2d& p : arc) CHECK((p - of).length() == Approx(10).epsilon(1e-13));
      CHECK(length_of(arc) == Approx(10 * kPi / 2 * (large ? 3 : 1)).epsilon(1e-4));
      // With the flag, angles grow.
      const Vec2d first = arc[0] - of, second = arc[1] - of;
      CHECK((first[0] * second[1] - first[1] * second[0] > 0) == (sweep == 1));
      CHECK(arc.front() == Vec2d(10.0, 0.0));
      CHECK(arc.back() == Vec2d(0.0, 10.0));
    }
  // Relative, flags without separators, several at once.
  CHECK(drawn("<path d='m10,0a10,10,0,01-10,10 10 10 0 00 1e1-10'/>", 0.1).positions ==
        drawn("<path d='M10 0A10 10 0 0 1 0 10A10 10 0 0 0 10 0'/>", 0.1).positions);
}

TEST_CASE("drawings: arcs that cannot be as given are what SVG makes of them", "[curves][io]") {
  // Radii that are too small grow; their signs do not count.
  for (const Vec2d& p : points_of(drawn("<path d='M0 0A1 -1 30 0 1 10 0'/>", 1e-3)))
    CHECK((p - Vec2d(5, 0)).length() == Approx(5).epsilon(1e-13));
  CHECK(points_of(drawn("<path d='M0 0A0 5 0 0 1 10 0'/>", 1e-3)) == std::vector<Vec2d>{{0, 0}, {10, 0}});
  CHECK(points_of(drawn("<path d='M0 0A5 5 0 1 1 0 0L1 0'/>", 1e-3)) == std::vector<Vec2d>{{0, 0}, {1, 0}});
  // A turned ellipse with the half axes 4 and 2: its points satisfy the equation.
  const double turn = 25 * kPi / 180, c = std::cos(turn), s = std::sin(turn);
  const std::vector<Vec2d> arc = points_of(drawn("<path d='M1 1A4 2 25 1 0 3 2'/>", 1e-3));
  // The centre is where the perpendicular bisector in the ellipse's metric has it; found here from three points.
  const auto in_axes = [&](const Vec2d& p) { return Vec2d((c * p[0] + s * p[1]) / 4, (c * p[1] - s * p[0]) / 2); };
  const Vec2d a = in_axes(arc.front()), b = in_axes(arc[arc.size() / 2]), d = in_axes(arc.back());
  const Vec2d u = b - a, v = d - a;
  const double area = 2 * (u[0] * v[1] - u[1] * v[0]);
  const Vec2d centre(a[0] + (v[1] * u.dot(u) - u[1] * v.dot(v)) / area,
                     a[1] + (u[0] * v.dot(v) - v[0] * u.dot(u)) / area);
  for (const Vec2d& p : arc) CHECK((in_axes(p) - centre).length() == Approx(1).epsilon(1e-12));
  CHECK(std::atan2(u[0] * v[1] - u[1] * v[0], u.dot(v)) < 0);  // without the flag, angles shrink
}

TEST_CASE("drawings: random Bezier curves are flattened to within the tolerance, under any transform",
          "[curves][io][long]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  double nearest_to_tolerance = 0;
  for (int round = 0; round < 60; ++round) {
    Vec2d p[4];
    for (Vec2d& each : p) each = Vec2d(any(random), any(random));
    if (round % 5 == 1) p[3] = p[0];                  // a loop
    if (round % 5 == 2) p[1] = p[0] = p[0] * 1e-3;    // no direction at its beginning
    if (round % 5 == 3) p[2] = p[1] + (p[1] - p[0]);  // a bend at one end
    double m[6];
    for (double& each : m) each = 3 * any(random);
    const double tolerance = std::pow(10, -1 - round % 3);
    const std::string d =
        fmt::format("M{} {}C{} {} {} {} {} {}", p[0][0], p[0][1], p[1][0], p[1][1], p[2][0], p[2][1], p[3][0], p[3][1]);
    const std::string move = fmt::format("matrix({} {} {} {} {} {})", m[0], m[1], m[2], m[3], m[4], m[5]);
    const std::vector<Vec2d> line = points_of(drawn("<path transform='" + move + "' d='" + d + "'/>", tolerance));
    std::vector<Vec2d> dense;
    for (int k = 0; k <= 2000; ++k) {
      const double t = k / 2000.0, s = 1 - t;
      const Vec2d q = s * s * s * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t * t * t * p[3];
      dense.emplace_back(m[0] * q[0] + m[2] * q[1] + m[4], m[1] * q[0] + m[3] * q[1] + m[5]);
    }
    const double off = apart(dense, line);
    CHECK(off <= tolerance + 1e-5);  // samples are less than a hundredth apart
    nearest_to_tolerance = std::max(nearest_to_tolerance, off / tolerance);
    // The measure tells a line that does not keep to the tolerance.
    CHECK(apart(dense, {line.front(), line.front() + Vec2d(2 * tolerance, 0), line.back()}) > 0);
  }
  CHECK(nearest_to_tolerance > 0.9);  // there are no more points than needed
}

TEST_CASE("drawings: the curve from its other end has the same points", "[curves][io]") {
  std::vector<Vec2d> there = points_of(drawn("<path d='M0 0C1 3 4-2 7 1'/>", 0.01)),
                     back = points_of(drawn("<path d='M7 1C4-2 1 3 0 0'/>", 0.01));
  std::reverse(back.begin(), back.end());
  CHECK(there == back);
}

TEST_CASE("drawings: commands of paths in their short forms are what they stand for", "[curves][io]") {
  const auto same = [](const std::string& brief, const std::string& full) {
    const Curves a = drawn("<path d='" + brief + "'/>", 0.01), b = drawn("<path d='" + full + "'/>", 0.01);
    CHECK(a.positions == b.positions);
    CHECK(a.face_begin == b.face_begin);
  };
  same("m1,2c1,1,2,1,3,0s2-1 3 0 1,1,2,2", "M1 2C2 3 3 3 4 2C5 1 6 1 7 2C8 3 8 3 9 4");
  same("M0 0S1 1 2 0", "M0 0C0 0 1 1 2 0");
  same("M0 0q1 1 2 0t2 0 2 0", "M0 0Q1 1 2 0Q3-1 4 0Q5 1 6 0");
  same("M0 0L2 0T4 0", "M0 0L2 0Q2 0 4 0");
  same("M0 0Q1 1 2 0S3 1 4 0", "M0 0Q1 1 2 0C2 0 3 1 4 0");
  same("M0 0c1 1 2 1 3 0zm5 5 c1 1 2 1 3 0ZL9 9", "M0 0C1 1 2 1 3 0ZM5 5C6 6 7 6 8 5ZM5 5L9 9");
  // What is straight stays one segment, however it is told.
  CHECK(drawn("<path d='m10,10 c0,0 20,10 20,10 l5 5 q1 1 2 2'/>", 1e-9).positions.size() == 4);
}

TEST_CASE("drawings: rectangles, lines and shapes without an extent", "[curves][io]") {
  CHECK(points_of(drawn("<rect x='1' y='2' width='3' height='4'/>", 1)) ==
        std::vector<Vec2d>{{1, 2}, {4, 2}, {4, 6}, {1, 6}, {1, 2}});
  CHECK(points_of(drawn("<line x2='3' y1='-1'/>", 1)) == std::vector<Vec2d>{{0, -1}, {3, 0}});
  // One radius stands for both, and both reach to the middle at most: here the ends are half circles.
  const std::vector<Vec2d> slot = points_of(drawn("<rect width='10' height='4' rx='3' ry='9'/>", 1e-3));
  for (const Vec2d& p : slot) {
    const double x = std::min(p[0], 10 - p[0]);
    if (x < 3) CHECK(std::pow((x - 3) / 3, 2) + std::pow((p[1] - 2) / 2, 2) == Approx(1).epsilon(1e-12));
    else CHECK((p[1] == 0 || p[1] == 4));
  }
  for (std::size_t k = 1; k < slot.size(); ++k) CHECK(slot[k] != slot[k - 1]);
  CHECK(drawn("<rect width='5' height='5' rx='1'/>", 0.1).positions ==
        drawn("<rect width='5' height='5' ry='1'/>", 0.1).positions);
  CHECK(
      drawn("<circle/><circle r='0'/><rect width='1'/><ellipse rx='0' ry='1'/><path d='M0 0L1 1'/>", 1).face_count() ==
      1);
  // Absolute units are those of CSS: 96 units are an inch.
  CHECK(points_of(drawn("<line x1='1in' y1='2.54cm' x2='25.4mm' y2=' 72pt '/>", 1)) ==
        std::vector<Vec2d>{{96, 96}, {96, 96}});
}

TEST_CASE("drawings: without being told, the tolerance is a share of the diagonal of what is drawn", "[curves][io]") {
  const auto tolerance_of = [](const std::string& inside, io::CurveReading how) {
    return io::parse_curves("t.svg", io::CurveFormat::Svg, "<svg>" + inside + "</svg>", how).flattened_to;
  };
  const std::string circle = "<circle cx='100' cy='7' r='5' transform='scale(2 1)'/>";
  CHECK(tolerance_of(circle, {}) == Approx(1e-5 * std::hypot(20, 10)).epsilon(1e-12));
  CHECK(tolerance_of(circle, {0.02, 0}) == Approx(0.02 * std::hypot(20, 10)).epsilon(1e-12));
  CHECK(tolerance_of(circle, {0, 0.5}) == 0.5);
  CHECK(tolerance_of("<path d='M0 0L3 4'/>", {}) == 0);
  // The box is around the curves, not around the points that they are drawn to: here from -1 to 1, and 0.75 high.
  CHECK(tolerance_of("<path d='M-1 0C-1 1 1 1 1 0'/>", {1, 0}) == Approx(std::hypot(2, 0.75)).epsilon(1e-12));
  CHECK(tolerance_of("<path d='M-1 0C-1 1e200 1 1e200 1 0'/>", {1, 0}) == Approx(0.75e200).epsilon(1e-12));
  CHECK(tolerance_of("<path d='M0 0A1 1 0 0 1 2 0'/>", {1, 0}) == Approx(std::hypot(2, 1)).epsilon(1e-12));
}

}  // namespace svg_shapes
