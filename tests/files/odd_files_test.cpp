// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "bytes/nearest_names.h"
#include "document/rows.h"
#include "ground/numbers/rounding.h"
#include "space/surface/surface.h"
#include "support/bytes.h"
#include "support/edits.h"
#include "support/folder.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace odd_files {
namespace {

using CornerList = std::vector<std::uint32_t>;

std::string moved(const io::MeshFile& file, const Vec3d& by) {
  return io::patched_bytes(file, shifted(file.polygons.positions, by));
}

io::MeshFile parse(Format format, const std::string& bytes) {
  return io::parse_mesh(std::string("a.") + io::name(format), format, bytes);
}

void check_refused(Format format, const std::string& bytes, const std::string& message) {
  CHECK_THROWS_WITH(parse(format, bytes), Catch::Contains(message));
}

/// A shell around a file's mesh, written in the same format and read again.
io::MeshFile shell_there_and_back(const Folder& folder, const io::MeshFile& file, std::string& lost) {
  const std::string path = folder.file(std::string("shell.") + io::name(file.format));
  const vdb_offset::Shell shell = make_shell(file.polygons.view(), shifted(file.polygons.positions, {0, 0, 1}),
                                             file.polygons.positions, {}, file.precision);
  lost = io::write_shell(path, file, shell).lost;
  io::MeshFile back = io::read_mesh(path);
  if (file.format == Format::Stl) {
    CHECK(back.polygons.face_count() == 2 * file.polygons.face_count() + 2 * shell.rim.size());
    return back;
  }
  for (std::size_t v = 0; v < shell.polygons.positions.size(); ++v)
    CHECK(back.polygons.positions[v] == Rounding(file.precision)(shell.polygons.positions[v]));
  CHECK(back.polygons.corners == shell.polygons.corners);
  return back;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string strips_header(const std::string& encoding, const std::string& index, int strips) {
  return "ply\nformat " + encoding + " 1.0\nelement vertex 4\n" + kXyz +
         fmt::format("element tristrips {}\nproperty list int {} vertex_indices\nend_header\n", strips, index);
}
const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const CornerList kTetrahedron = {0, 1, 2, 2, 1, 3, 2, 3, 0, 0, 3, 1};

std::string binary_strips(bool big, const std::string& index) {
  std::string bytes = strips_header(big ? "binary_big_endian" : "binary_little_endian", index, 1);
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) bytes += raw(x, big);
  bytes += raw(std::int32_t{7}, big);
  for (const std::int32_t v : {0, 1, 2, 3, 0, 1, -1}) bytes += raw(v, big);
  return bytes;
}

/// A square of two triangles, the first of which has a colour.
std::string binary_off(const std::string& keyword, const std::vector<std::vector<float>>& rows) {
  std::string bytes = keyword + " BINARY\n";
  for (const std::int32_t count : {4, 2, 5}) bytes += raw(count, true);
  for (const auto& row : rows)
    for (const float number : row) bytes += raw(number, true);
  for (const std::int32_t number : {3, 0, 1, 2, 3}) bytes += raw(number, true);
  for (const float number : {1.f, 0.5f, 0.f}) bytes += raw(number, true);
  for (const std::int32_t number : {3, 0, 2, 3, 0}) bytes += raw(number, true);
  return bytes;
}
const std::vector<std::vector<float>> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1f}};
const std::vector<std::vector<float>> kRichSquare = {{0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 0},
                                                     {1, 0, 0, 0, 0, 1, 1, 1, 0, 1, 1, 0},
                                                     {1, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1},
                                                     {0, 1, 0.1f, 0, 0, 1, 0, 0, 1, 0.5f, 0, 1}};

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("ply: strips of triangles are faces, and stay strips", "[io]") {
  const std::string text = strips_header("ascii", "int", 3) + kPoints + "6 0 1 2 3 0 1\n0\n9 0 1 2 -1 3 3 0 1 -1\n";
  const io::MeshFile file = parse(Format::Ply, text);
  CornerList expected = kTetrahedron;
  // A new strip starts its turns anew; a corner that is there twice leads to the next triangle.
  expected.insert(expected.end(), {0, 1, 2, 0, 3, 1});
  CHECK(file.polygons.corners == expected);
  CHECK(io::patched_bytes(file, file.polygons.positions) == text);
  CHECK(moved(file, {0, 0, 0.5}) == replaced_everywhere(text, kPoints, "0 0 0.5\n1 0 0.5\n0 1 0.5\n0 0 1.5\n"));
  for (const bool big : {false, true})
    for (const std::string index : {"int", "uint"}) {
      const std::string bytes = binary_strips(big, index);
      const io::MeshFile binary = parse(Format::Ply, bytes);
      CHECK(binary.polygons.corners == kTetrahedron);
      CHECK(io::patched_bytes(binary, binary.polygons.positions) == bytes);
      const std::string after = moved(binary, {0, 0, 2});
      CHECK(after.substr(after.size() - 32) == bytes.substr(bytes.size() - 32));
      CHECK(parse(Format::Ply, after).polygons.positions[3] == Vec3d(0, 0, 3));
    }
  CHECK(build_surface(parse(Format::Ply, binary_strips(false, "int")).polygons.view(), {}).facts.two_sided());
}

TEST_CASE("ply: strips go to other formats as triangles, with what their vertices have", "[io]") {
  const Folder folder;
  const std::string text =
      replaced_everywhere(replaced_everywhere(strips_header("ascii", "int", 1), "property float z\n",
                                              "property float z\nproperty uchar red\nproperty uchar green\n"
                                              "property uchar blue\n"),
                          "list int", "list uchar") +
      replaced_everywhere(kPoints, "\n", " 255 0 51\n") + "6 0 1 2 3 0 1\n";
  const io::MeshFile file = io::read_mesh(folder.write("a.ply", text));
  const io::WriteResult written = io::write_mesh(folder.file("a.obj"), file, file.polygons.positions);
  CHECK_THAT(slurp(folder.file("a.obj")), Catch::Contains("v 0 0 0 1 0 0.2") && Catch::EndsWith("f 1 4 2\n"));
  CHECK(written.lost == "triangle strips (the triangles are there)");
  std::string lost;
  const io::MeshFile shell = shell_there_and_back(folder, file, lost);
  CHECK_THAT(lost, Catch::Contains("triangle strips"));
  CHECK(shell.polygons.face_count() == 8);
}

TEST_CASE("ply: strips that are wrong are refused, and beside faces they are no mesh", "[io]") {
  const auto strip = [](const std::string& row) { return strips_header("ascii", "int", 1) + kPoints + row; };
  check_refused(Format::Ply, strip("3 0 1 4\n"), "below 4, got 4");
  check_refused(Format::Ply, strip("3 0 1 -2\n"),
                "line 14: expected a vertex index, or -1 at the end of a strip, got -2");
  check_refused(Format::Ply, strip("-3 0 1 2\n"), "a list length from 0 on, got -3");
  check_refused(Format::Ply, strip("4 0 1 2\n"), "expected a vertex index or -1");
  check_refused(Format::Ply, strip("2 0 1\n"), "at least one face");
  const std::string both = replaced_everywhere(strips_header("ascii", "int", 1), "end_header\n",
                                               "element face 1\nproperty list uchar int vertex_index\nend_header\n") +
                           kPoints + "3 0 1 2\n3 1 2 3\n";
  const io::MeshFile file = parse(Format::Ply, both);
  CHECK(file.polygons.corners == CornerList{1, 2, 3});
  CHECK(file.extras == std::vector<std::string>{"element 'tristrips'"});
}

TEST_CASE("ply: faces of fewer than three corners are refused by name", "[io]") {
  for (const int corners : {-1, 0, 1, 2}) {
    const std::string header = "ply\nformat FORMAT 1.0\nelement vertex 4\n" + kXyz +
                               "element face 2\nproperty list int int vertex_indices\nend_header\n";
    std::string text = replaced_everywhere(header, "FORMAT", "ascii") + kPoints + fmt::format("3 0 1 2\n{} ", corners),
                binary = replaced_everywhere(header, "FORMAT", "binary_little_endian");
    for (int i = 0; i < 12; ++i) binary += raw(static_cast<float>(i));
    for (const std::int32_t i : {3, 0, 1, 2, corners}) binary += raw(i);
    for (std::int32_t k = 0; k < corners; ++k) text += fmt::format("{} ", k), binary += raw(k);
    const std::string message = fmt::format("expected at least 3 corners in face 1, got {}", corners);
    check_refused(Format::Ply, text, message);
    check_refused(Format::Ply, binary, message);
  }
}

TEST_CASE("ply: a header whose lines end in carriage returns, before a text or binary numbers", "[io]") {
  const Folder folder;
  for (const bool binary : {false, true}) {
    std::string bytes = replaced_everywhere("ply\nformat " + std::string(binary ? "binary_little_endian" : "ascii") +
                                                " 1.0\ncomment old\nelement vertex 3\n" + kXyz +
                                                "element face 1\nproperty list uchar uchar vertex_index\nend_header\n",
                                            "\n", "\r");
    if (binary) {
      // The first byte of the body looks like a line feed.
      for (const float x : {1.1938e-42f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) bytes += raw(x);
      bytes += std::string("\3\0\1\2", 4);
    } else {
      bytes += "0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r";
    }
    const io::MeshFile file = io::read_mesh(folder.write("a.ply", bytes));
    CHECK(file.polygons.corners == CornerList{0, 1, 2});
    CHECK(file.polygons.positions[2] == Vec3d(0, 1, 0));
    CHECK(io::patched_bytes(file, file.polygons.positions) == bytes);
    if (!binary) CHECK_THAT(moved(file, {0, 0, 2}), Catch::Contains("0 0 2\r1 0 2\r0 1 2\r3 0 1 2\r"));
    std::string lost;
    const io::MeshFile shell = shell_there_and_back(folder, file, lost);
    const std::string header(shell.text().substr(0, shell.text().find("end_header")));
    CHECK(header.find('\n') == std::string::npos);
    CHECK_THAT(header, Catch::Contains("\relement vertex 6\r") && Catch::Contains("\rproperty uchar part\r"));
  }
  check_refused(Format::Ply, "ply\rformat ascii 1.0\relement vertex x\r", "line 3: expected a number of elements");
}

TEST_CASE("ply: the last line may lack its end, even if no other follows the vertices", "[io]") {
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                    rows = "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  for (const char* const name : {"face", "tristrips"}) {
    const io::MeshFile file = parse(
        Format::Ply, fmt::format("ply\nformat ascii 1.0\n{}element {} 1\nproperty list uchar int vertex_indices\n{}",
                                 vertices, name, rows));
    CHECK(file.polygons.corners == CornerList{0, 1, 2});
  }
}

TEST_CASE("stl: a mark of byte order stands before a text, and stays", "[io]") {
  const std::string text =
      "\xef\xbb\xbfsolid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\n"
      "endsolid x\n";
  const io::MeshFile file = parse(Format::Stl, text);
  CHECK(file.polygons.face_count() == 1);
  CHECK(moved(file, {0, 0, 0}) == text);
}

TEST_CASE("shells: new rows of a text end as its lines do", "[io][shell]") {
  const Folder folder;
  std::string lost;
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 4\n" + kXyz +
                          "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + kPoints +
                          "3 0 1 2\n";
  for (const auto& [format, text] :
       {std::pair{Format::Ply, ply}, {Format::Off, "OFF\n4 1 0\n" + kPoints + "3 0 1 2\n"}}) {
    const io::MeshFile shell =
        shell_there_and_back(folder, parse(format, replaced_everywhere(text, "\n", "\r\n")), lost);
    CHECK(std::ranges::count(shell.text(), '\n') == std::ranges::count(shell.text(), '\r'));
  }
}

TEST_CASE("io: texts whose lines end in carriage returns are read and kept", "[io]") {
  const Folder folder;
  const std::pair<Format, std::string> texts[] = {
      {Format::Obj, "# old\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng part\nf 1 2 3\n"},
      {Format::Off, "OFF # old\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2"},
      {Format::Stl,
       "solid old\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
       "endfacet\nendsolid\n"}};
  for (const auto& [format, text] : texts) {
    const std::string bytes = replaced_everywhere(text, "\n", "\r");
    const io::MeshFile file = io::read_mesh(folder.write(std::string("a.") + io::name(format), bytes)),
                       other = parse(format, text);
    CHECK(file.polygons.corners == CornerList{0, 1, 2});
    CHECK(io::patched_bytes(file, file.polygons.positions) == bytes);
    CHECK(moved(file, {0.5, 0, 0}) == replaced_everywhere(moved(other, {0.5, 0, 0}), "\n", "\r"));
    std::string lost;
    const io::MeshFile shell = shell_there_and_back(folder, file, lost);
    CHECK(io::rows_of(shell).has_carriage_returns);
  }
  const std::vector<std::uint8_t> chosen = io::select_faces(
      io::read_mesh(folder.file("a.obj")), std::vector<io::Selector>{io::parse_selector("group=part")});
  CHECK(chosen == std::vector<std::uint8_t>{1});
  check_refused(Format::Obj, "v 0 0 0\rv 1 0 0\rv 0 1 x\rf 1 2 3\r", "line 3: expected a coordinate, got 'x'");
  const io::CurveFile curve = io::read_curves(folder.write("c.txt", "0 0\r1 0\r1 1\r\r3 3\r4 4\r"));
  CHECK(curve.file.polygons.face_count() == 2);
  io::write_curves(folder.file("d.txt"), curve, shifted(curve.file.polygons.positions, {1, 0, 0}));
  CHECK(slurp(folder.file("d.txt")) == "1 0\r2 0\r2 1\r\r4 3\r5 4\r");
}

TEST_CASE("off: binary files are read, and kept but for coordinates and normals", "[io]") {
  const Folder folder;
  const std::string plain = binary_off("OFF", kSquare);
  const io::MeshFile file = parse(Format::Off, plain);
  CHECK(file.polygons.corners == CornerList{0, 1, 2, 0, 2, 3});
  CHECK(file.polygons.positions[3] == Vec3d(0, 1, 0.1f));
  CHECK(io::patched_bytes(file, file.polygons.positions) == plain);
  CHECK(moved(file, {0, 0, 2}) == binary_off("OFF", {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2.1f}}));

  const std::string rich = binary_off("STCNOFF", kRichSquare);
  const io::MeshFile all = io::read_mesh(folder.write("a.off", rich));
  CHECK(io::patched_bytes(all, all.polygons.positions) == rich);
  const io::MeshFile turned = parse(Format::Off, moved(all, {1, 0, 0}));
  CHECK(turned.polygons.positions[1] == Vec3d(2, 0, 0));
  const io::Attributes with = io::read_attributes(all);
  CHECK(with.colours[1] == std::array<double, 4>{1, 1, 0, 1});
  CHECK(with.texture.value[2] == Vec2d(1, 1));
  CHECK(with.normals.value[0] == Vec3d(0, 0, 1));
  CHECK(with.lost == std::vector<std::string>{"face colours"});
}

TEST_CASE("off: shells of binary files are binary, colours of faces and all", "[io]") {
  const Folder folder;
  std::string lost;
  const io::MeshFile file = parse(Format::Off, binary_off("STCNOFF", kRichSquare)),
                     shell = shell_there_and_back(folder, file, lost);
  CHECK(shell.encoding == io::Encoding::BigEndian);
  const io::Attributes with = io::read_attributes(shell);
  CHECK(with.colours[5] == std::array<double, 4>{1, 1, 0, 1});
  CHECK(with.normals.value[4] == Vec3d(0, 0, -1));
  CHECK(with.lost == std::vector<std::string>{"face colours"});
}

TEST_CASE("off: binary files that are cut short or lie are refused", "[io]") {
  const std::string whole = binary_off("CNOFF", {{0, 0, 0, 0, 0, 1, 1, 0, 0, 1},
                                                 {1, 0, 0, 0, 0, 1, 1, 1, 0, 1},
                                                 {1, 1, 0, 0, 0, 1, 1, 0, 1, 1},
                                                 {0, 1, 0, 0, 0, 1, 0, 0, 1, 1}});
  CHECK_NOTHROW(parse(Format::Off, whole));
  for (std::size_t size = 13; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK_THROWS_AS(parse(Format::Off, whole.substr(0, size)), InvalidInput);
  }
  const auto with = [&](std::size_t word, auto value) {
    return std::string(whole).replace(13 + 4 * word, 4, raw(value, true));
  };
  check_refused(Format::Off, with(0, std::int32_t{-4}), "a number of vertices");
  check_refused(Format::Off, with(1, std::int32_t{1 << 30}), "a number of faces that the rest of the file");
  check_refused(Format::Off, with(3, std::numeric_limits<float>::infinity()), "byte 25: expected a finite coordinate");
  check_refused(Format::Off, with(43, std::int32_t{1}), "at least 3 corners in face 0, got 1");
  check_refused(Format::Off, with(44, std::int32_t{4}), "a vertex index below 4, got 4");
  check_refused(Format::Off, with(47, std::int32_t{99}), "0 to 4 components");
}

TEST_CASE("obj: corners that name what there is none of are read, and told", "[io]") {
  const io::MeshFile normals = parse(Format::Obj, kTriangle + "f 1//1 2//-2 3//7\n");
  CHECK(normals.polygons.corners == CornerList{0, 1, 2});
  REQUIRE(normals.remarks.size() == 1);
  CHECK_THAT(normals.remarks[0], Catch::Contains("no 'vn' line"));
  const io::MeshFile both = parse(Format::Obj, kTriangle + "f 1/1/1 2/1/1 3/1/1\n");
  CHECK(both.remarks.size() == 2);
  CHECK(io::rows_of(both).corner_normal.empty());
  const std::string moved_text = moved(both, {0, 0, 1});
  CHECK_THAT(moved_text, Catch::EndsWith("f 1/1/1 2/1/1 3/1/1\n"));
  CHECK_THAT(parse(Format::Obj, kTriangle + "f 1/1 2/1 3/1\n").remarks.at(0), Catch::Contains("no 'vt' line"));
  CHECK(parse(Format::Obj, kTriangle + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n").remarks.empty());
  check_refused(Format::Obj, kTriangle + "vn 0 0 1\nf 1//1 2//2 3//1\n", "a normal index up to 1");
  check_refused(Format::Obj, kTriangle + "f 1//x 2//1 3//1\n", "a normal index");
}

TEST_CASE("io: numbers that no program writes are refused in every text", "[io]") {
  const std::string longest = "0." + std::string(328, '3'), longer = "0." + std::string(398, '3'),
                    huge = std::string(400, '1');
  for (const std::string& number : {longer, huge}) {
    const std::string row = "0 0 " + number + "\n", message = "of at most 330 characters, got '";
    check_refused(Format::Obj, "v " + row + "v 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1: expected a coordinate " + message);
    check_refused(Format::Off, "OFF\n3 1 0\n" + row + "1 0 0\n0 1 0\n3 0 1 2\n", "line 3: expected a coordinate");
    check_refused(Format::Ply,
                  "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz +
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + row +
                      "1 0 0\n0 1 0\n3 0 1 2\n",
                  "line 10: expected a coordinate " + message);
    check_refused(Format::Stl,
                  "solid\nfacet normal 0 0 1\nouter loop\nvertex " + row +
                      "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
                  message);
    CHECK_THROWS_WITH(io::parse_vertex_numbers("n.txt", "1\n" + number + "\n", 2),
                      Catch::Contains("line 2: expected a number of at most 330 characters for vertex 1"));
    CHECK_THROWS_WITH(io::parse_curves("c.txt", io::CurveFormat::Text, "0 0\n1 " + number + "\n"),
                      Catch::Contains("line 2"));
    CHECK_THROWS_AS(io::parse_curves("c.svg", io::CurveFormat::Svg,
                                     "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 " + number + "'/></svg>"),
                    InvalidInput);
    check_refused(Format::Obj, kTriangle + "f 1 2 " + huge + "\n", "line 4: expected a vertex index");
  }
  CHECK(parse(Format::Obj, "v 0 0 " + longest + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").polygons.positions[0][2] ==
        Approx(1.0 / 3));
}

TEST_CASE("io: a message lists a handful of names, those that are nearest", "[io]") {
  std::string text = kTriangle;
  for (int g = 0; g < 20000; ++g) text += fmt::format("g part_{:05}\nusemtl paint_{:05}\nf 1 2 3\n", g, g);
  const io::MeshFile file = parse(Format::Obj, text);
  for (const std::string wanted : {"group=part_1234", "material=Paint_01234x"}) {
    try {
      io::select_faces(file, std::vector<io::Selector>{io::parse_selector(wanted)});
      FAIL("expected it to be refused");
    } catch (const InvalidOption& error) {
      const std::string message = error.what();
      CHECK(message.size() < 250);
      CHECK_THAT(message, Catch::Contains("_01234") && Catch::Contains("and 19995 more"));
    }
  }
  CHECK(io::nearest_names("rod", {"blue", "red", "read"}) == "blue, red, read");
  CHECK(io::nearest_names("rod", {"blue", "green", "red", "read", "yellow", "rodeo"}) ==
        "red, read, rodeo, blue, green and 1 more");
  CHECK(io::nearest_names("x", {std::string(100, 'y')}) == std::string(48, 'y') + "...");
  CHECK(io::nearest_names("x", {"a\nb"}) == "a?b");

  std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz;
  for (int p = 0; p < 1000; ++p) header += fmt::format("property uchar p{}\n", p);
  header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  std::string zeros;
  for (int p = 0; p < 1000; ++p) zeros += " 0";
  const Folder folder;
  const io::MeshFile many = io::read_mesh(
      folder.write("a.ply", header + "0 0 0" + zeros + "\n1 0 0" + zeros + "\n0 1 0" + zeros + "\n3 0 1 2\n"));
  CHECK_THROWS_WITH(io::vertex_property(many, "q77"), Catch::Contains("p77") && Catch::Contains("more"));
  const std::string lost = io::write_mesh(folder.file("a.obj"), many, many.polygons.positions).lost;
  CHECK(lost.size() < 400);
  CHECK_THAT(lost, Catch::EndsWith("and 988 more"));
}

}  // namespace odd_files
