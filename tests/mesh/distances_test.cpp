// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <catch2/catch.hpp>
#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <numbers>

#include "support/bytes.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/base/compression.h"
#include "vdb_offset/scene.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One vertex whose variables all differ: x y z = 1 2 3, nx ny nz = 0 0.6 0.8, u v = 0.25 0.75; a diagonal of 200.
double value_of(const std::string& expression) {
  const std::vector<Vec3d> position = {{1, 2, 3}}, normal = {{0, 0.6, 0.8}};
  const std::vector<Vec2d> texture = {{0.25, 0.75}};
  return DistanceExpression(expression)({position, normal, texture, 200}).at(0);
}

/// What the exception says; empty if there is none.
template <class Exception, class Work>
std::string message(Work&& work) {
  try {
    work();
  } catch (const Exception& error) {
    return error.what();
  }
  return {};
}

std::string complaint(const std::string& expression) {
  return message<InvalidExpression>([&] { DistanceExpression{expression}; });
}

/// Points on a spiral, which have no two coordinates in common.
std::vector<Vec3d> spiral(std::size_t count) {
  std::vector<Vec3d> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    points[i] = {t * std::cos(t), t * std::sin(t), t - 7};
  }
  return points;
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

std::string npy_with(const std::string& header, const std::string& numbers, char version = 1) {
  const std::string start = std::string("\x93NUMPY", 6) + version + '\0';
  const auto length = static_cast<std::uint32_t>(header.size());
  return start + (version == 1 ? raw(static_cast<std::uint16_t>(length)) : raw(length)) + header + numbers;
}

std::string npy(const std::string& type, const std::string& shape, const std::string& numbers, char version = 1) {
  return npy_with("{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }    \n", numbers,
                  version);
}

template <class T>
std::string row(std::initializer_list<T> values, bool swap = false) {
  std::string bytes;
  for (const T value : values) bytes += raw(value, swap);
  return bytes;
}

std::string refusal(const std::string& bytes, std::size_t count, const std::string& name = "d") {
  return message<InvalidInput>([&] { io::parse_vertex_numbers(name, bytes, count); });
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
      {"0.1*foo", "column 5: unknown name 'foo' (there are x, y, z, nx, ny, nz, u, v, pi, e)"},
      {"_pi", "column 1: unknown name '_pi' (there are x, y, z, nx, ny, nz, u, v, pi, e)"},
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

TEST_CASE("expression: a locale with a decimal comma changes nothing", "[distances]") {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // where there is one
  const double value = value_of("1.5 + 1000.25*x");
  const std::string error = complaint("1,5");
  const Numbers numbers = io::parse_vertex_numbers("d", "1.5 1234.5", 2);
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  CHECK(value == 1001.75);
  CHECK_THAT(error, Catch::Contains("column 2"));
  CHECK(numbers == Numbers{1.5, 1234.5});
}

TEST_CASE("normals: those of a welded box point along its diagonals", "[distances]") {
  // Each corner has one or two triangles on each of its three sides, so that only angles weigh them evenly.
  const Polygons shared = scene::box(Vec3d(1), 1, true), torn = test::torn(shared);
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
  Polygons ball = scene::icosphere(2, 2);
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

TEST_CASE("texture: the first corner that has coordinates gives them to its vertex", "[distances]") {
  const io::MeshFile seam =
      io::parse_mesh("a.obj", io::Format::Obj,
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\nvt 0.1 0.2\nvt 0.3 0.4\nvt 0.5 0.6\n"
                     "f 1/2 2/1 3\nf 2/3 4 3/3\n");
  const std::vector<Vec2d> texture = io::vertex_texture(seam);
  REQUIRE(texture.size() == 5);
  CHECK(texture[0] == Vec2d(0.3, 0.4));
  CHECK(texture[1] == Vec2d(0.1, 0.2));
  CHECK(texture[2] == Vec2d(0.5, 0.6));
  CHECK((std::isnan(texture[3][0]) && std::isnan(texture[3][1])));
  CHECK(texture[4] == Vec2d(0, 0));
  const auto evaluate = [&](const char* expression) {
    return DistanceExpression(expression)({seam.polygons.positions, {}, texture, 1});
  };
  CHECK_THAT(message<InvalidInput>([&] { evaluate("u"); }), Catch::Contains("at vertex 3 (counted from 0), got nan"));
  CHECK(evaluate("x > 0.5 && y > 0.5 ? 7 : v") == Numbers{0.4, 0.2, 0.6, 7, 7});
}

TEST_CASE("texture: coordinates of vertices, and a file without any", "[distances]") {
  const io::MeshFile off =
      io::parse_mesh("a.off", io::Format::Off, "STOFF\n3 1 0\n0 0 0 0.5 1\n1 0 0 0.25 0\n0 1 0 0 0.125\n3 0 1 2\n");
  CHECK(io::vertex_texture(off) == std::vector<Vec2d>{{0.5, 1}, {0.25, 0}, {0, 0.125}});
  const io::MeshFile none = io::parse_mesh("b.obj", io::Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(message<InvalidInput>([&] { io::vertex_texture(none); }) ==
        "b.obj: expected texture coordinates, which the distance uses (u, v), found none");
}

TEST_CASE("vertex numbers: text", "[distances]") {
  const Folder folder;
  const Numbers expected = {0.5, -1e-3, 2, 1e300, 0};
  const std::string text = "# thickness\n0.5 -1e-3\r\n\n+2 # near\n\t1e300\n0";
  CHECK(io::read_vertex_numbers(folder.write("a.txt", text), 5) == expected);
  CHECK(io::read_vertex_numbers(folder.write("b.csv", "\xef\xbb\xbf" + text + "\n"), 5) == expected);
  CHECK(io::read_vertex_numbers(folder.write("c.gz", io::compress(io::Compression::Gzip, text)), 5) == expected);
  CHECK(io::read_vertex_numbers(folder.write("d.zst", io::compress(io::Compression::Zstd, text)), 5) == expected);
  CHECK(io::read_vertex_numbers(folder.write("e", ""), 0).empty());
  CHECK_THROWS_AS(io::read_vertex_numbers(folder.file("missing"), 5), ReadError);

  CHECK(refusal(text, 4) == "d: expected 4 numbers, one for each vertex, found 5");
  CHECK(refusal(text, 6) == "d: expected 6 numbers, one for each vertex, found 5");
  CHECK(refusal("", 1) == "d: expected 1 numbers, one for each vertex, found 0");
  CHECK(refusal("1 2\n3 4x 5", 5) == "d, line 2: expected a number for vertex 3 (counted from 0), got '4x'");
  CHECK(refusal("1,2", 2) == "d, line 1: expected a number for vertex 0 (counted from 0), got '1,2'");
  CHECK(refusal("1\n2\nnan", 3) == "d, line 3: expected a finite number for vertex 2 (counted from 0), got 'nan'");
  CHECK(refusal("1 -inf", 2) == "d, line 1: expected a finite number for vertex 1 (counted from 0), got '-inf'");
  CHECK(refusal("1e999", 1) == "d, line 1: expected a finite number for vertex 0 (counted from 0), got '1e999'");
  CHECK(refusal("1 2", 1000000000000) == "d: expected 1000000000000 numbers, one for each vertex, found 2");
}

TEST_CASE("vertex numbers: every type of a NumPy array, in both byte orders", "[distances]") {
  using io::parse_vertex_numbers;
  for (const bool big : {false, true}) {
    const std::string order = big ? ">" : "<";
    const auto read = [&](const std::string& type, const std::string& numbers) {
      return parse_vertex_numbers("d", npy(order + type, "(3,)", numbers), 3);
    };
    CHECK(read("f4", row({0.5f, -2.f, 3e30f}, big)) == Numbers{0.5, -2, static_cast<double>(3e30f)});
    CHECK(read("f8", row({0.1, -2.0, 1e300}, big)) == Numbers{0.1, -2, 1e300});
    CHECK(read("i1", row<std::int8_t>({1, -1, 127})) == Numbers{1, -1, 127});
    CHECK(read("u1", row<std::uint8_t>({1, 200, 255})) == Numbers{1, 200, 255});
    CHECK(read("i2", row<std::int16_t>({1, -2, 32767}, big)) == Numbers{1, -2, 32767});
    CHECK(read("u2", row<std::uint16_t>({1, 258, 65535}, big)) == Numbers{1, 258, 65535});
    CHECK(read("i4", row<std::int32_t>({1, -2, 1 << 30}, big)) == Numbers{1, -2, 1 << 30});
    CHECK(read("u4", row<std::uint32_t>({1, 2, 0xffffffff}, big)) == Numbers{1, 2, 0xffffffff});
    CHECK(read("i8", row<std::int64_t>({1, -2, std::int64_t{1} << 40}, big)) == Numbers{1, -2, 0x1p40});
    CHECK(read("u8", row<std::uint64_t>({1, 2, std::uint64_t{1} << 63}, big)) == Numbers{1, 2, 0x1p63});
  }
  const Numbers expected = {1, 2.5};
  const std::string numbers = row({1.0, 2.5});
  for (const char version : {1, 2, 3})
    CHECK(parse_vertex_numbers("d", npy("<f8", "(2,)", numbers, version), 2) == expected);
  CHECK(parse_vertex_numbers("d", npy("<f8", "(2, 1)", numbers), 2) == expected);
  CHECK(parse_vertex_numbers("d", npy("<f8", "(2L,)", numbers), 2) == expected);
  CHECK(parse_vertex_numbers("d", npy("|u1", "(2,)", "\x01\x02"), 2) == Numbers{1, 2});
  CHECK(parse_vertex_numbers("d", npy_with("{\"shape\":(2,1),\"fortran_order\":True,\"descr\":\"<f8\"}", numbers), 2) ==
        expected);
  const Folder folder;
  const std::string file = npy("<f8", "(2,)", numbers);
  CHECK(io::read_vertex_numbers(folder.write("a.npy", file), 2) == expected);
  CHECK(io::read_vertex_numbers(folder.write("a.npy.gz", io::compress(io::Compression::Gzip, file)), 2) == expected);
}

TEST_CASE("vertex numbers: a NumPy array that will not do", "[distances]") {
  const std::string two = row({1.0, 2.5}), good = npy("<f8", "(2,)", two);
  const std::string types = "expected numbers of the types f4, f8, i1 to i8 or u1 to u8, got ";
  CHECK(refusal(good, 3) == "d: expected 3 numbers, one for each vertex, found 2");
  CHECK(refusal(npy("<f8", "(18446744073709551615,)", two), 2) ==
        "d: expected 2 numbers, one for each vertex, found 18446744073709551615");
  CHECK(refusal(npy("<f8", "(1000000000000,)", two), 1000000000000) ==
        "d, byte 84: expected 1000000000000 numbers of 8 bytes, got 16 bytes");
  CHECK(refusal(npy("<f8", "(2,)", two + "x"), 2) == "d, byte 72: expected 2 numbers of 8 bytes, got 17 bytes");
  CHECK(refusal(npy("<f8", "(2,)", row({1.0, -kInfinity})), 2) ==
        "d, byte 80: expected a finite number for vertex 1 (counted from 0), got -inf");
  for (const char* type : {"<c8", "<f2", "<f1", "|b1", "<U4", "=f8", "|f8", "f8", "<i3", "<f16", ""})
    CHECK(refusal(npy(type, "(2,)", two), 2) == fmt::format("d, byte 20: {}'{}'", types, type));
  CHECK(refusal(npy_with("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (2,), }", two), 2) ==
        "d, byte 20: " + types + "[('a', '<f8')], 'fortran...");
  for (const char* shape : {"()", "(2, 2)", "(1, 2)", "(2, 1, 1)"})
    CHECK(refusal(npy("<f8", shape, two), 2) ==
          fmt::format("d, byte 60: expected an array of shape (n,) or (n, 1), got {}", shape));
  CHECK_THAT(refusal(npy("<f8", "(-2,)", two), 2), Catch::Contains("byte 61: expected a number of rows, got -2,)"));
  CHECK_THAT(refusal(npy("<f8", "(99999999999999999999,)", two), 2), Catch::Contains("expected a number of rows"));
  CHECK_THAT(refusal(npy("<f8", "2", two), 2), Catch::Contains("byte 60: expected '('"));

  CHECK(refusal(std::string("\x93NUMPY\x09\0\0\0", 10), 2) ==
        "d, byte 6: expected version 1, 2 or 3 of NumPy's format, got version 9");
  CHECK(refusal(std::string("\x93NUMPY\x02\0\xff\xff\xff\xff", 12), 2) ==
        "d, byte 12: expected a header of 4294967295 bytes, got the end of the file");
  CHECK(refusal(npy_with("{'descr': '<f8', 'shape': (2,)}", two), 2) ==
        "d, byte 40: expected the keys 'descr', 'fortran_order' and 'shape' before this, got }");
  CHECK_THAT(refusal(npy_with("{'shape': (2,), 'shape': (2,)}", two), 2), Catch::Contains("byte 26: expected each of"));
  CHECK_THAT(refusal(npy_with("{'colour': 1}", two), 2), Catch::Contains("byte 11: expected each of the keys"));
  // Cut short anywhere, it is refused; so is text under that ending.
  for (std::size_t size = 0; size < good.size(); ++size) {
    CAPTURE(size);
    CHECK_FALSE(refusal(good.substr(0, size), 2).empty());
  }
  CHECK(refusal("1 2", 2, "d.npy.gz") ==
        "d.npy.gz, byte 0: expected a NumPy array, which starts with \\x93NUMPY, got something else");
}

namespace {

const std::string kPlyElements =
    "element camera 1\nproperty list uchar float view\nproperty int id\nelement vertex 3\nproperty float x\n"
    "property list uchar short ring\nproperty float y\nproperty uchar level\nproperty float z\n"
    "property float thickness\nproperty short depth\nproperty double fine\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n";

io::MeshFile ply_of(const std::string& encoding, const std::string& body) {
  return io::parse_mesh("a.ply", io::Format::Ply, "ply\nformat " + encoding + " 1.0\n" + kPlyElements + body);
}

io::MeshFile binary_ply_with(bool big, float thickness) {
  std::string body = raw(std::uint8_t{2}) + raw(1.5f, big) + raw(2.5f, big) + raw(7, big);
  for (int v = 0; v < 3; ++v) {
    body += raw(static_cast<float>(v == 1), big) + raw(static_cast<std::uint8_t>(v));
    for (int k = 0; k < v; ++k) body += raw(std::int16_t{-9}, big);
    body += raw(static_cast<float>(v == 2), big) + raw(static_cast<std::uint8_t>(200 + v)) + raw(0.f, big);
    body += raw(v == 1 ? thickness : 0.25f, big) + raw(static_cast<std::int16_t>(-v), big) + raw(0.1 * v, big);
  }
  body += raw(std::uint8_t{3}) + raw(0, big) + raw(1, big) + raw(2, big);
  return ply_of(big ? "binary_big_endian" : "binary_little_endian", body);
}

}  // namespace

TEST_CASE("vertex property: of a PLY in every encoding, beside lists and other elements", "[distances]") {
  const std::string text =
      "2 1.5 2.5 7\n0 0 0 200 0 0.1 0 0\n1 1 -9 0 201 0 0.5 -1 0.1\n0 2 -9 -9 1 202 0 0.25 -2 0.2\n3 0 1 2\n";
  const io::MeshFile ascii = ply_of("ascii", text);
  // Declared as float, which is all that anyone reads of it.
  CHECK(io::vertex_property(ascii, "thickness") == Numbers{static_cast<double>(0.1f), 0.5, 0.25});
  CHECK(io::vertex_property(ascii, "fine") == Numbers{0, 0.1, 0.2});
  for (const io::MeshFile& file : {binary_ply_with(false, 0.5), binary_ply_with(true, 0.5)}) {
    CHECK(io::vertex_property(file, "thickness") == Numbers{0.25, 0.5, 0.25});
    CHECK(io::vertex_property(file, "level") == Numbers{200, 201, 202});
    CHECK(io::vertex_property(file, "depth") == Numbers{0, -1, -2});
    CHECK(io::vertex_property(file, "fine") == Numbers{0, 0.1, 0.2});
    CHECK(io::vertex_property(file, "x") == Numbers{0, 1, 0});
  }
  const auto complaint_of = [](const io::MeshFile& file, const char* name) {
    return message<InvalidInput>([&] { io::vertex_property(file, name); });
  };
  for (const char* name : {"thick", "ring", "id", ""})
    CHECK_THAT(complaint_of(ascii, name),
               Catch::StartsWith(fmt::format(
                   "a.ply: expected a vertex property '{}' of single numbers, found none (there are ", name)) &&
                   Catch::EndsWith(" and 2 more)"));
  CHECK_THAT(complaint_of(ascii, "thick"), Catch::Contains("there are thickness, "));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    return ply_of("ascii", std::string(text).replace(text.find(from), from.size(), to));
  };
  CHECK(complaint_of(replaced("0.5 -1", "nan -1"), "thickness") ==
        "a.ply, line 20: expected a finite number 'thickness' for vertex 1 (counted from 0), got 'nan'");
  CHECK(complaint_of(replaced("0.5 -1", "1e39 -1"), "thickness") ==
        "a.ply, line 20: expected a finite number 'thickness' for vertex 1 (counted from 0), got '1e39'");
  CHECK(complaint_of(replaced("0.5 -1", "some -1"), "thickness") ==
        "a.ply, line 20: expected a finite number 'thickness' for vertex 1 (counted from 0), got 'some'");
  CHECK_THAT(complaint_of(binary_ply_with(true, static_cast<float>(kInfinity)), "thickness"),
             Catch::Contains("expected a finite number 'thickness' for vertex 1 (counted from 0), got inf"));
  const io::MeshFile obj = io::parse_mesh("b.obj", io::Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(complaint_of(obj, "thickness") ==
        "b.obj: expected a PLY file, whose vertices can have a property 'thickness', found obj");
}
