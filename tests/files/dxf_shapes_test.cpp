// SPDX-License-Identifier: Apache-2.0
// Curves of DXF files: where their points are, beside closed forms and dense samples.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "support/dxf_text.h"
#include "support/folder.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

// Names of its own, and tests among them, as tests are compiled several files at once.
namespace dxf_shapes {
namespace {

constexpr double kPi = std::numbers::pi;

io::CurveFile read(const std::string& text, double tolerance = 1e-3) {
  return io::parse_curves("t.dxf", io::CurveFormat::Dxf, text, {0, tolerance});
}

std::vector<Vec3d> points_of(const io::CurveFile& file, std::size_t curve = 0) {
  std::vector<Vec3d> points;
  for (const auto p : file.file.polygons.view().face(curve)) points.push_back(file.file.polygons.positions[p]);
  return points;
}

std::vector<Vec3d> drawn(const std::string& entities, double tolerance = 1e-3) {
  return points_of(read(dxf_text::file(entities), tolerance));
}

double distance_to_line(const Vec3d& p, const std::vector<Vec3d>& line) {
  double least = (p - line.front()).length();
  for (std::size_t k = 1; k < line.size(); ++k) {
    const Vec3d along = line[k] - line[k - 1];
    const double square = along.dot(along),
                 t = square > 0 ? std::clamp((p - line[k - 1]).dot(along) / square, 0.0, 1.0) : 0;
    least = std::min(least, (p - line[k - 1] - along * t).length());
  }
  return least;
}

/// The largest distance of either of two lines from the other: of points on the first, and of points on the segments of
/// the second.
double apart(const std::vector<Vec3d>& dense, const std::vector<Vec3d>& line) {
  double most = 0;
  for (const Vec3d& p : dense) most = std::max(most, distance_to_line(p, line));
  for (std::size_t k = 1; k < line.size(); ++k)
    for (int i = 0; i <= 4; ++i)
      most = std::max(most, distance_to_line(line[k - 1] + (line[k] - line[k - 1]) * (i / 4.0), dense));
  return most;
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// A point of a spline by the recursion of its basis functions, which is not how it is flattened.
double basis(const std::vector<double>& u, std::size_t i, std::size_t degree, double t) {
  if (degree == 0) return u[i] <= t && t < u[i + 1] ? 1 : 0;
  const double left = u[i + degree] - u[i], right = u[i + degree + 1] - u[i + 1];
  return (left > 0 ? (t - u[i]) / left * basis(u, i, degree - 1, t) : 0) +
         (right > 0 ? (u[i + degree + 1] - t) / right * basis(u, i + 1, degree - 1, t) : 0);
}

}  // namespace

TEST_CASE("dxf: straight entities are their points", "[curves][io][dxf]") {
  CHECK(drawn("0|LINE 8|0 10|1 20|2 30|3 11|4 21|5 31|3") == std::vector<Vec3d>{{1, 2, 3}, {4, 5, 3}});
  // The oldest files have all x of a line before all y, and nothing where z is 0.
  CHECK(drawn("0|LINE 8|0 10|1 11|4 20|2 21|5") == std::vector<Vec3d>{{1, 2, 0}, {4, 5, 0}});
  CHECK(drawn("0|LWPOLYLINE 8|0 90|3 70|1 38|2.5 10|0 20|0 10|4 20|0 10|4 20|3") ==
        std::vector<Vec3d>{{0, 0, 2.5}, {4, 0, 2.5}, {4, 3, 2.5}, {0, 0, 2.5}});
  CHECK(drawn("0|POLYLINE 8|0 66|1 10|0 20|0 30|1 70|0 0|VERTEX 8|0 10|0 20|0 0|VERTEX 8|0 10|4 20|1 0|SEQEND 8|0") ==
        std::vector<Vec3d>{{0, 0, 1}, {4, 1, 1}});
  CHECK(drawn("0|POLYLINE 66|1 70|8 0|VERTEX 10|0 20|0 30|1 70|32 0|VERTEX 10|4 20|1 30|2 70|32 0|SEQEND") ==
        std::vector<Vec3d>{{0, 0, 1}, {4, 1, 2}});
  // Points that a spline is drawn to are none of the curve.
  CHECK(
      drawn("0|POLYLINE 66|1 70|4 0|VERTEX 10|9 20|9 70|16 0|VERTEX 10|0 20|1 70|8 0|VERTEX 10|4 20|1 70|8 0|SEQEND") ==
      std::vector<Vec3d>{{0, 1, 0}, {4, 1, 0}});
}

TEST_CASE("dxf: circles and arcs lie on their circle, with no more points than needed", "[curves][io][dxf]") {
  for (const double tolerance : {3.0, 0.1, 1e-3, 1e-6}) {
    const std::vector<Vec3d> circle = drawn("0|CIRCLE 8|0 10|24 20|-24 30|1 40|2", tolerance);
    CHECK(circle.front() == circle.back());
    const std::size_t count = circle.size() - 1;
    REQUIRE(count % 4 == 0);
    const auto sagitta = [](double n) { return 2 * (1 - std::cos(kPi / n)); };
    CHECK(sagitta(static_cast<double>(count)) <= tolerance * (1 + 1e-9));
    if (count > 4) CHECK(sagitta(static_cast<double>(count - 4)) > tolerance);
    for (const Vec3d& p : circle) CHECK((p - Vec3d(24, -24, 1)).length() == Approx(2).epsilon(1e-14));
  }
  const std::vector<Vec3d> arc = drawn("0|ARC 8|0 10|1 20|1 40|2 50|90 51|0");
  CHECK(arc.front() == Vec3d(1, 3, 0));  // exact at quarter turns
  CHECK(arc.back() == Vec3d(3, 1, 0));
  double length = 0;
  for (std::size_t k = 1; k < arc.size(); ++k) length += (arc[k] - arc[k - 1]).length();
  CHECK(length == Approx(3 * kPi).epsilon(1e-3));  // counterclockwise: the long way
  CHECK(drawn("0|ARC 8|0 10|0 20|0 40|2 50|30 51|390").size() > 4);
  CHECK(read(dxf_text::file("0|CIRCLE 10|0 20|0 40|0 0|LINE 11|1 21|1")).file.polygons.face_count() == 1);
}

TEST_CASE("dxf: the bulge of a segment is the tangent of a quarter of its angle", "[curves][io][dxf]") {
  // A half circle to the right of its chord, and a closing segment with the angle of a third.
  const std::vector<Vec3d> right = drawn("0|LWPOLYLINE 90|2 70|0 10|0 20|0 42|1 10|4 20|0 42|7");
  for (const Vec3d& p : right) {
    CHECK((p - Vec3d(2, 0, 0)).length() == Approx(2).epsilon(1e-14));
    CHECK(p[1] <= 1e-15);
  }
  const std::vector<Vec3d> left = drawn("0|LWPOLYLINE 90|2 70|0 10|0 20|0 42|-1 10|4 20|0");
  CHECK(std::all_of(left.begin(), left.end(), [](const Vec3d& p) { return p[1] >= 0; }));
  // Old and new polylines are alike.
  CHECK(drawn("0|POLYLINE 66|1 70|1 0|VERTEX 10|0 20|0 42|0.5 0|VERTEX 10|4 20|0 42|-0.2 0|VERTEX 10|1 20|5 42|2 "
              "0|SEQEND") == drawn("0|LWPOLYLINE 90|3 70|1 10|0 20|0 42|0.5 10|4 20|0 42|-0.2 10|1 20|5 42|2"));
  const std::vector<Vec3d> closed = drawn("0|LWPOLYLINE 90|2 70|1 10|0 20|0 42|1 10|4 20|0 42|1");
  CHECK(closed.front() == closed.back());
  for (const Vec3d& p : closed) CHECK((p - Vec3d(2, 0, 0)).length() == Approx(2).epsilon(1e-14));
}

TEST_CASE("dxf: random curves are flattened to within the tolerance, as INSERT shows them", "[curves][io][dxf]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  double nearest_to_tolerance = 0;
  for (int round = 0; round < 80; ++round) {
    const double tolerance = std::pow(10, -1 - round % 3), turn = 180 * any(random), sx = 2 * any(random),
                 sy = any(random);
    const auto placed = [&](double x, double y) {
      const double c = std::cos(turn * kPi / 180), s = std::sin(turn * kPi / 180);
      return Vec3d(3 + c * sx * x - s * sy * y, 4 + s * sx * x + c * sy * y, 0);
    };
    std::string entity;
    std::vector<Vec3d> dense;
    constexpr int kSamples = 3000;
    const double x = any(random), y = any(random), first = 180 * any(random), sweep = 180 * (1 + any(random));
    if (round % 4 == 0) {
      const double radius = 1 + any(random);
      entity = fmt::format("0|ARC 10|{} 20|{} 40|{} 50|{} 51|{}", x, y, radius, first, first + sweep);
      for (int k = 0; k <= kSamples; ++k) {
        const double a = (first + sweep * k / kSamples) * kPi / 180;
        dense.push_back(placed(x + radius * std::cos(a), y + radius * std::sin(a)));
      }
    } else if (round % 4 == 1) {
      const double u = any(random), v = any(random), ratio = (1 + any(random)) / 2 + 0.01, a0 = first * kPi / 180;
      entity = fmt::format("0|ELLIPSE 10|{} 20|{} 11|{} 21|{} 40|{} 41|{} 42|{}", x, y, u, v, ratio, a0,
                           a0 + sweep * kPi / 180);
      for (int k = 0; k <= kSamples; ++k) {
        const double a = a0 + sweep * kPi / 180 * k / kSamples, c = std::cos(a), s = std::sin(a) * ratio;
        dense.push_back(placed(x + c * u - s * v, y + c * v + s * u));
      }
    } else if (round % 4 == 2) {
      // The bulge is the tangent of a quarter of the angle: the arc through both ends and a point that says so.
      const double x1 = any(random), y1 = any(random), angle = 1.9 * kPi * any(random), bulge = std::tan(angle / 4);
      entity = fmt::format("0|LWPOLYLINE 90|2 70|0 10|{} 20|{} 42|{} 10|{} 20|{}", x, y, bulge, x1, y1);
      const double chord = std::hypot(x1 - x, y1 - y), radius = chord / 2 / std::sin(angle / 2);
      const double along = std::atan2(y1 - y, x1 - x), begin = along - angle / 2 - kPi / 2;
      const double cx = x - radius * std::cos(begin), cy = y - radius * std::sin(begin);
      for (int k = 0; k <= kSamples; ++k) {
        const double a = begin + angle * k / kSamples;
        dense.push_back(placed(cx + radius * std::cos(a), cy + radius * std::sin(a)));
      }
    } else {
      const std::size_t degree = 1 + static_cast<std::size_t>(round) / 4 % 5, count = degree + 4;
      std::vector<double> knots(degree + 1, 0.0);
      for (std::size_t k = 1; k < count - degree; ++k) knots.push_back(knots.back() + 1.001 + any(random));
      knots.insert(knots.end(), degree + 1, knots.back() + 1);
      entity = fmt::format("0|SPLINE 70|4 71|{}", degree);
      for (const double knot : knots) entity += fmt::format(" 40|{}", knot);
      std::vector<Vec3d> points;
      for (std::size_t k = 0; k < count; ++k) {
        points.emplace_back(any(random), any(random), 1.5 + any(random));
        entity += fmt::format(" 10|{} 20|{} 30|0 41|{}", points.back()[0], points.back()[1], points.back()[2]);
      }
      std::vector<double> at(knots.begin(), knots.end() - static_cast<std::ptrdiff_t>(degree) - 1);
      for (int k = 0; k < kSamples; ++k) at.push_back(knots.back() * k / kSamples);
      std::sort(at.begin(), at.end());  // with the knots, where one of degree 1 has its corners
      for (const double t : at) {
        Vec3d sum(0.0);
        for (std::size_t i = 0; i < count; ++i)
          sum += Vec3d(points[i][0], points[i][1], 1) * (points[i][2] * basis(knots, i, degree, t));
        dense.push_back(placed(sum[0] / sum[2], sum[1] / sum[2]));
      }
      dense.push_back(placed(points.back()[0], points.back()[1]));
    }
    const std::string text = dxf_text::file(fmt::format("0|INSERT 2|b 10|3 20|4 41|{} 42|{} 50|{}", sx, sy, turn), "",
                                            "0|BLOCK 2|B 10|0 20|0 " + entity + " 0|ENDBLK");
    const std::vector<Vec3d> line = points_of(read(text, tolerance));
    const double off = apart(dense, line);
    INFO(entity);
    CHECK(off <= tolerance + 1e-4);  // samples are a hundredth apart at most, which adds h^2 / 8 r
    nearest_to_tolerance = std::max(nearest_to_tolerance, off / tolerance);
  }
  CHECK(nearest_to_tolerance > 0.9);  // there are no more points than needed
}

TEST_CASE("dxf: a spline of a circle is the circle", "[curves][io][dxf]") {
  // Nine points with weights, four quarters: the exact circle, and 2 pi by its length.
  const double w = std::sqrt(0.5);
  std::string entity = "0|SPLINE 70|12 71|2 40|0 40|0 40|0 40|1 40|1 40|2 40|2 40|3 40|3 40|4 40|4 40|4";
  const double corners[][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  for (int k = 0; k < 9; ++k) entity += fmt::format(" 10|{} 20|{} 41|{}", corners[k][0], corners[k][1], k % 2 ? w : 1);
  const std::vector<Vec3d> circle = drawn(entity, 1e-6);
  CHECK(circle.front() == circle.back());
  for (const Vec3d& p : circle) CHECK(p.length() == Approx(1).epsilon(1e-14));
  // A periodic one, which is not clamped at its ends, is closed as well: its ends are one but for rounding.
  entity = "0|SPLINE 70|3 71|3";
  for (int k = 0; k < 13; ++k) entity += fmt::format(" 40|{}", k * 0.1);
  for (int k = 0; k < 9; ++k)
    entity += fmt::format(" 10|{} 20|{}", std::cos(k % 6 * kPi / 3), std::sin(k % 6 * kPi / 3));
  const std::vector<Vec3d> ring = drawn(entity, 1e-4);
  CHECK(ring.front() == ring.back());
  CHECK(ring.size() > 20);
}

TEST_CASE("dxf: entities that are seen from below have their x to the left", "[curves][io][dxf]") {
  CHECK(drawn("0|LWPOLYLINE 90|2 70|0 38|2 10|1 20|2 10|3 20|4 210|0 220|0 230|-1") ==
        std::vector<Vec3d>{{-1, 2, -2}, {-3, 4, -2}});
  std::vector<Vec3d> arc = drawn("0|ARC 10|1 20|0 40|1 50|0 51|90 210|0 220|0 230|-1");
  CHECK(arc.front() == Vec3d(-2, 0, 0));
  CHECK(arc.back() == Vec3d(-1, 1, 0));
  // Lines are where they say, and an ellipse turns the other way round.
  CHECK(drawn("0|LINE 10|1 20|0 11|2 21|0 230|-1") == std::vector<Vec3d>{{1, 0, 0}, {2, 0, 0}});
  CHECK(drawn("0|ELLIPSE 10|0 20|0 11|2 21|0 40|0.5 41|0 42|1.5707963267948966 230|-1").back()[1] == Approx(-1));
  CHECK(drawn("0|CIRCLE 10|1 20|0 40|1 210|0 220|0 230|0") == drawn("0|CIRCLE 10|1 20|0 40|1"));
  CHECK_THAT(refusal(dxf_text::file("0|LINE 11|1 0|CIRCLE 10|1 20|0 40|1 210|1 220|0 230|0")),
             Catch::Contains("line 9: expected an extrusion direction of (0, 0, 1) or (0, 0, -1), got (1, 0, 0)"));
  CHECK_THAT(refusal(dxf_text::file("0|ELLIPSE 11|1 21|0 31|1 40|1")),
             Catch::Contains("an ELLIPSE in a plane z = constant"));
}

TEST_CASE("dxf: INSERT shows blocks moved, scaled, turned, in rows and in each other", "[curves][io][dxf]") {
  const std::string blocks =
      "0|BLOCK 8|0 2|Part 70|0 10|1 20|1 0|LINE 8|0 10|1 20|1 11|2 21|1 0|ENDBLK 8|0 "
      "0|BLOCK 8|0 2|pair 10|0 20|0 0|INSERT 2|PART 10|0 20|0 0|INSERT 2|part 10|5 20|0 50|90 0|ENDBLK";
  const auto shown = [&](const std::string& insert) {
    std::vector<std::vector<Vec3d>> curves;
    const io::CurveFile file = read(dxf_text::file(insert, "", blocks));
    for (std::size_t c = 0; c < file.file.polygons.face_count(); ++c) curves.push_back(points_of(file, c));
    return curves;
  };
  using Lines = std::vector<std::vector<Vec3d>>;
  CHECK(shown("0|INSERT 2|part 10|10 20|20") == Lines{{{10, 20, 0}, {11, 20, 0}}});
  CHECK(shown("0|INSERT 2|part 10|10 20|20 41|3 50|90") == Lines{{{10, 20, 0}, {10, 23, 0}}});
  CHECK(shown("0|INSERT 2|part 10|1 20|2 41|-1 230|-1") == Lines{{{-1, 2, 0}, {0, 2, 0}}});
  CHECK(shown("0|INSERT 2|pair 10|0 20|0 41|2 42|2") == Lines{{{0, 0, 0}, {2, 0, 0}}, {{10, 0, 0}, {10, 2, 0}}});
  CHECK(shown("0|INSERT 2|part 10|0 20|0 50|90 70|2 71|2 44|10 45|20") == Lines{{{0, 0, 0}, {0, 1, 0}},
                                                                                {{0, 10, 0}, {0, 11, 0}},
                                                                                {{-20, 0, 0}, {-20, 1, 0}},
                                                                                {{-20, 10, 0}, {-20, 11, 0}}});
  for (const char* const many : {"70|1073741824", "71|4294967296", "70|1e300", "70|1000001"})
    CHECK_THROWS_WITH(shown(fmt::format("0|INSERT 2|part 10|0 20|0 {}", many)),
                      Catch::Contains("INSERT of 1000000 entities at most"));
  // Circles under unlike scales are ellipses.
  const io::CurveFile ellipse =
      read(dxf_text::file("0|INSERT 2|c 41|3 42|2", "", "0|BLOCK 2|c 0|CIRCLE 10|0 20|0 40|1 0|ENDBLK"));
  for (const Vec3d& p : points_of(ellipse)) CHECK(std::hypot(p[0] / 3, p[1] / 2) == Approx(1).epsilon(1e-14));
}

TEST_CASE("dxf: a contour of lines and arcs that meet but for rounding is one closed curve", "[curves][io][dxf]") {
  // Coordinates and angles with six decimals, as most programs have them; pieces run either way.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(0, 1);
  for (int round = 0; round < 20; ++round) {
    constexpr int kCorners = 9;
    std::vector<Vec2d> corners;
    for (int k = 0; k < kCorners; ++k) {
      const double a = (k + 0.5 * any(random)) * 2 * kPi / kCorners, r = 60 + 30 * any(random);
      corners.emplace_back(300 + r * std::cos(a), 200 + r * std::sin(a));
    }
    std::string entities;
    for (int k = 0; k < kCorners; ++k) {
      const Vec2d a = corners[static_cast<std::size_t>(k)], b = corners[static_cast<std::size_t>((k + 1) % kCorners)];
      if (k % 3 == 0)
        entities += fmt::format("0|LINE 10|{:.6f} 20|{:.6f} 11|{:.6f} 21|{:.6f} ", a[0], a[1], b[0], b[1]);
      if (k % 3 == 1)
        entities += fmt::format("0|LINE 10|{:.6f} 20|{:.6f} 11|{:.6f} 21|{:.6f} ", b[0], b[1], a[0], a[1]);
      if (k % 3 != 2) continue;
      const Vec2d chord = b - a;
      const double length = chord.length(), radius = length * (0.6 + any(random)),
                   off = std::sqrt(radius * radius - length * length / 4);
      const Vec2d centre = (a + b) / 2 + Vec2d(-chord[1], chord[0]) / length * off;
      const auto degrees = [&](const Vec2d& p) { return std::atan2(p[1] - centre[1], p[0] - centre[0]) * 180 / kPi; };
      entities += fmt::format("0|ARC 10|{:.6f} 20|{:.6f} 40|{:.6f} 50|{:.6f} 51|{:.6f} ", centre[0], centre[1], radius,
                              degrees(a), degrees(b));
    }
    const io::CurveFile file = read(dxf_text::file(entities), 1e-2);
    CHECK(open_curves(file.file.polygons.view()).empty());
  }
  // A gap that is meant stays, as do both ends of a piece that is hardly longer than the gap.
  const auto open = [](const std::string& entities) {
    return open_curves(read(dxf_text::file(entities)).file.polygons.view()).size();
  };
  CHECK(open("0|LINE 10|0 20|0 11|100 21|0 0|LINE 10|100 20|0.0001 11|0 21|80") == 1);
  CHECK(open("0|LINE 10|0 20|0 11|100 21|0 0|LINE 10|100 20|0.001 11|0 21|80") == 2);
  CHECK(drawn("0|LINE 10|0 20|0 11|0.00002 21|0 0|LINE 10|0 20|50 11|100 21|50").back() == Vec3d(0.00002, 0, 0));
}

TEST_CASE("dxf: what is no curve or not shown stays out, and is told", "[curves][io][dxf]") {
  const io::CurveFile file = read(dxf_text::file(
      "0|LINE 8|cut 11|1 0|TEXT 8|cut 1|LINE 0|POINT 8|cut 0|TEXT 8|cut 0|LINE 8|Off 11|2 0|LINE 8|ice 11|3 0|LINE "
      "8|cut 60|1 11|4 "
      "0|LINE 8|cut 67|1 11|5 0|POLYLINE 8|cut 66|1 70|16 0|VERTEX 10|1 20|1 0|SEQEND 0|INSERT 8|off 2|b 0|INSERT "
      "8|ice 2|b",
      "", "0|BLOCK 2|b 0|LINE 8|0 10|7 11|8 0|LINE 8|cut 10|8 11|9 0|ENDBLK",
      "0|TABLE 2|LAYER 70|3 0|LAYER 2|CUT 70|0 62|7 0|LAYER 2|off 70|0 62|-7 0|LAYER 2|Ice 70|1 62|7 0|ENDTAB"));
  // Of the block on a layer that is off, what is on a layer of its own is shown.
  REQUIRE(file.file.polygons.face_count() == 2);
  CHECK(points_of(file, 1) == std::vector<Vec3d>{{8, 0, 0}, {9, 0, 0}});
  REQUIRE(file.file.remarks.size() == 2);
  CHECK(file.file.remarks[0] == "not curves, copied unchanged: 1 POINT, 1 POLYLINE, 2 TEXT");
  CHECK_THAT(file.file.remarks[1], Catch::Contains("6 in paper space, invisible, or on a layer that is off or frozen"));
}

TEST_CASE("dxf: curves of paper space are taken where model space has none", "[curves][io][dxf]") {
  const std::string paper = "0|LINE 8|0 67|1 10|1 20|2 11|5 21|2 0|CIRCLE 8|0 67|1 10|3 20|4 40|1 0|INSERT 67|1 2|b ",
                    block = "0|BLOCK 2|b 0|LINE 8|0 10|7 11|8 0|ENDBLK", text = "0|TEXT 8|0 1|a 0|VIEWPORT 67|1 8|0 ";
  const io::CurveFile file = read(dxf_text::file(text + paper, "", block));
  REQUIRE(file.file.polygons.face_count() == 3);
  CHECK(points_of(file) == std::vector<Vec3d>{{1, 2, 0}, {5, 2, 0}});
  CHECK(points_of(file, 2) == std::vector<Vec3d>{{7, 0, 0}, {8, 0, 0}});
  REQUIRE(file.file.remarks.size() == 3);
  CHECK(file.file.remarks[0] == "its curves are those of paper space, as model space has none");
  CHECK(file.file.remarks[1] == "not curves, copied unchanged: 1 VIEWPORT");
  // Written, they stay in paper space.
  std::vector<Vec3d> up = file.file.polygons.positions;
  for (Vec3d& p : up) p[1] += 1;
  const Folder folder;
  io::write_curves(folder.file("up.dxf"), file, up);
  const io::CurveFile again = io::read_curves(folder.file("up.dxf"));
  CHECK(again.file.polygons.positions == up);
  CHECK(again.file.remarks[0] == file.file.remarks[0]);
  // One curve in model space, and they stay out; one that is hidden there, and nothing is guessed.
  const std::string model = "0|LINE 8|0 11|9 ";
  const io::CurveFile beside = read(dxf_text::file(paper + model, "", block));
  CHECK(beside.file.polygons.face_count() == 1);
  CHECK_THAT(beside.file.remarks[0], Catch::Contains("3 in paper space"));
  CHECK_THAT(refusal(dxf_text::file(paper + model + "60|1", "", block)),
             Catch::Contains("expected a curve that is shown, got 1 entities that are invisible"));
}

TEST_CASE("dxf: a file tells its unit, or does not", "[curves][io][dxf]") {
  const auto unit = [](const std::string& header) {
    return read(dxf_text::file("0|LINE 11|1", header)).file.unit_micrometres;
  };
  CHECK(unit("") == std::nullopt);
  CHECK(unit("9|$INSUNITS 70|0") == std::nullopt);
  CHECK(unit("9|$INSUNITS 70|18") == std::nullopt);
  for (const auto& [number, size] :
       {std::pair{1, 25400.}, {2, 304800.}, {4, 1000.}, {5, 1e4}, {6, 1e6}, {13, 1.}, {14, 1e5}})
    CHECK(unit(fmt::format("9|$ACADVER 1|AC1015 9|$INSUNITS 70|{}", number)) == size);
}

TEST_CASE("dxf: what cannot be read is refused by its line", "[curves][io][dxf]") {
  const std::string line = "0|LINE 8|0 10|0 20|0 11|1 21|1 ";
  const auto of = [&](const std::string& entities) { return refusal(dxf_text::file(entities)); };
  CHECK_THAT(refusal("AutoCAD Binary DXF\r\n\x1a"), Catch::Contains("expected a DXF file in ASCII, got a binary one"));
  CHECK_THAT(refusal("AC1027"), Catch::Contains("got a DWG file"));
  CHECK_THAT(refusal("<svg/>"), Catch::Contains("line 1: expected a group code, got '<svg/>'"));
  CHECK_THAT(of(line + "0|SPLINE 70|8 71|3 74|2 11|0 21|0 11|1 21|1"),
             Catch::Contains("line 17: expected a SPLINE with control points, got one with fit points alone"));
  CHECK_THAT(of("0|SPLINE 71|3 40|0 40|1 10|0 20|0 10|1 20|1"),
             Catch::Contains("with 4 control points or more, got 2"));
  CHECK_THAT(of("0|SPLINE 71|1 40|0 40|1 10|0 20|0 10|1 20|1"),
             Catch::Contains("with 4 knots, for 2 control points and degree 1, got 2"));
  CHECK_THAT(of("0|SPLINE 71|1 40|0 40|0 40|1 40|0.5 10|0 20|0 10|1 20|1"), Catch::Contains("knots that do not fall"));
  CHECK_THAT(of("0|SPLINE 71|1 40|0 40|0 40|1 40|1 41|1 41|0 10|0 20|0 10|1 20|1"),
             Catch::Contains("weights above 0, got 0"));
  CHECK_THAT(of("0|SPLINE 71|1 40|0 40|0 40|1 40|1 40|2 40|2 10|0 20|0 10|1 20|1 10|2 20|1 10|3 20|1"),
             Catch::Contains("no knot more often than that, got 1 more often"));
  CHECK_THAT(of("0|LINE 10|x"), Catch::Contains("line 8: expected a number behind the group code 10, got 'x'"));
  CHECK_THAT(of("0|CIRCLE 40|-1"), Catch::Contains("a radius of 0 or more, got -1"));
  CHECK_THAT(of("0|TEXT 1|a"), Catch::Contains("expected a curve (LINE, LWPOLYLINE"));
  CHECK_THAT(of("0|INSERT 2|none"), Catch::Contains("expected a block 'none', got none of this name"));
  CHECK_THAT(of("0|POLYLINE 70|0 0|VERTEX 10|0 0|LINE 11|1"),
             Catch::Contains("expected 'VERTEX' or 'SEQEND', got 'LINE'"));
  const std::string whole = dxf_text::file(line);
  for (const std::size_t cut : {whole.size() - 8, whole.size() - 20, whole.size() / 2})
    CHECK_THAT(refusal(whole.substr(0, cut)), Catch::Contains("expected"));
  // Without the last line, all is there.
  CHECK(refusal(whole.substr(0, whole.size() - 6)).empty());
}

}  // namespace dxf_shapes
