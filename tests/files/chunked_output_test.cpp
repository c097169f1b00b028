// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "support/folder.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

io::Section numbers(std::size_t count, const char* kind) {
  return {count, [kind](std::string& text, std::size_t i) { text += fmt::format("{} {}\n", kind, i); }};
}

std::string as_text(std::size_t count, const char* kind) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += fmt::format("{} {}\n", kind, i);
  return text;
}

/// A file of one format, converted to another.
std::string bytes_of(const std::string& from, const std::string& bytes, const std::string& to) {
  const Folder folder;
  const io::MeshFile file = io::parse_mesh("in." + from, *io::format_of("in." + from), bytes);
  io::write_mesh(folder.file("out." + to), file, file.polygons.positions);
  return slurp(folder.file("out." + to));
}

}  // namespace

TEST_CASE("chunked output: a header, and all items of all sections in their order", "[chunked_output]") {
  // A piece holds 32,768 items.
  for (const std::size_t count : {0U, 1U, 32767U, 32768U, 32769U, 100000U}) {
    const io::Pieces pieces = io::in_sections("head\n", {numbers(count, "v"), numbers(3, "f")});
    CHECK(io::join(pieces) == "head\n" + as_text(count, "v") + as_text(3, "f"));
  }
  CHECK(io::join(io::in_sections("", {})).empty());
}

TEST_CASE("chunked output: files in a row, and in files", "[chunked_output]") {
  const io::Pieces both = io::in_a_row({io::in_sections("a\n", {numbers(40000, "v")}), io::in_sections("b\n", {})});
  const std::string text = "a\n" + as_text(40000, "v") + "b\n";
  CHECK(io::join(both) == text);
  const Folder folder;
  io::write_pieces(folder.file("out.txt"), both);
  CHECK(slurp(folder.file("out.txt")) == text);
  for (const char* const name : {"out.txt.gz", "out.txt.zst"}) {
    io::write_pieces(folder.file(name), both);
    CHECK(slurp(folder.file(name)).size() < text.size());
    CHECK(io::FileBytes::open(folder.file(name)).view() == text);
  }
  CHECK_THROWS_AS(io::write_pieces(folder.file("none/out.txt"), both), WriteError);
}

TEST_CASE("chunked output: numbers have the fewest digits that read back", "[chunked_output]") {
  const auto text_of = [](double value, const Rounding& precision = {}) {
    std::string text;
    io::append_number(text, value, precision);
    return text;
  };
  CHECK(text_of(0.1) == "0.1");
  CHECK(text_of(-2) == "-2");
  CHECK(text_of(1.0 / 3) == "0.3333333333333333");
  CHECK(text_of(1.0 / 3, {Rounding::Kind::Single}) == "0.33333334");
  CHECK(text_of(1.0 / 3, {Rounding::Kind::Digits, 4}) == "0.3333");
  CHECK(text_of(1e300) == "1e+300");
  std::string text;
  io::append_integer(text, 18446744073709551615U);
  CHECK(text == "18446744073709551615");
}

TEST_CASE("convert: a square, byte by byte", "[chunked_output]") {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1 2 3 4\n";
  const std::string off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n4 0 1 2 3\n";
  CHECK(bytes_of("obj", obj, "off") == off);
  CHECK(bytes_of("off", off, "obj") == obj);
  // An OBJ keeps its own bytes, whatever they look like.
  CHECK(bytes_of("obj", "# mine\n" + obj, "obj") == "# mine\n" + obj);
}
