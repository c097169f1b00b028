// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include "ground/numbers/index_set.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "support/shells.h"
#include "valid/faults/rim_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

namespace shell_files {
using namespace vdb_offset::test::shells;
namespace {

using U8 = std::uint8_t;
using I16 = std::int16_t;

/// A file's shell, its outer skin raised by 1; written and read.
struct Written {
  std::string bytes, lost;
  Shell shell;
  io::MeshFile back;
};

Written written(const std::string& from, const std::string& bytes, const std::string& to,
                const io::WriteOptions& options = {}, bool source_is_inner = true) {
  const Folder folder;
  const io::MeshFile file = io::parse_mesh("in." + from, *io::format_of("in." + from), bytes);
  const std::vector<Vec3d> moved = raised(file.polygons.positions, source_is_inner ? 1 : -1);
  Written result;
  result.shell = source_is_inner ? make_shell(file.polygons.view(), moved, file.polygons.positions, {})
                                 : make_shell(file.polygons.view(), file.polygons.positions, moved, {});
  result.lost = io::write_shell(folder.file("out." + to), file, result.shell, options).lost;
  result.bytes = slurp(folder.file("out." + to));
  result.back = io::read_mesh(folder.write("back." + to, result.bytes));
  if (to != "stl") {
    CHECK(result.back.polygons.positions == result.shell.polygons.positions);
    CHECK(result.back.polygons.corners == result.shell.polygons.corners);
    CHECK(result.back.polygons.face_begin == result.shell.polygons.face_begin);
  }
  return result;
}

const std::string kTwoParts =
    "# made by hand\nmtllib a.mtl\nv 0 0 0 1 0 0\nv 1.50 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 1\n"
    "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvn 0 0 1\no part\ng left\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/1 # face\n"
    "g right both\nusemtl blue\nf -3/2/1 -1/-1/1 -2/3/1\nl 1 -3\nunknown 1";

/// What an OBJ file says of a face, besides its vertices.
struct ObjFace {
  std::string group, object, material, smooth;
  std::vector<std::string> textures, normals;  // the values, not the numbers
};

std::string value(const std::vector<std::string>& values, const std::string& number) {
  if (number.empty()) return {};
  const long index = std::stol(number);
  return values.at(static_cast<std::size_t>(index < 0 ? static_cast<long>(values.size()) + index : index - 1));
}

std::vector<ObjFace> obj_faces(const std::string& text) {
  std::vector<std::string> textures, normals;
  std::vector<ObjFace> faces;
  ObjFace now;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string keyword = line.substr(0, line.find(' ')),
                      rest = keyword.size() < line.size() ? line.substr(keyword.size() + 1) : "";
    if (keyword == "vt") textures.push_back(rest);
    if (keyword == "vn") normals.push_back(rest);
    if (keyword == "g") now.group = rest;
    if (keyword == "o") now.object = rest;
    if (keyword == "usemtl") now.material = rest;
    if (keyword == "s") now.smooth = rest == "off" ? "" : rest;
    if (keyword != "f") continue;
    ObjFace face = now;
    std::istringstream corners(rest);
    for (std::string corner; corners >> corner;) {
      const std::size_t first = corner.find('/'), second = corner.find('/', first + 1);
      const std::string t = first == std::string::npos ? "" : corner.substr(first + 1, second - first - 1),
                        n = second == std::string::npos ? "" : corner.substr(second + 1);
      face.textures.push_back(value(textures, t));
      face.normals.push_back(value(normals, n));
    }
    faces.push_back(face);
  }
  return faces;
}

/// Compares every face of a shell's file with the one it comes from.
void check_obj_faces(const std::string& source, const Written& result) {
  const std::vector<ObjFace> before = obj_faces(source), after = obj_faces(result.bytes);
  const Polygons polygons = io::parse_mesh("in.obj", io::Format::Obj, source).polygons;
  const PolygonView mesh = polygons.view();
  REQUIRE(after.size() == result.shell.polygons.face_count());
  std::size_t different = 0;
  for (std::size_t f = 0; f < after.size(); ++f) {
    const ShellPart part = result.shell.part(f);
    const ObjFace& of = before[result.shell.source_face(f)];
    const std::string group = part == ShellPart::Rim ? "rim"
                              : of.group.empty()     ? name(part)
                                                     : name(part) + (" " + of.group);
    different += after[f].group != group || after[f].material != of.material || after[f].object != of.object ||
                 after[f].smooth != (part == ShellPart::Rim ? "" : of.smooth);
    for (std::size_t k = 0; k < after[f].textures.size(); ++k) {
      const std::size_t corner = result.shell.source_corner(mesh, f, k) - mesh.face_begin[result.shell.source_face(f)];
      different += after[f].textures[k] != of.textures[corner];
      different += after[f].normals[k].empty() != (part == ShellPart::Rim || of.normals[corner].empty());
    }
  }
  CHECK(different == 0);
}

/// Two triangles in a PLY file, or the shell of them, in any encoding.
class PlyText {
 public:
  explicit PlyText(const std::string& encoding) : encoding_(encoding) {}
  PlyText& header(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  template <class... Numbers>
  PlyText& row(Numbers... numbers) {
    std::size_t left = sizeof...(numbers);
    (append(numbers, --left == 0), ...);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  void append(T number, bool last) {
    if (encoding_ == "ascii") {
      bytes_ += fmt::format("{}{}", number, last ? "\n" : " ");
      return;
    }
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    if (encoding_ == "binary_big_endian") std::reverse(raw, raw + sizeof number);
    bytes_.append(raw, sizeof number);
  }
  std::string encoding_, bytes_;
};

std::string ply_header(const std::string& encoding, int vertices, int faces, const std::string& part) {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment by hand\nelement vertex {}\nproperty float x\nproperty uchar red\nproperty float y\n"
      "property float z\nproperty float nz\nproperty float nx\nproperty float ny\nproperty list uchar short tags\n"
      "element edge 1\nproperty short vertex1\nproperty short vertex2\nelement face {}\nproperty float quality\n"
      "property list uchar short vertex_indices\nproperty list uchar float texcoord\nproperty short flags\n{}"
      "end_header\n",
      encoding, vertices, faces, part);
}

}  // namespace

TEST_CASE("shell: an obj keeps everything on both sides", "[shell]") {
  const Written result = written("obj", kTwoParts, "obj");
  CHECK(result.lost.empty());
  CHECK(result.bytes ==
        "# made by hand\nmtllib a.mtl\nv 0 0 1 1 0 0\nv 1.5 0 1 0 1 0\nv 0 1 1 0 0 1\nv 1 1 1 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvn 0 0 1\no part\ng outer left\nusemtl red\ns 1\n"
        "f 1/1/1 2/2/1 3/3/1 # face\ng outer right both\nusemtl blue\nf -3/2/1 -1/-1/1 -2/3/1\nunknown 1\n"
        "v 0 0 0 1 0 0\nv 1.50 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 1\nvn 0 0 -1\n"
        "g inner left\nusemtl red\nf 5/1/2 7/3/2 6/2/2\ng inner right both\nusemtl blue\nf 6/2/2 7/3/2 8/4/2\nl 5 6\n"
        "g rim\nusemtl red\ns off\nf 2/2 1/1 5/1 6/2\nf 1/1 3/3 7/3 5/1\nusemtl blue\nf 4/4 2/2 6/2 8/4\n"
        "f 3/3 4/4 8/4 7/3\n");
  check_solid(result.shell);

  // With the source outside, its lines stay where they are.
  const Written inwards = written("obj", kTwoParts, "obj", {}, false);
  std::string before = kTwoParts + "\n";
  before.replace(before.find("g left"), 6, "g outer left").replace(before.find("g right"), 7, "g outer right");
  CHECK_THAT(inwards.bytes, Catch::StartsWith(before + "v 0 0 -1 1 0 0\nv 1.5 0 -1 0 1 0\n"));
}

TEST_CASE("shell: an obj without groups, with late materials and objects, and with its normals kept", "[shell]") {
  const std::string obj =
      "\xef\xbb\xbfv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nv 2 0 0\r\nvn 0.6 0 0.8\r\nf 1//1 2//1 3//1 4//1\r\n"
      "usemtl red\r\ns 2\r\no late\r\nf 2 5 \\\r\n 3\r\n";
  const Written result = written("obj", obj, "obj", {.normals = io::Normals::Keep});
  CHECK(result.lost == "that the inner skin's first faces are in no object");
  CHECK(result.bytes ==
        "\xef\xbb\xbfv 0 0 1\r\nv 1 0 1\r\nv 1 1 1\r\nv 0 1 1\r\nv 2 0 1\r\nvn 0.6 0 0.8\r\ng outer\n"
        "f 1//1 2//1 3//1 4//1\r\nusemtl red\r\ns 2\r\no late\r\nf 2 5 \\\r\n 3\r\n"
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nvn -0.6 0 -0.8\n"
        "g inner\nusemtl\ns off\nf 6//2 9//2 8//2 7//2\nusemtl red\r\ns 2\r\nf 7 8 10\n"
        "g rim\nusemtl\ns off\nf 2 1 6 7\nf 4 3 8 9\nf 1 4 9 6\nusemtl red\r\nf 5 2 7 10\nf 3 5 10 8\n");
}

TEST_CASE("shell: a large obj with seams, groups and materials, face by face", "[shell][long]") {
  const Polygons patch = shapes::patch(1, 0.1, 150);
  for (const bool relative : {false, true}) {
    std::string obj = "mtllib a.mtl\n";
    for (const Vec3d& p : patch.positions) obj += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
    std::size_t textures = 0;
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      // Four texture coordinates for each face: nothing but seams.
      for (int k = 0; k < 4; ++k) obj += fmt::format("vt {} {}\n", f, k);
      textures += 4;
      if (f % 700 == 0) obj += fmt::format("g group{} all\n", f / 700);
      if (f % 999 == 0) obj += fmt::format("usemtl material{}\n", f / 999 % 5);
      if (f % 5000 == 0) obj += fmt::format("o object{}\n", f / 5000);
      if (f % 333 == 0) obj += f % 2 == 0 ? "s off\n" : fmt::format("s {}\n", f);
      obj += "f";
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t v = patch.view().face(f)[k];
        if (relative) obj += fmt::format(" -{}/-{}", patch.positions.size() - v, 4 - k);
        else obj += fmt::format(" {}/{}", v + 1, textures - 3 + k);
      }
      obj += "\n";
    }
    REQUIRE(obj.size() > (std::size_t{1} << 20));  // some pieces
    for (const bool source_is_inner : {true, false}) {
      const Written result = written("obj", obj, "obj", {}, source_is_inner);
      CHECK(result.lost.empty());
      CHECK(result.shell.facts.rim_quads == 600);
      check_obj_faces(obj, result);
    }
  }
}

TEST_CASE("shell: a ply keeps all properties of both sides, in every encoding", "[shell]") {
  for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    INFO(encoding);
    PlyText source(encoding), expected(encoding);
    source.header(ply_header(encoding, 3, 1, ""));
    source.row(0.f, U8{1}, 0.f, 0.f, 1.f, 0.f, 0.f, U8{1}, I16{-7})
        .row(1.f, U8{2}, 0.f, 0.f, 1.f, 0.f, 0.f, U8{0})
        .row(0.f, U8{3}, 1.f, 0.f, .8f, 0.f, .6f, U8{0})
        .row(I16{0}, I16{2})
        .row(.5f, U8{3}, I16{0}, I16{1}, I16{2}, U8{6}, 0.f, .25f, 1.f, .5f, 0.f, .75f, I16{-3});
    expected.header(ply_header(encoding, 6, 5, "property uchar part\n"));
    expected.row(0.f, U8{1}, 0.f, 1.f, 1.f, 0.f, 0.f, U8{1}, I16{-7})
        .row(1.f, U8{2}, 0.f, 1.f, 1.f, 0.f, 0.f, U8{0})
        .row(0.f, U8{3}, 1.f, 1.f, 1.f, 0.f, 0.f, U8{0})
        .row(0.f, U8{1}, 0.f, 0.f, -1.f, 0.f, 0.f, U8{1}, I16{-7})
        .row(1.f, U8{2}, 0.f, 0.f, -1.f, 0.f, 0.f, U8{0})
        .row(0.f, U8{3}, 1.f, 0.f, -.8f, 0.f, -.6f, U8{0})
        .row(I16{0}, I16{2})
        .row(.5f, U8{3}, I16{0}, I16{1}, I16{2}, U8{6}, 0.f, .25f, 1.f, .5f, 0.f, .75f, I16{-3}, U8{0})
        .row(.5f, U8{3}, I16{3}, I16{5}, I16{4}, U8{6}, 0.f, .25f, 0.f, .75f, 1.f, .5f, I16{-3}, U8{1})
        .row(.5f, U8{4}, I16{1}, I16{0}, I16{3}, I16{4}, U8{8}, 1.f, .5f, 0.f, .25f, 0.f, .25f, 1.f, .5f, I16{-3},
             U8{2})
        .row(.5f, U8{4}, I16{2}, I16{1}, I16{4}, I16{5}, U8{8}, 0.f, .75f, 1.f, .5f, 1.f, .5f, 0.f, .75f, I16{-3},
             U8{2})
        .row(.5f, U8{4}, I16{0}, I16{2}, I16{5}, I16{3}, U8{8}, 0.f, .25f, 0.f, .75f, 0.f, .75f, 0.f, .25f, I16{-3},
             U8{2});
    const Written result = written("ply", source.bytes(), "ply");
    CHECK(result.bytes == expected.bytes());
    CHECK(result.lost.empty());
    // A shell of the shell: the property is taken.
    CHECK(written("ply", result.bytes, "ply").lost == "the parts of the shell (the face property 'part' is taken)");
  }
}

TEST_CASE("shell: a ply's list of corners is widened where its numbers are too small", "[shell]") {
  const Polygons patch = shapes::patch(1, 0, 13);  // 196 vertices, 392 in the shell
  for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    PlyText text(encoding);
    text.header(
        fmt::format("ply\r\nformat {} 1.0\r\nelement vertex 196\r\nproperty double x\r\nproperty double y\r\n"
                    "property double z\r\nelement face 169\r\nproperty list int uchar vertex_index\r\n"
                    "end_header\r\n",
                    encoding));
    for (const Vec3d& p : patch.positions) text.row(p[0], p[1], p[2]);
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto face = patch.view().face(f);
      text.row(4, static_cast<U8>(face[0]), static_cast<U8>(face[1]), static_cast<U8>(face[2]),
               static_cast<U8>(face[3]));
    }
    const Written result = written("ply", text.bytes(), "ply");
    CHECK_THAT(result.bytes,
               Catch::Contains("property list int int vertex_index\r\nproperty uchar part\r\nend_header\r\n"));
  }
}

TEST_CASE("shell: stl files have a solid for each part, or keep attribute bytes", "[shell]") {
  const std::string facet =
      "facet normal 0.6 0 0.8\nouter loop\nvertex 0 0 0\nvertex 1.0 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  const Written text = written("stl", "solid my part\n" + facet + "endsolid\n", "stl");
  const auto loop = [](const std::string& normal, const std::string& a, const std::string& b, const std::string& c) {
    return "  facet normal " + normal + "\n    outer loop\n      vertex " + a + "\n      vertex " + b +
           "\n      vertex " + c + "\n    endloop\n  endfacet\n";
  };
  CHECK(text.lost.empty());
  CHECK_THAT(text.bytes,
             Catch::StartsWith("solid outer my part\n" + loop("0 0 1", "0 0 1", "1 0 1", "0 1 1") +
                               "endsolid outer my part\nsolid inner my part\n" +
                               loop("-0.6 0 -0.8", "0 0 0", "0 1 0", "1.0 0 0") +
                               "endsolid inner my part\nsolid rim\n" + loop("0 -1 0", "1 0 1", "0 0 1", "0 0 0")));
  CHECK(text.back.polygons.face_count() == 8);
  CHECK(build_surface(text.back.polygons.view(), {}).facts.closed());
  const std::string two = "solid a\n" + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n";
  CHECK(written("stl", two, "stl").lost == "the source's solids and their names");

  PlyText source("binary_little_endian"), start("binary_little_endian");
  source.header(std::string(80, 'h')).row(1u).row(9.f, 9.f, 9.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f);
  source.row(std::uint16_t{0xabcd}).header("tail");
  start.header(std::string(80, 'h')).row(8u).row(0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 1.f, 0.f, 1.f, 1.f);
  start.row(std::uint16_t{0xabcd}).row(-9.f, -9.f, -9.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f);
  start.row(std::uint16_t{0xabcd}).row(0.f, -1.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f);
  start.row(std::uint16_t{0xabcd});
  const Written binary = written("stl", source.bytes(), "stl");
  CHECK_THAT(binary.bytes, Catch::StartsWith(start.bytes()) && Catch::EndsWith("tail"));
  CHECK_THAT(binary.lost, Catch::StartsWith("the parts of the shell"));
  CHECK(build_surface(binary.back.polygons.view(), {}).facts.closed());
}

TEST_CASE("shell: what counts as one vertex is at one position, also where it stays", "[shell]") {
  // A pipe of strips, closed by a seam that is apart by the rounding of sines, and with lids. In STL, equal coordinates
  // alone tell that vertices are one.
  const auto rounded = [](int k, double z) {
    const double angle = 2 * M_PI * k / 16;
    return fmt::format("vertex {:.17g} {:.17g} {:.17g}\n", std::cos(angle), std::sin(angle), z);
  };
  const auto loop = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 0\nouter loop\n" + a + b + c + "endloop\nendfacet\n";
  };
  std::string open = "solid s\n";
  for (int k = 0; k < 16; ++k)
    open += loop(rounded(k, 0), rounded(k + 1, 0), rounded(k + 1, 2)) +
            loop(rounded(k, 0), rounded(k + 1, 2), rounded(k, 2));
  std::string closed = open;
  for (int k = 0; k < 16; ++k)
    closed += loop("vertex 0 0 0\n", rounded(k + 1, 0), rounded(k, 0)) +
              loop("vertex 0 0 2\n", rounded(k, 2), rounded(k + 1, 2));
  const Folder folder;
  for (const auto& [text, borders] : {std::pair<std::string, std::size_t>{open, 32}, {closed, 0}}) {
    const io::MeshFile file = io::read_mesh(folder.write("in.stl", text + "endsolid s\n"));
    REQUIRE(build_surface(file.polygons.view(), {}).facts.boundary_edges > borders);
    for (const double distance : {0.1, -0.1}) {
      OffsetOptions options;
      options.distance = distance;
      options.off_source = true;
      const Shell shell = shell_of(file.polygons.view(), offset(file.polygons.view(), options), options);
      CHECK(shell.facts.closed);
      for (const char* name : {"out.stl", "out.obj", "out.ply"}) {
        io::write_shell(folder.file(name), file, shell);
        const io::MeshFile back = io::read_mesh(folder.file(name));
        CHECK(build_surface(back.polygons.view(), {}).facts.closed());
      }
    }
    // As they were read, if nothing is to count as one that is not.
    OffsetOptions exact;
    exact.distance = 0.1;
    exact.weld = WeldOptions();
    const Shell shell = shell_of(file.polygons.view(), offset(file.polygons.view(), exact), exact);
    CHECK(std::equal(file.polygons.positions.begin(), file.polygons.positions.end(), shell.inner().begin()));
  }
  const io::MeshFile file = io::read_mesh(folder.write("in.stl", closed + "endsolid s\n"));
  IsoOptions iso;
  iso.distance = -0.3;
  iso.grid.voxel_size = 0.1;
  const IsoResult cavity = make_iso_surface(file.polygons.view(), iso);
  const Hollow hollow = make_hollow(file.polygons.view(), cavity.polygons.view(), Hollow::Source::Outer, iso.weld);
  CHECK(hollow.facts.closed);
  CHECK_FALSE(make_hollow(file.polygons.view(), cavity.polygons.view(), Hollow::Source::Outer).facts.closed);
}

TEST_CASE("shell: an off keeps colours of vertices and faces", "[shell]") {
  const Written result = written("off",
                                 "CNOFF # colours\n# counts\n3 1 3\n# first\n0 0 0 0.6 0 0.8 255 0 0 255\n"
                                 "1.0 0 0 0 0 1 0 255 0 255 # second\n0 1 0 0 0 1 0 0 255 255\n3 0 1 2 0.5 0.25 1",
                                 "off");
  CHECK(result.bytes ==
        "CNOFF # colours\n# counts\n6 5 0\n# first\n0 0 1 0 0 1 255 0 0 255\n1 0 1 0 0 1 0 255 0 255 # second\n"
        "0 1 1 0 0 1 0 0 255 255\n0 0 0 -0.6 0 -0.8 255 0 0 255\n1.0 0 0 0 0 -1 0 255 0 255\n"
        "0 1 0 0 0 -1 0 0 255 255\n3 0 1 2 0.5 0.25 1\n3 3 5 4 0.5 0.25 1\n4 1 0 3 4 0.5 0.25 1\n"
        "4 2 1 4 5 0.5 0.25 1\n4 0 2 5 3 0.5 0.25 1\n");
  CHECK_THAT(result.lost, Catch::StartsWith("the parts of the shell"));
  for (const std::string counts : {"3\n1\n0", "3 1"})
    CHECK_THAT(written("off", "OFF\n" + counts + "\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "off").bytes,
               Catch::StartsWith("OFF\n6 5 0\n0 0 1\n"));
}

TEST_CASE("shell: in other formats, both sides have what the format can hold", "[shell]") {
  const Written ply = written("obj", kTwoParts, "ply");
  CHECK_THAT(ply.bytes, Catch::Contains("property uchar red") && Catch::Contains("property double nx\n") &&
                            Catch::Contains("property double s\n") &&
                            Catch::Contains("property uchar part\nend_header\n"));
  CHECK(ply.lost == "materials, groups and object names, smoothing groups, other lines");
  CHECK(ply.bytes.back() == '\2');
  // A closed solid has no rim.
  CHECK_THAT(written("ply", ply.bytes, "obj").bytes, Catch::Contains("\ng outer\nf 1/1/1 ") &&
                                                         Catch::Contains("\ng inner\nf 9/9/9 ") &&
                                                         !Catch::Contains("g rim"));
  const Written off = written("obj", kTwoParts, "off");
  CHECK_THAT(off.bytes, Catch::StartsWith("STCNOFF\n8 8 0\n0 0 1 0 0 1 255 0 0 255 0 0\n") &&
                            Catch::Contains("\n1.5 0 0 0 0 -1 0 255 0 255 1 0\n"));
  CHECK_THAT(off.lost, Catch::EndsWith("the parts of the shell (outer, inner and rim follow each other)"));
  const Written stl = written("obj", kTwoParts, "stl");
  CHECK(stl.back.polygons.face_count() == 12);
  CHECK_THAT(stl.lost, Catch::Contains("shared vertices") && Catch::Contains("the parts of the shell"));
  CHECK(build_surface(stl.back.polygons.view(), {}).facts.closed());

  const std::string off_file = "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";
  const Written grouped = written("off", off_file, "obj");
  CHECK_THAT(grouped.bytes, Catch::EndsWith("vn 0 0 -1\ng outer\nf 1//1 2//2 3//3\ng inner\nf 4//4 6//6 5//5\n"
                                            "g rim\nf 2 1 4 5\nf 3 2 5 6\nf 1 3 6 4\n"));
  CHECK(grouped.lost.empty());
  CHECK(written("off", off_file, "ply").lost.empty());
}

TEST_CASE("shell: of plain polygons, in every format", "[shell]") {
  const Folder folder;
  const Shell shell = offset_shell(upper_half(shapes::uv_sphere(1, 16, 8)), 0.1);
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    const io::WriteResult result = io::write_shell(folder.file(name), shell);
    CHECK(result.lost.empty() == (name != std::string("a.off")));
    const io::MeshFile back = io::read_mesh(folder.file(name));
    CHECK(back.polygons.positions == shell.polygons.positions);
    CHECK(back.polygons.corners == shell.polygons.corners);
  }
  CHECK_THAT(slurp(folder.file("a.obj")), Catch::Contains("\ng outer\nf ") && Catch::Contains("\ng rim\nf "));
  io::write_shell(folder.file("a.stl"), shell);
  const MeshFacts facts = build_surface(io::read_mesh(folder.file("a.stl")).polygons.view(), {}).facts;
  CHECK(facts.closed());
  CHECK(facts.oriented());
}

TEST_CASE("shell: a file of another mesh is refused", "[shell]") {
  const Folder folder;
  const Polygons mesh = quad();
  const Shell shell = make_shell(mesh.view(), raised(mesh.positions, 1), mesh.positions, {});
  const io::MeshFile other = io::parse_mesh("a.obj", io::Format::Obj, kTwoParts);
  CHECK_THROWS_WITH(io::write_shell(folder.file("b.obj"), other, shell), Catch::Contains("4 vertices and 2 faces"));
}

}  // namespace shell_files
