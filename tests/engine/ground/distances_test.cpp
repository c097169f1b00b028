// SPDX-License-Identifier: Apache-2.0
#include <tbb/task_arena.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "space/surface/surface.h"
#include "support/bytes.h"
#include "support/expressions.h"
#include "support/oracles.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Points on a spiral, which have no two coordinates in common.
std::vector<Vec3d> spiral(std::size_t count) {
  std::vector<Vec3d> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    points[i] = {t * std::cos(t), t * std::sin(t), t - 7};
  }
  return points;
}

using Numbers = std::vector<double>;

}  // namespace

TEST_CASE("expression: values are those of the formula", "[distances]") {
  const double pi = std::numbers::pi;
  const std::vector<std::pair<std::string, double>> cases = {
      {"5", 5},
      {" 1e-3 ", 1e-3},
      {".5+5.", 5.5},
      {"x+10*y+100*z", 321},
      {"nx+10*ny+100*nz", 86},
      {"u+10*v", 7.75},
      {"pi", pi},
      {"2*e", 2 * std::numbers::e},
      {"x-y-z", -4},
      {"z/y/2", 0.75},
      {"2^3^2", 512},
      {"-2^2", -4},
      {"2^-1", 0.5},
      {"1 - -x", 2},
      {"- - + x", 1},
      {"2*-3", -6},
      {"(x + y) * z", 9},
      {"1 < 2", 1},
      {"2 <= 1", 0},
      {"0.5 && 1", 1},  // which muParser's optimiser takes for 0
      {"x > 5 || z == 3", 1},
      {"x != 1", 0},
      {"x > 0 ? 1 : 2", 1},
      {"x > 0 ? y > 5 ? 1 : 2 : 3", 2},
      {"x > 5 ? 1 : y > 5 ? 2 : z > 5 ? 3 : 4", 4},
      {"(x > 0 ? 1 : 2) + 10", 11},
      {"x > 0 ? 1 : 2 + 10", 1},
      {"-(x > 5 ? 1 : 2)", -2},
      {"max(x > 0 ? 1 : 2, 0.5, -7)", 1},
      {"min(z, max(x, y), 7)", 2},
      {"sum(x, y, z, 4)", 10},
      {"sin (pi / 2)", 1},
      {"4 * atan2(1, 1)", pi},
      {"sqrt(abs(-16))", 4},
      {"log(e^2)", 2},
      {"0.1 + 0.05*sin(4*pi*z)", 0.1 + 0.05 * std::sin(4 * pi * 3)},
      {"x\t+\ny", 3},
      {"5%", 10},
      {"x + y %", 6},
      {"nz > 0 ? 1 : 0.5 %", 2},
  };
  for (const auto& [text, expected] : cases) {
    CAPTURE(text);
    CHECK(value_of(text) == Approx(expected).epsilon(1e-15).margin(1e-16));
  }
}

TEST_CASE("expression: what is wrong is told with its column", "[distances]") {
  const std::string operand = "a number, a name, a function or '('";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"0.1*foo", "column 5: unknown name 'foo' (there are x, y, z, nx, ny, nz, u, v, edge, pi, e)"},
      {"_pi", "column 1: unknown name '_pi' (there are x, y, z, nx, ny, nz, u, v, edge, pi, e)"},
      {"", "column 1: expected " + operand + ", got the end"},
      {"  ", "column 3: expected " + operand + ", got the end"},
      {"x + ", "column 5: expected " + operand + ", got the end"},
      {"x * / y", "column 5: expected " + operand + ", got '/'"},
      {"x ** 2", "column 4: expected " + operand + ", got '*' (powers are written with '^')"},
      {"x=3", "column 2: expected an operator or the end, got '=' (nothing is assigned here; '==' compares)"},
      {"(x=3)", "column 3: expected an operator or ')', got '=' (nothing is assigned here; '==' compares)"},
      {"min(x=3, 1)", "column 6: expected an operator, ',' or ')', got '=' (nothing is assigned here; '==' compares)"},
      {"0,5",
       "column 2: expected an operator or the end, got ',' (the decimal point is '.'; ',' stands between arguments)"},
      {"(1,2)",
       "column 3: expected an operator or ')', got ',' (the decimal point is '.'; ',' stands between arguments)"},
      {"5% * x", "column 4: expected nothing behind '%', got '*'"},
      {"(5%)", "column 3: expected an operator or ')', got '%' (it stands behind the whole expression)"},
      {"%", "column 1: expected " + operand + ", got '%' (it stands behind the whole expression)"},
      {"2x", "column 2: expected an operator or the end, got 'x'"},
      {"x y", "column 3: expected an operator or the end, got 'y'"},
      {"x(3)", "column 2: expected an operator or the end, got '('"},
      {"(x", "column 3: expected an operator or ')', got the end"},
      {"x)", "column 2: expected an operator or the end, got ')'"},
      {"x ? 1", "column 6: expected an operator or ':', got the end"},
      {"x : 1", "column 3: expected an operator or the end, got ':'"},
      {"sin", "column 4: expected '(' behind the function 'sin', got the end"},
      {"sin x", "column 5: expected '(' behind the function 'sin', got 'x'"},
      {"1+sin()", "column 3: expected 1 argument of 'sin', got 0"},
      {"sin(1,2)", "column 1: expected 1 argument of 'sin', got 2"},
      {"atan2(1)", "column 1: expected 2 arguments of 'atan2', got 1"},
      {"min()", "column 1: expected one argument or more of 'min', got 0"},
      {"min(1,)", "column 7: expected an argument, got ')'"},
      {"min(1", "column 6: expected an operator, ',' or ')', got the end"},
      {"\"text\"", "column 1: expected " + operand + ", got '\"'"},
      {"!x", "column 1: expected " + operand + ", got '!'"},
      {"x & y", "column 3: expected an operator or the end, got '&'"},
      {"1e999", "column 1: expected a number that a double can hold, got '1e999'"},
      {".", "column 1: expected " + operand + ", got '.'"},
      {"\xc3\xa4 + x", "column 1: expected " + operand + ", got '\xc3\xa4'"},
      {"x + \xc3\xa4\xc3\xa4 ", "column 5: expected " + operand + ", got '\xc3\xa4'"},
      {"x \xc2\xb7 foo", "column 3: expected an operator or the end, got '\xc2\xb7'"},
  };
  for (const auto& [text, expected] : cases) CHECK(complaint(text) == "distance '" + text + "': " + expected);
  CHECK_THAT(complaint("1 + foo(x)"),
             Catch::StartsWith("distance '1 + foo(x)': column 5: unknown function 'foo' (there "
                               "are abs, acos, acosh, asin, ") &&
                 Catch::Contains("sqrt"));
  // Columns count characters, not bytes.
  CHECK_THAT(complaint("x \xc3\xa4"), Catch::Contains("column 3:"));
  CHECK_THAT(complaint("x +\n foo"), Catch::Contains("distance 'x +  foo': column 6:"));
}

TEST_CASE("expression: no text is too long or too deep to be refused in order", "[distances]") {
  const auto nested = [](int depth, const std::string& open, const std::string& inside, const std::string& close) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += open;
    text += inside;
    for (int i = 0; i < depth; ++i) text += close;
    return text;
  };
  CHECK(value_of(nested(90, "(", "x", ")")) == 1);
  CHECK(value_of(nested(90, "x>1?0:", "x", "")) == 1);
  CHECK(value_of(nested(90, "x?", "x", ":0")) == 1);
  CHECK(value_of(nested(90, "-(1+", "0", ")")) == 0);
  CHECK(value_of(nested(60, "min(1,", "x", ")*x")) == 1);
  CHECK(value_of(nested(900, "-", "x", "")) == 1);
  CHECK(value_of(nested(900, "1+", "x", "")) == 901);
  CHECK_THAT(complaint(nested(900, "(", "x", ")")), Catch::Contains("at most 100 levels of parentheses"));
  CHECK_THAT(complaint(nested(900, "1?", "x", "")), Catch::Contains("at most 100 levels of parentheses"));
  CHECK_THAT(complaint(std::string(2001, ' ')), Catch::Contains("expected at most 2000 bytes, got 2001"));
  CHECK_THAT(complaint(std::string(100000, '(')), Catch::Contains("expected at most 2000 bytes, got 100000"));
}

TEST_CASE("expression: it knows what it uses, and wants that for every vertex", "[distances]") {
  const DistanceExpression plain("0.1*x + pi"), normals("nz"), texture("v %");
  CHECK((plain.uses("x") && plain.uses("pi") && !plain.uses("y") && !plain.uses("e") && !plain.uses("nx")));
  CHECK((!plain.uses_normals() && !plain.uses_texture() && !plain.is_percent()));
  CHECK((normals.uses_normals() && normals.uses("nz") && !normals.uses("z") && !normals.uses_texture()));
  CHECK((texture.uses_texture() && !texture.uses_normals() && texture.is_percent()));
  CHECK(DistanceExpression("exp(1)").uses("e") == false);

  const std::vector<Vec3d> positions = spiral(3), two = spiral(2);
  CHECK(plain({positions, {}, {}, 1}).size() == 3);
  CHECK(message<InvalidInput>([&] {
          normals({positions, {}, {}, 1});
        }) == "distance 'nz': expected 3 normals, which it uses, got 0");
  CHECK(message<InvalidInput>([&] {
          normals({positions, two, {}, 1});
        }) == "distance 'nz': expected 3 normals, which it uses, got 2");
  CHECK(message<InvalidInput>([&] {
          texture({positions, {}, {}, 1});
        }) == "distance 'v %': expected 3 texture coordinates, which it uses, got 0");
  CHECK(plain({}).empty());
}

TEST_CASE("expression: the first vertex without a finite distance is named", "[distances]") {
  std::vector<Vec3d> positions = spiral(100000);
  const DistanceExpression inverse("1/x"), root("sqrt(x)"), share("y %");
  const auto complaint_at = [&](const DistanceExpression& distance, double diagonal = 1) {
    return message<InvalidInput>([&] { distance({positions, {}, {}, diagonal}); });
  };
  for (Vec3d& p : positions) p[0] = std::abs(p[0]) + 1;
  CHECK(complaint_at(inverse).empty());
  for (const std::size_t v : {70000u, 40000u, 99999u}) positions[v][0] = 0;
  CHECK(complaint_at(inverse) == "distance '1/x': expected a finite number at vertex 40000 (counted from 0), got inf");
  positions[7][0] = -1;
  CHECK_THAT(complaint_at(root), Catch::StartsWith("distance 'sqrt(x)': expected a finite number at vertex 7 (counted "
                                                   "from 0), got ") &&
                                     Catch::EndsWith("nan"));
  CHECK_THAT(complaint_at(share, kInfinity), Catch::Contains("at vertex 0 "));
}

TEST_CASE("expression: any number of threads gives the same bytes", "[distances]") {
  const std::vector<Vec3d> positions = spiral(100001);
  const DistanceExpression distance("0.1 + 0.05*sin(4*pi*z) + (x > y ? x*y : exp(-y^2))/7 %");
  const auto with_threads = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return distance({positions, {}, {}, 3}); });
  };
  const Numbers one = with_threads(1);
  for (const int threads : {2, 3, 8}) {
    const Numbers many = with_threads(threads);
    CHECK(std::memcmp(one.data(), many.data(), one.size() * sizeof(double)) == 0);
  }
  for (const std::size_t v : {std::size_t{0}, std::size_t{16383}, std::size_t{16384}, one.size() - 1}) {
    const auto& [x, y, z] = std::tuple(positions[v][0], positions[v][1], positions[v][2]);
    const double expected = 0.1 + 0.05 * std::sin(4 * std::numbers::pi * z) + (x > y ? x * y : std::exp(-(y * y))) / 7;
    CHECK(one[v] == Approx(expected / 100 * 3).epsilon(1e-14));
  }
}

TEST_CASE("normals: those of a welded box point along its diagonals", "[distances]") {
  // Each corner has one or two triangles on each of its three sides, so that only angles weigh them evenly.
  const Polygons shared = shapes::box(Vec3d(1), 1, true), torn = test::torn(shared);
  for (const Polygons* mesh : {&shared, &torn}) {
    const std::vector<Vec3d> normals = vertex_normals(mesh->view());
    REQUIRE(normals.size() == mesh->positions.size());
    for (std::size_t v = 0; v < normals.size(); ++v) CHECK((normals[v] - mesh->positions[v].unit()).length() < 1e-15);
  }
  WeldOptions apart;
  apart.enabled = false;
  const std::vector<Vec3d> sides = vertex_normals(torn.view(), apart);
  for (std::size_t v = 0; v < sides.size(); ++v) CHECK(sides[v].dot(torn.positions[v]) == Approx(0.5));
}

TEST_CASE("normals: orientation, unused vertices and vertices without a side", "[distances]") {
  Polygons ball = shapes::icosphere(2, 2);
  for (std::size_t f = 0; f < ball.face_count(); ++f) std::swap(ball.corners[3 * f], ball.corners[3 * f + 1]);
  ball.positions.insert(ball.positions.begin() + 5, Vec3d(7, 7, 7));
  for (auto& v : ball.corners) v += v >= 5;
  for (const Orient orient : {Orient::Keep, Orient::FixDirectionOnly}) {
    const std::vector<Vec3d> normals = vertex_normals(ball.view(), {}, orient);
    CHECK(normals[5] == Vec3d(0.0));
    for (std::size_t v = 0; v < normals.size(); ++v) {
      if (v == 5) continue;
      CHECK(normals[v].length() == Approx(1).epsilon(1e-15));
      // Of a ball of 320 triangles, to a degree or two.
      CHECK(normals[v].dot(ball.positions[v].unit()) * (orient == Orient::Keep ? -1 : 1) > 0.999);
    }
  }
  Polygons line;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.add_face({0, 1, 2});
  CHECK(vertex_normals(line.view()) == std::vector<Vec3d>(3, Vec3d(0.0)));
  CHECK_THROWS_AS(vertex_normals(Polygons().view()), InvalidInput);
}
