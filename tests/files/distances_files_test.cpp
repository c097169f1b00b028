// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <clocale>
#include <limits>
#include <locale>
#include "bytes/compression.h"
#include "support/bytes.h"
#include "support/expressions.h"
#include "support/folder.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace distances_files {
namespace {

using Numbers = std::vector<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

template <class T>
std::string row(std::initializer_list<T> values, bool swap = false) {
  std::string bytes;
  for (const T value : values) bytes += raw(value, swap);
  return bytes;
}

std::string npy_with(const std::string& header, const std::string& numbers, char version = 1) {
  const std::string start = std::string("\x93NUMPY", 6) + version + '\0';
  const auto length = static_cast<std::uint32_t>(header.size());
  return start + (version == 1 ? raw(static_cast<std::uint16_t>(length)) : raw(length)) + header + numbers;
}

std::string npy(const std::string& type, const std::string& shape, const std::string& numbers, char version = 1) {
  return npy_with("{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }    \n", numbers,
                  version);
}

std::string refusal(const std::string& bytes, std::size_t count, const std::string& name = "d") {
  return message<InvalidInput>([&] { io::parse_vertex_numbers(name, bytes, count); });
}

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

}  // namespace distances_files
