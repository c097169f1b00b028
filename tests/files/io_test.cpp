// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "document/rows.h"
#include "ground/numbers/rounding.h"
#include "support/bytes.h"
#include "support/edits.h"
#include "support/folder.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
namespace fs = std::filesystem;

namespace {

/// Writes the bytes to a file of that name, reads it, moves every vertex and gives what is then written.
std::string moved(const Folder& folder, const std::string& name, const std::string& bytes, const Vec3d& by) {
  const io::MeshFile file = io::read_mesh(folder.write(name, bytes));
  io::write_mesh(folder.file("out_" + name), file, shifted(file.polygons.positions, by));
  return slurp(folder.file("out_" + name));
}

const std::string kObj =
    "# a comment\r\nmtllib x.mtl\nv 0 0 0 0.5 0.5 0.5\nv  1.50 0 \t0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\no "
    "part\n"
    "usemtl red\ns 1\nf 1/1/1 2/2/1 3/1/1 # face\nf -3//1 \\\n -1//1 -2//1\nl 1 2\nunknown stuff 1 2 3";

const std::string kPlyHeader =
    "comment made by hand\nelement vertex 3\nproperty float x\nproperty uchar red\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n";

std::string binary_ply(bool big) {
  std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kPlyHeader;
  const float xyz[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const auto& p : xyz) bytes += raw(p[0], big) + raw(std::uint8_t{200}) + raw(p[1], big) + raw(p[2], big);
  bytes += raw(std::uint8_t{3});
  for (const std::int32_t v : {0, 1, 2}) bytes += raw(v, big);
  return bytes + raw(0.25f, big);
}

std::string binary_stl() {
  std::string bytes(80, 'h');
  bytes += raw(std::uint32_t{1});
  for (const float x : {9.f, 9.f, 9.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) bytes += raw(x);
  return bytes + raw(std::uint16_t{0xabcd});
}

const std::string kStl =
    "solid my part\n  facet normal inf -inf word\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n"
    "      vertex 0 1 0\n    endloop foo\n  endfacet blah\nendsolid my part\n";

}  // namespace

TEST_CASE("obj: only coordinates of moved vertices change", "[io]") {
  const Folder folder;
  const std::string once = moved(folder, "a.obj", kObj, {0, 0, 0});
  CHECK(once == kObj);
  std::string expected = replaced(kObj, "v 0 0 0 0.5", "v 0 0 2 0.5");
  expected = replaced(expected, "v  1.50 0 \t0", "v  1.5 0 \t2");
  expected = replaced(expected, "v 0 1 0\n", "v 0 1 2\n");
  expected = replaced(expected, "v 1 1 0\n", "v 1 1 2\n");
  CHECK(moved(folder, "a.obj", kObj, {0, 0, 2}) == expected);
}

TEST_CASE("obj: faces, negative indices and continued lines are read", "[io]") {
  const Folder folder;
  const io::MeshFile file = io::read_mesh(folder.write("a.obj", kObj));
  CHECK(file.polygons.positions.size() == 4);
  CHECK(file.polygons.corners == std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2});
  CHECK(io::rows_of(file).corner_normal == std::vector<std::uint32_t>(6, 0));
}

TEST_CASE("obj: normals of faces that turned are computed anew", "[io]") {
  const Folder folder;
  const io::MeshFile file =
      io::read_mesh(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"));
  std::vector<Vec3d> turned = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  io::write_mesh(folder.file("b.obj"), file, turned);
  CHECK(slurp(folder.file("b.obj")) == "v 0 0 0\nv 0 1 0\nv 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\n");
}

TEST_CASE("obj: a comment that ends in a backslash ends with its line", "[io]") {
  const Folder folder;
  const std::string text = "\xef\xbb\xbf# C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  CHECK(io::read_mesh(folder.write("a.obj", text)).polygons.positions.size() == 3);
  CHECK_THAT(moved(folder, "a.obj", text, {0, 0, 1}), Catch::EndsWith("v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n"));
}

TEST_CASE("off: header variants, comments and colours stay", "[io]") {
  const Folder folder;
  const std::string off =
      "COFF # colours\n# counts\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2 0.5\n";
  CHECK(moved(folder, "a.off", off, {0, 0, 0}) == off);
  CHECK(moved(folder, "a.off", off, {1, 0, 0}) ==
        "COFF # colours\n# counts\n3 1 0\n1 0 0 255 0 0 255\n2 0 0 0 255 0 255\n1 1 0 0 0 255 255\n3 0 1 2 0.5\n");
  CHECK(io::read_mesh(folder.write("c.off", "OFF\n3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2")).polygons.face_count() == 1);
  CHECK(io::read_mesh(folder.write("d.off", "OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2")).polygons.face_count() == 1);
  CHECK(io::read_mesh(folder.write("b.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2")).polygons.face_count() == 1);
}

TEST_CASE("ply: all properties, elements and bytes stay in every encoding", "[io]") {
  const Folder folder;
  for (const bool big : {false, true}) {
    const std::string before = binary_ply(big), after = moved(folder, "a.ply", before, {0, 0, 0.5});
    CHECK(moved(folder, "a.ply", before, {0, 0, 0}) == before);
    REQUIRE(after.size() == before.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < after.size(); ++i) different += after[i] != before[i];
    CHECK(different == 3);  // 0 and 0.5 differ in one byte of a float
    CHECK(io::read_mesh(folder.file("out_a.ply")).polygons.positions[1] == Vec3d(1, 0, 0));
  }
  const std::string text = "ply\r\nformat ascii 1.0\n" + kPlyHeader + "0 200 0 0\n1 200 0 0\n0 200 1 0\n3 0 1 2 0.25\n";
  CHECK(moved(folder, "b.ply", text, {0, 0, 0}) == text);
  CHECK_THAT(moved(folder, "b.ply", text, {0, 0, 0.1}),
             Catch::Contains("0 200 0 0.1\n1 200 0 0.1\n0 200 1 0.1\n3 0 1 2 0.25\n"));
}

TEST_CASE("ply: a moved vertex gets a new normal", "[io]") {
  const Folder folder;
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "float nx\n"
      "property float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0 nan nan nan\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";
  const io::MeshFile file = io::read_mesh(folder.write("a.ply", text));
  io::write_mesh(folder.file("b.ply"), file, std::vector<Vec3d>{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  CHECK_THAT(slurp(folder.file("b.ply")), Catch::EndsWith("0 0 0 1 0 0\n0 1 0 1 0 0\n0 0 1 1 0 0\n3 0 1 2\n"));
}

TEST_CASE("stl: names, headers and attribute bytes stay", "[io]") {
  const Folder folder;
  CHECK(moved(folder, "a.stl", kStl, {0, 0, 0}) == kStl);
  const std::string text = moved(folder, "a.stl", kStl, {0, 0, 0.1});
  CHECK_THAT(text, Catch::StartsWith("solid my part\n  facet normal 0 0 1\n") && Catch::Contains("vertex 1 0 0.1\n"));
  const std::string before = binary_stl(), after = moved(folder, "b.stl", before, {0, 0, 0.1});
  CHECK(after.substr(0, 84) == before.substr(0, 84));
  CHECK(after.substr(after.size() - 2) == before.substr(before.size() - 2));
  CHECK(io::read_mesh(folder.file("out_b.stl")).polygons.positions[2] == Vec3d(0, 1, static_cast<double>(0.1f)));
  CHECK(moved(folder, "b.stl", before, {0, 0, 0}) == before);
}

TEST_CASE("io: numbers in text read back to the same double", "[io]") {
  const Folder folder;
  Polygons mesh = shapes::icosphere(1.0 / 3, 2);
  for (const char* name : {"a.obj", "a.off", "a.ply"}) {
    io::write_mesh(folder.file(name), mesh.view());
    const io::MeshFile back = io::read_mesh(folder.file(name));
    CHECK(back.polygons.positions == mesh.positions);
    CHECK(back.polygons.corners == mesh.corners);
    CHECK(back.polygons.face_begin == mesh.face_begin);
  }
}

TEST_CASE("io: conversion keeps positions and faces and says what is lost", "[io]") {
  const Folder folder;
  const io::MeshFile file = io::read_mesh(folder.write("a.obj", kObj));
  const std::string lost = io::write_mesh(folder.file("a.off"), file, file.polygons.positions).lost;
  for (const char* what : {"texture coordinates", "materials", "groups", "smoothing", "weights or colours"})
    CHECK_THAT(lost, Catch::Contains(what));
  CHECK(io::read_mesh(folder.file("a.off")).polygons.corners == file.polygons.corners);

  const Polygons cube = shapes::box(Vec3d(1), 2, false);
  io::write_mesh(folder.file("cube.obj"), cube.view());
  const io::MeshFile quads = io::read_mesh(folder.file("cube.obj"));
  CHECK_THAT(io::write_mesh(folder.file("cube.stl"), quads, quads.polygons.positions).lost,
             Catch::Contains("split into triangles"));
  CHECK(io::read_mesh(folder.file("cube.stl")).polygons.face_count() == 2 * cube.face_count());
  CHECK(io::write_mesh(folder.file("cube.ply"), quads, quads.polygons.positions).lost.empty());
}

TEST_CASE("io: faulty content is refused with its place", "[io]") {
  const Folder folder;
  struct Case {
    const char *name, *bytes, *place, *fault;
  };
  const Case cases[] = {
      {"a.obj", "", "byte 0", "empty"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "line 4", "at least one face"},
      {"a.obj", "v 0 0 +-1\n", "line 1", "'+-1'"},
      {"a.obj", "v 0 0 0\nf 1 1 +-1\n", "line 2", "'+-1'"},
      {"a.obj", "v 0 0 nan\n", "line 1", "finite"},
      {"a.obj", "v 0 0\n", "line 1", "the end of the line"},
      {"a.obj", "v 0 0 1,5\n", "line 1", "'1,5'"},
      {"a.obj", "v 0 0 0\nf 1 1 0\n", "line 2", "from 1 on"},
      {"a.obj", "v 0 0 0\nf 1 1 2\n", "line 2", "up to 1"},
      {"a.obj", "v 0 0 0\nf 1 1 -2\n", "line 2", "'-2'"},
      {"a.obj", "v 0 0 0\nf 1 1\n", "line 2", "3 corners"},
      {"a.obj", "v 0 0 0\nf 1 1 x\n", "line 2", "'x'"},
      {"a.obj", "v 0 0 0\nvn 0 0 1\nf 1//1 1//2 1//1\n", "line 3", "normal index up to 1"},
      {"a.obj", "\x01\x02\x03 zz\n", "line 1", "a line of an OBJ file"},
      {"a.off", "OFX\n", "line 1", "OFF"},
      {"a.off", "OFF\n353535235358 1 0\n", "line 2", "rest of the file"},
      {"a.off", "OFF\n-1 1 0\n", "line 2", "rest of the file"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "line 5", "vertex 3 of 3"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6", "below 3"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "line 6", "3 corners"},
      {"a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "line 6", "at least one face"},
      {"a.ply", "plx\n", "line 1", "ply"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999\n", "line 3", "can hold"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n", "line 4", "PLY type"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "header", "face"},
      {"a.ply", "ply\nformat ascii 1.0\n", "line 3", "end_header"},
      {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 a\n", "line 4", "'a'"},
      {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nendloop\n", "line 6", "'vertex'"},
      {"a.stl", "solid x\nendsolid x\n", "line 3", "at least one facet"},
      {"a.stl", "solid x\nfacet normal 0 0 1\n", "line 3", "'outer'"},
      {"a.stl", "neither nor", "byte 0", "84 bytes"},
  };
  for (const Case& c : cases) {
    INFO(c.name << ": " << c.bytes);
    const std::string path = folder.write(c.name, c.bytes);
    CHECK_THROWS_AS(io::read_mesh(path), InvalidInput);
    CHECK_THROWS_WITH(io::read_mesh(path),
                      Catch::StartsWith(path) && Catch::Contains(c.place) && Catch::Contains(c.fault));
  }
}

TEST_CASE("io: words in the place of a normal are replaced as a whole", "[io]") {
  const Folder folder;
  CHECK_THAT(moved(folder, "a.stl", replaced(kStl, "inf -inf word", "1#0 0\\3 0"), {1, 0, 0}),
             Catch::Contains("facet normal 0 0 1\n"));
  CHECK(moved(folder, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1\\2 0 \\\n0#c\nf 1//1 2//1 3//1\n", {0, 0, 1}) ==
        "v 0 0 1\nv 1 0 1\nv 0 1 1\nvn 0 0 \\\n1#c\nf 1//1 2//1 3//1\n");
}

TEST_CASE("ply: an element that comes twice is refused", "[io]") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "nx\n"
      "property float ny\nproperty float nz\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n";
  CHECK_THROWS_WITH(io::parse_mesh("a.ply", io::Format::Ply, text), Catch::Contains("once"));
}

TEST_CASE("io: truncated and lying binaries are refused without reading beyond", "[io]") {
  const Folder folder;
  for (const std::string& whole : {binary_ply(false), binary_ply(true)})
    for (std::size_t cut = 1; cut < whole.size(); ++cut)
      CHECK_THROWS_AS(io::read_mesh(folder.write("a.ply", whole.substr(0, cut))), InvalidInput);
  const std::string stl = binary_stl();
  for (std::size_t cut = 1; cut < stl.size(); ++cut)
    CHECK_THROWS_AS(io::read_mesh(folder.write("a.stl", stl.substr(0, cut))), InvalidInput);
  std::string lying = stl;
  lying.replace(80, 4, raw(std::uint32_t{4000000000u}));
  CHECK_THROWS_WITH(io::read_mesh(folder.write("b.stl", lying)), Catch::Contains("4000000000 facets"));
}

TEST_CASE("io: files that are not there, or cannot be written, are told", "[io]") {
  const Folder folder;
  CHECK_THROWS_AS(io::read_mesh(folder.file("none.obj")), ReadError);
  CHECK_THROWS_AS(io::read_mesh(folder.path.string() + "/x.xyz"), InvalidInput);
  fs::create_directory(folder.path / "folder.obj");
  CHECK_THROWS_AS(io::read_mesh(folder.file("folder.obj")), ReadError);
  const Polygons cube = shapes::box(Vec3d(1), 1, false);
  CHECK_THROWS_AS(io::write_mesh(folder.file("folder.obj"), cube.view()), WriteError);
  CHECK_THROWS_AS(io::write_mesh(folder.file("no/such/folder.obj"), cube.view()), WriteError);
  CHECK_THROWS_AS(io::write_mesh(folder.file("x.xyz"), cube.view()), InvalidInput);
}

TEST_CASE("io: a write that fails half-way leaves the old file and nothing else", "[io]") {
  const Folder folder;
  const std::string path = folder.write("a.obj", "old");
  CHECK_THROWS_AS(replace_file(path,
                               [](const std::string& temporary) {
                                 std::ofstream(temporary) << "half";
                                 throw WriteError("disk full");
                               }),
                  WriteError);
  CHECK(slurp(path) == "old");
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}

TEST_CASE("obj: lines out of the ordinary are read as plain ones are, in files of many runs", "[io]") {
  const Folder folder;
  // One grid of quads is written twice: plainly, and with all that an OBJ file may hold in between.
  constexpr int kSide = 150;
  std::string plain, odd = "\xef\xbb\xbf";
  const auto at = [](int i, int j) { return i * (kSide + 1) + j + 1; };
  for (int i = 0; i <= kSide; ++i)
    for (int j = 0; j <= kSide; ++j) {
      const std::string x = std::to_string(i) + ".25", y = std::to_string(j) + ".5";
      plain += "v " + x + " " + y + " 0\n";
      const int kind = (i + j) % 5;
      odd += kind == 0   ? "  v\t" + x + " \\\n " + y + " 0\n"
             : kind == 1 ? "v +" + x + " " + y + " 0 # a vertex\r\n"
             : kind == 2 ? "# nothing \\\nv " + x + " " + y + " 0e0 1 0 0\n"
             : kind == 3 ? "\\\nv " + x + " " + y + " 0\ng part\n"
                         : "v " + x + " " + y + " -0\n\n";
    }
  odd += "vn 0 0 1\nvt 0 0\n";
  const int all = (kSide + 1) * (kSide + 1);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const int corner[4] = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      plain += 'f';
      odd += (i + j) % 3 == 0 ? "f \\\r\n" : "f";
      for (const int v : corner) {
        plain += fmt::format(" {}", v);
        odd += (i + j) % 2 == 0 ? fmt::format(" {}/1/1", v) : fmt::format("\t{}//-1", v - all - 1);
      }
      plain += '\n';
      odd += (i + j) % 4 == 0 ? "#\n" : "\n";
    }
  REQUIRE(odd.size() > std::size_t{2} << 19);
  const io::MeshFile a = io::read_mesh(folder.write("plain.obj", plain)),
                     b = io::read_mesh(folder.write("odd.obj", odd));
  CHECK(a.polygons.positions == b.polygons.positions);
  CHECK(a.polygons.corners == b.polygons.corners);
  CHECK(a.polygons.face_begin == b.polygons.face_begin);
  CHECK(io::rows_of(b).corner_normal == std::vector<std::uint32_t>(b.polygons.corners.size(), 0));
  CHECK(moved(folder, "odd.obj", odd, {0, 0, 0}) == odd);
  CHECK(io::parse_mesh("x", io::Format::Obj, moved(folder, "odd.obj", odd, {1, 2, 3})).polygons.positions ==
        shifted(a.polygons.positions, {1, 2, 3}));
}

TEST_CASE("obj: the first fault of a large file is told, whichever thread found one", "[io]") {
  std::string text;
  for (int v = 0; v < 100000; ++v) text += "v 0.125 " + std::to_string(v) + " 1\n";
  for (int f = 0; f < 100000; ++f) text += f == 70000 || f == 90000 ? "f 1 2 x\n" : "f 1 2 3\n";
  for (int i = 0; i < 5; ++i)
    CHECK_THROWS_WITH(io::parse_mesh("a.obj", io::Format::Obj, text), Catch::Contains("line 170001"));
}

TEST_CASE("ply: text in lines and text in any other order of white space are read alike", "[io]") {
  const Folder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty int id\nproperty float y\nproperty float z\n"
      "element face 2\nproperty uchar flag\nproperty list uchar int vertex_indices\nproperty float q\nend_header\n";
  const std::string lines = "0 7 0 0.1\n1 8 0 0\n0 9 1 0\n0 3 0 1 2 0.5\n1 3 2 1 0 0.5",
                    spread = "0 7\n0 0.1 1 8 0 0\n\n0 9 1 0 0 3 0 1 2 0.5 1 3\n2 1 0 0.5\n";
  const io::MeshFile a = io::read_mesh(folder.write("a.ply", header + lines)),
                     b = io::read_mesh(folder.write("b.ply", header + spread));
  CHECK(a.polygons.positions == b.polygons.positions);
  CHECK(a.polygons.corners == b.polygons.corners);
  CHECK(a.polygons.positions[0][2] == static_cast<double>(0.1f));
  CHECK(moved(folder, "a.ply", header + lines, {0, 0, 0}) == header + lines);
  CHECK(moved(folder, "b.ply", header + spread, {0, 1, 0}) ==
        header + "0 7\n1 0.1 1 8 1 0\n\n0 9 2 0 0 3 0 1 2 0.5 1 3\n2 1 0 0.5\n");
  // Vertices that take all there is leave nothing for the faces.
  CHECK_THROWS_AS(io::parse_mesh("c.ply", io::Format::Ply, header + "0 7 0 0 1 8 0 0 0\n9 1 0"), InvalidInput);
}

TEST_CASE("io: compressed files are read and written in place", "[io]") {
  const Folder folder;
  const io::MeshFile plain = io::read_mesh(folder.write("a.obj", kObj));
  for (const std::string ending : {".gz", ".zst"}) {
    const std::string path = folder.file("a.obj" + ending);
    io::write_mesh(path, plain, shifted(plain.polygons.positions, {0, 0, 2}));
    CHECK(slurp(path).substr(0, 2) == (ending == ".gz" ? "\x1f\x8b" : "\x28\xb5"));
    const io::MeshFile back = io::read_mesh(path);
    CHECK(back.format == io::Format::Obj);
    CHECK(std::string(back.text()) == moved(folder, "b.obj", kObj, {0, 0, 2}));
    // Members behind each other are one file; an end that is missing is told.
    const std::string packed = slurp(path);
    CHECK(std::string(io::read_mesh(folder.write("twice.obj" + ending, packed + packed)).text()) ==
          std::string(back.text()) + std::string(back.text()));
    for (const std::size_t size : {std::size_t{1}, std::size_t{20}, packed.size() - 1})
      CHECK_THROWS_AS(io::read_mesh(folder.write("cut.obj" + ending, packed.substr(0, size))), InvalidInput);
    CHECK_THROWS_AS(io::read_mesh(folder.write("none.obj" + ending, kObj)), InvalidInput);
  }
}

TEST_CASE("io: digits, normals kept, and normals whose vertices disagree", "[io]") {
  const Folder folder;
  const io::MeshFile file = io::read_mesh(
      folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 4//1 3//1\n"));
  const std::vector<Vec3d> bent = {{0, 0, 1.0 / 3}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1.0 / 3}};
  const io::WriteResult kept =
      io::write_mesh(folder.file("b.obj"), file, bent, {.normals = io::Normals::Keep, .digits = 3});
  CHECK(kept.disagreeing_normals == 0);
  CHECK(slurp(folder.file("b.obj")) ==
        "v 0 0 0.333\nv 1 0 0\nv 0 1 0\nv 1 1 0.333\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 4//1 3//1\n");
  CHECK(io::write_mesh(folder.file("c.obj"), file, bent).disagreeing_normals == 1);
  const std::vector<Vec3d> lifted = shifted(file.polygons.positions, {0, 0, 1});
  CHECK(io::write_mesh(folder.file("c.obj"), file, lifted).disagreeing_normals == 0);
  CHECK(Rounding(io::target_of("x.obj", file, {.digits = 3}).precision)(1.0 / 3) == 0.333);
  CHECK(Rounding(io::target_of("x.stl", file).precision)(1.0 / 3) == static_cast<double>(1.0f / 3));
}

TEST_CASE("io: a file that changes while it is in use is told", "[io]") {
  const Folder folder;
  const io::MeshFile file = io::read_mesh(folder.write("a.obj", kObj));
  std::ofstream(folder.file("a.obj"), std::ios::app) << "# more\n";
  CHECK_THROWS_AS(io::write_mesh(folder.file("b.obj"), file, file.polygons.positions), ReadError);
  CHECK_FALSE(fs::exists(folder.file("b.obj")));
}
