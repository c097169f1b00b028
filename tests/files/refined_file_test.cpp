// SPDX-License-Identifier: Apache-2.0
#include "document/rows.h"
#include "vdb_offset/io/derived_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "support/bytes.h"
#include "support/edits.h"
#include "support/folder.h"
#include "support/splitter.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace refined_files {
namespace {

io::MeshFile parse(Format format, const std::string& bytes) {
  return io::parse_mesh(std::string("a.") + io::name(format), format, bytes);
}

/// The text of a file of which edges are split.
std::string split_text(Format format, const std::string& text, const std::vector<Splitter::Edge>& edges) {
  const io::MeshFile source = parse(format, text);
  Splitter splitter(source);
  for (const auto& [a, b] : edges) splitter.edge(a, b);
  const io::RefinedFile refined = io::refine_file(source, splitter.run());
  CHECK(refined.lost.empty());
  return std::string(refined.file.text());
}

const std::string kQuad = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";

// Texture coordinates: two charts that meet at the edge 1 3, where only vertex 3 has the same ones in both.
const std::string kCharts =
    "# a square\nmtllib m.mtl\no square\n" + kQuad +
    "vt 0 0\nvt 0.1 0\nvt 1 1\nvt 0.5 0\nvt 0.5 0.2\nvn 0 0 1\nvn 0 1 0\n"
    "g left\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/2 # lower\ng right\nusemtl blue\nf 1/4/1 3/3/2 4/5/1\n# end\n";

TEST_CASE("refined OBJ: pieces stand in the place of their face, with its corners' texture and normals", "[io]") {
  const std::string expected = "# a square\nmtllib m.mtl\no square\n" + kQuad +
                               "v 1 0 0\n"
                               "vt 0 0\nvt 0.1 0\nvt 1 1\nvt 0.5 0\nvt 0.5 0.2\nvt 0.05 0\nvn 0 0 1\nvn 0 1 0\n"
                               "g left\nusemtl red\ns 1\nf 5/6/1 2/2/1 3/3/2 # lower\nf 5/6/1 3/3/2 1/1/1\n"
                               "g right\nusemtl blue\nf 1/4/1 3/3/2 4/5/1\n# end\n";
  CHECK(split_text(Format::Obj, kCharts, {{0, 1}}) == expected);
}

TEST_CASE("refined OBJ: a seam stays one, and what is continuous over an edge stays so", "[io]") {
  const std::string seam = split_text(Format::Obj, kCharts, {{0, 2}});
  // Two texture coordinates at the added vertex; one normal, of the same two.
  CHECK_THAT(seam, Catch::Contains("vt 0.5 0.2\nvt 0.5 0.5\nvt 0.75 0.5\nvn"));
  CHECK_THAT(seam, Catch::Contains("vn 0 1 0\nvn 0 0.70710677 0.70710677\ng left"));
  CHECK_THAT(seam, Catch::Contains("f 5/6/3 1/1/1 2/2/1 # lower\nf 5/6/3 2/2/1 3/3/2\n"));
  CHECK_THAT(seam, Catch::Contains("f 5/7/3 3/3/2 4/5/1\nf 5/7/3 4/5/1 1/4/1\n"));
  const std::string whole = split_text(Format::Obj, replaced_everywhere(kCharts, "1/4/1", "1/1/1"), {{0, 2}});
  CHECK_THAT(whole, Catch::Contains("vt 0.5 0.2\nvt 0.5 0.5\nvn"));
}

TEST_CASE("refined OBJ: corners without texture coordinates or normals stay without", "[io]") {
  const std::string mixed = kQuad + "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1 2/2 3\nf 1//1 3//1 4//1\nf 2 3 4\n";
  CHECK(split_text(Format::Obj, mixed, {{0, 1}, {1, 2}, {0, 2}}) ==
        kQuad +
            "v 1 0 0\nv 2 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0.5 0\nvn 0 0 1\n"
            "f 5/3 2/2 6\nf 5/3 6 3\nf 5/3 3 7\nf 5/3 7 1/1\nf 7//1 3//1 4//1\nf 7//1 4//1 1//1\nf 6 3 4\nf 6 4 2\n");
}

TEST_CASE("refined OBJ: indices that count back mean the same as before", "[io]") {
  const std::string objects =
      "v 0 0 0\nv 2 0 0\nv 2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nf -3/-3 -2/-2 -1/-1\n"
      "v 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\nf -4 -3 -2 -1 # all\nl -4 -2\np -1\ncurv -1 1 -4 -2\nf 4/-3 5/-2 6/-1\n";
  CHECK(split_text(Format::Obj, objects, {{0, 1}}) ==
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0\nf 8/4 2/2 3/3\nf 8/4 3/3 1/1\n"
        "v 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\nv 1 0 0\nf 4 5 6 7 # all\nl 4 6\np 7\ncurv -1 1 4 6\nf 4/1 5/2 6/3\n");
}

TEST_CASE("refined OBJ: line ends, continued lines and numbers behind coordinates", "[io]") {
  const std::string coloured = "v 0 0 0 1 0 0\nv 2 0 0 0.5 1 0\nv 2 2 0 1 0 0\nf 1 2 \\\n3\nf 1 3 \\\n2";
  const std::string expected =
      "v 0 0 0 1 0 0\nv 2 0 0 0.5 1 0\nv 2 2 0 1 0 0\nv 1 0 0 0.75 0.5 0\nf 4 2 3\nf 4 3 1\nf 4 1 3\nf 4 3 2\n";
  CHECK(split_text(Format::Obj, coloured, {{0, 1}}) == expected);
  CHECK(split_text(Format::Obj, replaced_everywhere(coloured, "\n", "\r\n"), {{0, 1}}) ==
        replaced_everywhere(expected, "\n", "\r\n"));
  // A backslash in the last line joins no new ones to it.
  for (const std::string end : {"", "\\\n", "\\\r\n"})
    CHECK_THAT(split_text(Format::Obj, "f 1 2 3\nv 0 0 0\nv 2 0 0\nv 2 2 0 " + end, {{0, 1}}),
               Catch::EndsWith("\nv 1 0 0\n"));
  // Nor does one at the end of a word that is no number.
  CHECK_THAT(split_text(Format::Obj, "v 0 0 0 x\\ \nv 2 0 0 x\\ \nv 2 2 0 x\\ \nf 1 2 3\n", {{0, 1}}),
             Catch::Contains("v 1 0 0 x\\ \nf 4 2 3\n"));
  const std::string bytes =
      replaced_everywhere(replaced_everywhere(replaced_everywhere(coloured, " 1 0 0", " 255 0 0"), "0.5 1 0", "0 9 0"),
                          "2 0 0 255", "2 0 0");
  CHECK_THAT(split_text(Format::Obj, bytes, {{0, 1}}), Catch::Contains("v 1 0 0 128 5 0\n"));

  const io::MeshFile old_mac =
      parse(Format::Obj, replaced_everywhere(replaced_everywhere(coloured, "\\\n", ""), "\n", "\r"));
  const io::RefinedFile refined = io::refine_file(old_mac, Splitter(old_mac).edge(0, 1).run());
  CHECK(io::rows_of(refined.file).has_carriage_returns);
  CHECK(io::patched_bytes(refined.file, refined.file.polygons.positions) == replaced_everywhere(expected, "\n", "\r"));
}

TEST_CASE("refined OBJ: the point inside of a face has the shares of three corners", "[io]") {
  const io::MeshFile source = parse(Format::Obj, kCharts);
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).inside(0).run());
  const io::Attributes attributes = io::read_attributes(refined.file);
  REQUIRE(attributes.texture.value.size() == 6);
  CHECK(attributes.texture.value[5][0] == Approx(0.5 * 0 + 0.25 * 0.1 + 0.25 * 1));
  CHECK(attributes.texture.value[5][1] == 0.25);
  CHECK(refined.file.polygons.positions[4] == Vec3d(1, 0.5, 0));
}

TEST_CASE("refined OBJ: faces keep groups and materials, and other formats can be made of it", "[io]") {
  const Folder folder;
  const io::MeshFile source = parse(Format::Obj, kCharts);
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).edge(0, 1).edge(0, 2).run());
  const std::vector<std::uint32_t> of_face = {0, 0, 0, 1, 1};
  CHECK(io::wall_names(refined.file).of_face == of_face);
  CHECK(io::read_materials(refined.file).of_face == of_face);
  CHECK(io::select_faces(refined.file, std::vector{io::parse_selector("material=blue")}) ==
        std::vector<std::uint8_t>{0, 0, 0, 1, 1});
  for (const std::string ending : {"ply", "off", "stl"}) {
    const std::string path = folder.file("b." + ending);
    io::write_mesh(path, refined.file, refined.file.polygons.positions);
    CHECK(io::read_mesh(path).polygons.face_count() == 5);
  }
  CHECK(io::read_attributes(io::read_mesh(folder.file("b.ply"))).texture.of_corner.size() == 15);
}

TEST_CASE("refined OBJ: malformed attributes are left out or copied", "[io]") {
  const std::string unknown = kQuad + "vt 0 0\nf 1/1 2/1 3/9\nf 1 3 4\n";
  const io::MeshFile source = parse(Format::Obj, unknown);
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run());
  CHECK_THAT(refined.lost, Catch::Contains(std::vector<std::string>{
                               "texture coordinates of pieces (some faces name ones that are not there)"}));
  CHECK(refined.file.text() == kQuad + "v 1 0 0\nvt 0 0\nf 5 2 3\nf 5 3 1\nf 1 3 4\n");
  // Words that are no numbers, and normals that cancel out, are those of the nearest vertex.
  CHECK_THAT(split_text(Format::Obj, kQuad + "vt a 0\nvt 1 1 0.5\nvn 0 0 1\nvn 0 0 -1\nf 1/1/1 2/2/2 3/2/2\nf 1 3 4\n",
                        {{0, 1}}),
             Catch::Contains("vt 1 1 0.5\nvt a 0.5\nvn 0 0 1\nvn 0 0 -1\nvn 0 0 1\nf 5/3/3 2/2/2"));
  // Normals that are named and not there.
  CHECK_THAT(split_text(Format::Obj, kQuad + "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n", {{0, 1}}),
             Catch::Contains("v 1 0 0\nf 5 2 3\nf 5 3 1\nf 1//1 3//1 4//1\n"));
}

std::string ply_header(const std::string& encoding) {
  return "ply\nformat " + encoding +
         " 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty int id\n"
         "property double weight\nelement face 2\nproperty list uchar uchar vertex_indices\n"
         "property list uchar float texcoord\nproperty int texnumber\nelement edge 1\nproperty int a\nproperty int b\n"
         "end_header\n";
}
const std::string kPlyText = ply_header("ascii") +
                             "0 0 0  0 0 1  10 7 0.1\n2 0 0  0 0 1  13 8 0.2\n2 2 0  0 1 0  10 9 0.1\n"
                             "0 2 0  0 1 0  10 6 nan\n3 0 1 2  6 0 0 1 0 1 1  5\n3 0  2 3 6 0 0 1 1 0 0.5 4\n0 1\n";

TEST_CASE("refined PLY: rows of text", "[io]") {
  const std::string expected =
      replaced_everywhere(replaced_everywhere(ply_header("ascii"), "vertex 4", "vertex 5"), "face 2", "face 3") +
      "0 0 0  0 0 1  10 7 0.1\n2 0 0  0 0 1  13 8 0.2\n2 2 0  0 1 0  10 9 0.1\n0 2 0  0 1 0  10 6 nan\n"
      "1 0 0 0 0 1 12 7 0.15000000000000002\n3 4 1 2 6 0.5 0 1 0 1 1 5\n3 4 2 0 6 0.5 0 1 1 0 0 5\n"
      "3 0  2 3 6 0 0 1 1 0 0.5 4\n0 1\n";
  CHECK(split_text(Format::Ply, kPlyText, {{0, 1}}) == expected);
  CHECK(split_text(Format::Ply, replaced_everywhere(kPlyText, "\n", "\r\n"), {{0, 1}}) ==
        replaced_everywhere(expected, "\n", "\r\n"));
  // Normals are of length 1; a number that is none gives way to that of the nearest vertex, the first of two.
  CHECK_THAT(split_text(Format::Ply, kPlyText, {{0, 2}, {2, 3}}),
             Catch::Contains("1 1 0 0 0.70710677 0.70710677 10 9 0.1\n1 2 0 0 1 0 10 9 0.1\n"));
}

std::string binary_ply(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
  const auto vertex = [&](float x, float y, float ny, float nz, std::uint8_t red, std::int32_t id, double weight) {
    for (const float number : {x, y, 0.f, 0.f, ny, nz}) bytes += raw(number, big);
    bytes += raw(red) + raw(id, big) + raw(weight, big);
  };
  vertex(0, 0, 0, 1, 10, 7, 0.1);
  vertex(2, 0, 0, 1, 13, 8, 0.2);
  vertex(2, 2, 1, 0, 10, 9, 0.1);
  vertex(0, 2, 1, 0, 10, 6, 0.1);
  const auto face = [&](std::array<std::uint8_t, 3> corners, std::array<float, 6> texture, std::int32_t number) {
    bytes += raw(std::uint8_t{3});
    for (const auto v : corners) bytes += raw(v);
    bytes += raw(std::uint8_t{6});
    for (const float t : texture) bytes += raw(t, big);
    bytes += raw(number, big);
  };
  face({0, 1, 2}, {0, 0, 1, 0, 1, 1}, 5);
  face({0, 2, 3}, {0, 0, 1, 1, 0, 0.5}, 4);
  return bytes + raw(std::int32_t{0}, big) + raw(std::int32_t{1}, big) + "rest";
}

TEST_CASE("refined PLY: binary rows say what rows of text do", "[io]") {
  const io::MeshFile text = parse(Format::Ply, replaced_everywhere(kPlyText, "nan", "0.1"));
  const Refinement refinement = Splitter(text).edge(0, 1).edge(0, 2).run();
  const io::MeshFile expected = io::refine_file(text, refinement).file;
  const io::Attributes wanted = io::read_attributes(expected);
  for (const bool big : {false, true}) {
    const io::MeshFile source = parse(Format::Ply, binary_ply(big));
    const io::MeshFile refined = io::refine_file(source, refinement).file;
    CHECK(refined.encoding == source.encoding);
    const io::Attributes attributes = io::read_attributes(refined);
    CHECK(attributes.texture.value == wanted.texture.value);
    CHECK(attributes.texture.of_corner == wanted.texture.of_corner);
    for (std::size_t v = 0; v < 6; ++v)
      CHECK((attributes.normals.value[v] - wanted.normals.value[v]).length() < 1e-7);  // that of the text has 8 digits
    for (const char* property : {"red", "id", "weight"})
      CHECK(io::vertex_property(refined, property) == io::vertex_property(expected, property));
    CHECK(refined.text().ends_with(raw(std::int32_t{0}, big) + raw(std::int32_t{1}, big) + "rest"));
    // The row of the face that is not split, in the middle of the pieces of none.
    const std::string row = raw(std::uint8_t{3}) + raw(std::uint8_t{0}) + raw(std::uint8_t{2}) + raw(std::uint8_t{3});
    const io::MeshFile partly = io::refine_file(source, Splitter(source).edge(0, 1).run()).file;
    CHECK(partly.text().find(row) != std::string::npos);
  }
}

TEST_CASE("refined PLY: corners get a wider type where their numbers need it", "[io]") {
  for (const std::string encoding : {"ascii", "binary_little_endian"}) {
    std::string header = "ply\nformat " + encoding +
                         " 1.0\nelement vertex 256\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 2\nproperty list uchar uchar vertex_index\nend_header\n";
    std::string bytes = header;
    const bool is_text = encoding == "ascii";
    for (int v = 0; v < 256; ++v) {
      const std::array<float, 3> p = {static_cast<float>(v), static_cast<float>(v * v), 0};
      if (is_text) bytes += fmt::format("{} {} 0\n", p[0], p[1]);
      else
        for (const float x : p) bytes += raw(x);
    }
    for (const std::array<int, 4> row : {std::array{3, 0, 1, 2}, {3, 3, 4, 255}})
      if (is_text) bytes += fmt::format("{}\n", fmt::join(row, " "));
      else
        for (const int number : row) bytes += raw(static_cast<std::uint8_t>(number));
    const io::MeshFile source = parse(Format::Ply, bytes);
    const io::MeshFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run()).file;
    CHECK(refined.polygons.corners == std::vector<std::uint32_t>{256, 1, 2, 256, 2, 0, 3, 4, 255});
    CHECK(refined.text().find("property list uchar int vertex_index") != std::string::npos);
  }
}

TEST_CASE("refined PLY: rows wherever they stand, and lists of vertices", "[io]") {
  const std::string header =
      "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\n"
      "element vertex 4\nproperty list uchar int tags\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  CHECK(split_text(Format::Ply, header + "3 0 1 2 3\n0 2 3\n\n 2 8 9 0 0 0 0 2\n0 0 1 7 2 2 0\n0 0 2 0", {{0, 1}}) ==
        replaced_everywhere(replaced_everywhere(header, "face 2", "face 3"), "vertex 4", "vertex 5") +
            "3 4 1 2\n3 4 2 0 3\n0 2 3\n\n 2 8 9 0 0 0 0 2\n0 0 1 7 2 2 0\n0 0 2 0\n2 8 9 1 0 0");
}

TEST_CASE("refined PLY: strips become faces", "[io]") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty int id\n";
  const std::string points = "0 0 0 4\n2 0 0 5\n0 2 0 6\n2 2 0 7";
  const std::string strips = head +
                             "element tristrips 1\nproperty int colour\nproperty list int int vertex_indices\n"
                             "element face 0\nproperty list uchar int vertex_indices\nend_header\n" +
                             points + "\n9 4 0 1 2 3\n";
  const io::MeshFile source = parse(Format::Ply, strips);
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run());
  CHECK(refined.file.text() == replaced_everywhere(head, "vertex 4", "vertex 5") +
                                   "element face 3\nproperty list int int vertex_indices\nend_header\n" + points +
                                   "\n1 0 0 4\n3 4 1 2\n3 4 2 0\n3 2 1 3\n");
  CHECK(refined.lost == std::vector<std::string>{"strips of triangles (the triangles are there, as faces)",
                                                 "property 'colour' of triangle strips"});
}

TEST_CASE("refined OFF: text", "[io]") {
  const std::string off =
      "STCNOFF # all\n4 2 5\n\n0 0 0 0 0 1 255 0 0 255 0 0\n# second\n2 0 0 0 0 1 0 0 0 255 1 0\n"
      "2 2 0 0 1 0 0 0 0 255 1 1\n0 2 0 0 1 0 0 0 0 255 0 1 # last\n"
      "# faces\n3 0 1 2 1 0 0 # red\n\n3 0 2 3\n";
  CHECK(split_text(Format::Off, off, {{0, 1}, {0, 2}}) ==
        "STCNOFF # all\n6 5 0\n\n0 0 0 0 0 1 255 0 0 255 0 0\n# second\n2 0 0 0 0 1 0 0 0 255 1 0\n"
        "2 2 0 0 1 0 0 0 0 255 1 1\n0 2 0 0 1 0 0 0 0 255 0 1 # last\n"
        "1 0 0 0 0 1 128 0 0 255 0.5 0\n1 1 0 0 0.70710677 0.70710677 128 0 0 255 0.5 0.5\n"
        "# faces\n3 4 1 2 1 0 0\n3 4 2 5 1 0 0\n3 4 5 0 1 0 0 # red\n\n3 5 2 3\n3 5 3 0\n");
  // Colours from 0 to 1 are no bytes, and a face that is not split keeps its line.
  CHECK(split_text(Format::Off, "COFF 3 1\n0 0 0 1 0 0 1\n2 0 0 0 0 0 1\n0 2 0 1 0 0 1\n3  0 1 2", {{0, 1}}) ==
        "COFF 4 2 0\n0 0 0 1 0 0 1\n2 0 0 0 0 0 1\n0 2 0 1 0 0 1\n1 0 0 0.5 0 0 1\n3 3 1 2\n3 3 2 0");
  const std::string few = "OFF\r\n3 1\r\n0 0 0\r\n2 0 0\r\n0 2 0\r\n3 0 1 2\r\n";
  CHECK(split_text(Format::Off, few, {{0, 1}}) ==
        "OFF\r\n4 2 0\r\n0 0 0\r\n2 0 0\r\n0 2 0\r\n1 0 0\r\n3 3 1 2\r\n3 3 2 0\r\n");
  CHECK_THAT(split_text(Format::Off, replaced_everywhere(off, "3 0 2 3", "3  0  2 3 0.5"), {{0, 1}}),
             Catch::EndsWith("# red\n\n3  0  2 3 0.5\n"));
}

TEST_CASE("refined OFF: binary", "[io]") {
  std::string bytes = "STCNOFF BINARY\n";
  for (const int count : {4, 2, 5}) bytes += raw(count, true);
  const auto vertex = [&](float x, float y, float ny, float nz, float red, float s) {
    for (const float number : {x, y, 0.f, 0.f, ny, nz, red, 0.f, 0.f, 1.f, s, 0.f}) bytes += raw(number, true);
  };
  vertex(0, 0, 0, 1, 1, 0);
  vertex(2, 0, 0, 1, 0, 1);
  vertex(2, 2, 1, 0, 0, 1);
  vertex(0, 2, 1, 0, 0, 0);
  for (const int number : {3, 0, 1, 2, 3}) bytes += raw(number, true);
  for (const float number : {0.5f, 0.f, 1.f}) bytes += raw(number, true);
  for (const int number : {3, 0, 2, 3, 0}) bytes += raw(number, true);
  const io::MeshFile source = parse(Format::Off, bytes + "rest");
  const io::MeshFile refined = io::refine_file(source, Splitter(source).edge(0, 1).edge(0, 2).run()).file;
  const io::Attributes attributes = io::read_attributes(refined);
  CHECK(attributes.colours[4] == std::array<double, 4>{0.5, 0, 0, 1});
  CHECK(attributes.texture.value[5] == Vec2d(0.5, 0));
  CHECK(attributes.normals.value[5] ==
        Vec3d(0, static_cast<double>(std::sqrt(0.5f)), static_cast<double>(std::sqrt(0.5f))));
  std::string faces;
  for (const std::array<int, 3> corners : {std::array{4, 1, 2}, {4, 2, 5}, {4, 5, 0}}) {
    faces += raw(3, true);
    for (const int v : corners) faces += raw(v, true);
    faces += raw(3, true) + raw(0.5f, true) + raw(0.f, true) + raw(1.f, true);
  }
  for (const int number : {3, 5, 2, 3, 0, 3, 5, 3, 0, 0}) faces += raw(number, true);
  CHECK(refined.text().ends_with(faces + "rest"));
  CHECK(refined.text().substr(15, 12) == raw(6, true) + raw(5, true) + raw(0, true));
}

const std::string kStl =
    "solid one two\n  facet normal 0 0 1\n    outer loop\n      vertex 0.0 0 0\n      vertex 2 0 0\n"
    "      vertex 2 2 0\n    endloop\n  endfacet remark\nendsolid one two\nsolid\n"
    "facet normal nan nan nan\nouter loop vertex 0.0 0 0\nvertex 2 2 0\nvertex 0 2 0\nendloop endfacet\nendsolid\n";

TEST_CASE("refined STL: facets of a text keep their normals, solids and remarks", "[io]") {
  const io::MeshFile source = parse(Format::Stl, kStl);
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run());
  const std::string facet =
      "  facet normal 0 0 1\n    outer loop\n      vertex 1 0 0\n      vertex 2 0 0\n"
      "      vertex 2 2 0\n    endloop\n  endfacet";
  const std::string second =
      replaced_everywhere(replaced_everywhere(facet, "vertex 2 2 0", "vertex 0.0 0 0"), "vertex 2 0 0", "vertex 2 2 0");
  CHECK(refined.file.text() == "solid one two\n" + facet + "\n" + second + kStl.substr(kStl.find(" remark")));
  CHECK(refined.vertex == std::vector<std::uint32_t>{6, 1, 2, 6, 2, 0, 3, 4, 5});
  CHECK(io::wall_names(refined.file).of_face == std::vector<std::uint32_t>{0, 0, 1});
}

TEST_CASE("refined STL: facets that meet at an added vertex each have a vertex of their own there", "[io]") {
  const Folder folder;
  const io::MeshFile source = parse(Format::Stl, kStl);
  Refinement welded;
  welded.polygons.positions = source.polygons.positions;
  welded.polygons.positions.emplace_back(1, 1, 0);
  for (const std::array<std::uint32_t, 3> piece : {std::array{6u, 0u, 1u}, {6u, 1u, 2u}, {6u, 4u, 5u}, {6u, 5u, 3u}})
    welded.polygons.add_face({piece[0], piece[1], piece[2]});
  welded.parent = {0, 0, 1, 1};
  welded.added = {{0, {2, 0, 1}, {0.5, 0.5, 0}}};
  const io::RefinedFile refined = io::refine_file(source, welded);
  CHECK(refined.vertex == welded.polygons.corners);
  const auto found = io::find_in_triangles(welded.polygons.view(), refined.file.polygons.view());
  REQUIRE(found.has_value());
  CHECK(found->positions == welded.polygons.positions);
  io::write_vertex_map(folder.file("map.txt"), welded, refined.vertex);
  const std::string origin = " 0 2 0 1 0.5 0.5 0\n";
  CHECK_THAT(slurp(folder.file("map.txt")),
             Catch::EndsWith("\n0" + origin + "3" + origin + "6" + origin + "9" + origin));
}

TEST_CASE("refined STL: facets of a binary file keep their normals and attribute bytes", "[io]") {
  std::string bytes = std::string(80, 'h') + raw(std::uint32_t{2});
  const auto facet = [](std::array<float, 9> corners, float nz, std::uint16_t attribute) {
    std::string row = raw(0.f) + raw(0.f) + raw(nz);
    for (const float number : corners) row += raw(number);
    return row + raw(attribute);
  };
  const std::string second = facet({0, 0, 0, 2, 2, 0, 0, 2, 0}, 0.5f, 9);
  bytes += facet({0, 0, 0, 2, 0, 0, 2, 2, 0}, 1, 7) + second;
  const io::MeshFile source = parse(Format::Stl, bytes + "rest");
  const io::RefinedFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run());
  CHECK(refined.file.text() == std::string(80, 'h') + raw(std::uint32_t{3}) + facet({1, 0, 0, 2, 0, 0, 2, 2, 0}, 1, 7) +
                                   facet({1, 0, 0, 2, 2, 0, 0, 0, 0}, 1, 7) + second + "rest");
}

TEST_CASE("refined file: a refinement that splits nothing is the source", "[io]") {
  const std::vector<std::pair<Format, std::string>> files = {
      {Format::Obj, kCharts}, {Format::Ply, kPlyText}, {Format::Ply, binary_ply(true)}, {Format::Stl, kStl}};
  for (const auto& [format, bytes] : files) {
    const io::MeshFile source = parse(format, bytes);
    CHECK(io::refine_file(source, Splitter(source).run()).file.text() == bytes);
  }
}

TEST_CASE("refined file: it can be written in place with other positions", "[io]") {
  const io::MeshFile source = parse(Format::Obj, kQuad + "f 1 2 3 4\n");
  const io::MeshFile refined = io::refine_file(source, Splitter(source).edge(0, 1).run()).file;
  std::vector<Vec3d> positions = refined.polygons.positions;
  for (Vec3d& p : positions) p[2] += 1;
  CHECK(io::patched_bytes(refined, positions) ==
        replaced_everywhere(kQuad, " 0\n", " 1\n") + "v 1 0 1\nf 5 2 3\nf 5 3 4\nf 5 4 1\n");
}

TEST_CASE("refined file: a refinement of something else is refused", "[io]") {
  const io::MeshFile source = parse(Format::Obj, kCharts);
  const Refinement good = Splitter(source).edge(0, 1).run();
  const auto refused = [&](auto&& spoil, const char* message) {
    Refinement bad = good;
    spoil(bad);
    CHECK_THROWS_WITH(io::refine_file(source, bad), Catch::Contains(message));
  };
  refused([](Refinement& r) { r.polygons.positions[0][0] = 0.5; }, "a refinement of 4 vertices");
  refused([](Refinement& r) { r.added.clear(); }, "a refinement of 4 vertices");
  refused([](Refinement& r) { r.parent = {0, 0, 0}; }, "pieces of 2 faces in their order");
  refused([](Refinement& r) { r.parent = {0, 1, 0}; }, "pieces of 2 faces in their order");
  refused([](Refinement& r) { r.polygons.corners[0] = 9; }, "vertices below 5");
  refused([](Refinement& r) { r.added[0].share = {0.5, 0, 0}; }, "shares");
  refused([](Refinement& r) { r.added[0].vertex[0] = 3; }, "between its own vertices");
  refused([](Refinement& r) { r.polygons.face_begin[1] = 2; }, "at least 3 corners");
  const io::MeshFile single = parse(Format::Ply, kPlyText);
  Refinement fine = Splitter(single).edge(0, 1).run();
  fine.polygons.positions.back()[0] = 0.1;
  CHECK_THROWS_WITH(io::refine_file(single, fine), Catch::Contains("a position of vertex 4 that the file can hold"));
}

TEST_CASE("vertex map: origins read back as they are", "[io]") {
  const Folder folder;
  const std::string path = folder.file("map.txt");
  const io::MeshFile source = parse(Format::Obj, kCharts);
  Refinement refinement = Splitter(source).edge(0, 2).inside(1).run();
  refinement.added[0].share = {0.1, 0.9, 0};
  io::write_vertex_map(path, refinement);
  CHECK(slurp(path) ==
        "# vertex face v0 v1 v2 s0 s1 s2: an added vertex is s0 v0 + s1 v1 + s2 v2\n"
        "4 0 2 0 1 0.1 0.9 0\n5 1 0 2 3 0.5 0.25 0.25\n");
  const io::MeshFile facets = parse(Format::Stl, kStl);
  const Refinement of_facets = Splitter(facets).edge(0, 1).run();
  io::write_vertex_map(path, of_facets, io::refine_file(facets, of_facets).vertex);
  CHECK_THAT(slurp(path), Catch::EndsWith("s2 v2\n0 0 0 1 2 0.5 0.5 0\n3 0 0 1 2 0.5 0.5 0\n"));
}

TEST_CASE("refined file: whatever the reader takes is refined or refused", "[io]") {
  const std::vector<std::pair<Format, std::string>> files = {
      {Format::Obj, kCharts},
      {Format::Ply, kPlyText},
      {Format::Ply, binary_ply(false)},
      {Format::Stl, kStl},
      {Format::Off,
       "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 0 0 1 0 0\n2 0 0 0 0 1 0 0 0 1 1 0\n0 2 0 0 1 0 1 0 0 1 0 0\n3 0 1 2 9\n"}};
  std::mt19937 random(5);
  std::size_t refined = 0;
  for (int attempt = 0; attempt < 4000; ++attempt) {
    auto [format, bytes] = files[random() % files.size()];
    for (std::size_t change = 1 + random() % 3; change > 0; --change)
      bytes[random() % bytes.size()] = "0129-/. \n\\#fgv\r\t+e"[random() % 18];
    try {
      const io::MeshFile source = parse(format, bytes);
      const auto face = source.polygons.view().face(random() % source.polygons.face_count());
      if (face[0] == face[1]) continue;
      io::refine_file(source, Splitter(source).edge(face[0], face[1]).run());
      ++refined;
    } catch (const InvalidInput&) {
      continue;
    }
  }
  CHECK(refined > 1000);
}

}  // namespace
}  // namespace refined_files
