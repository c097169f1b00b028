// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openvdb/Types.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

#include "support/folder.h"
#include "support/random_scenes.h"
#include "support/solids.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"

using namespace vdb_offset;

namespace {

/// A file that became one of another format, or of the same.
struct Converted {
  std::string bytes, lost;
};

/// `offset` is what every vertex moves by.
Converted converted(const std::string& from, const std::string& bytes, const std::string& to,
                    const Vec3d& offset = Vec3d(0.0), const io::WriteOptions& options = {}) {
  const Folder folder;
  const io::MeshFile file = io::parse_mesh("in." + from, *io::format_of("in." + from), bytes);
  std::vector<Vec3d> positions = file.polygons.positions;
  for (Vec3d& p : positions) p += offset;
  const io::WriteResult result = io::write_mesh(folder.file("out." + to), file, positions, options);
  const io::MeshFile back = io::read_mesh(folder.file("out." + to));
  if (to != "stl") {
    CHECK(back.polygons.positions == positions);
    CHECK(back.polygons.corners == file.polygons.corners);
    CHECK(back.polygons.face_begin == file.polygons.face_begin);
  } else {
    const auto in_triangles = io::find_in_triangles(file.polygons.view(), back.polygons.view());
    REQUIRE(in_triangles.has_value());
    for (std::size_t v = 0; v < positions.size(); ++v)
      CHECK(in_triangles->positions[v] == Vec3d(openvdb::Vec3s(positions[v])));
  }
  return {slurp(folder.file("out." + to)), result.lost};
}

std::string body(const std::string& ply) { return ply.substr(ply.find("end_header\n") + 11); }

/// The numbers as a binary PLY stores them.
template <class... Numbers>
std::string stored(Numbers... numbers) {
  std::string bytes;
  const auto append = [&](auto number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    bytes.append(raw, sizeof number);
  };
  (append(numbers), ...);
  return bytes;
}

using U8 = std::uint8_t;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kColoured = "v 0 0 0 1 0 0\nv 1 0 0 0 0.2 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
/// Two triangles with a seam between them: vertices 2 and 3 have two texture coordinates each.
const std::string kSeam =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.25 0\nvt 0 0.125\nvt 0.123456 1\nvt 0.75 0.1\nvt 1 1\n"
    "f 1/1 2/2 3/3\nf 2/4 4/6 3/5\n";

std::string ply_text(const std::string& vertex_properties, const std::string& vertices,
                     const std::string& face_properties = "", const std::string& face = "3 0 1 2") {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n" +
         vertex_properties + "element face 1\nproperty list uchar int vertex_indices\n" + face_properties +
         "end_header\n" + vertices + face + "\n";
}

}  // namespace

TEST_CASE("convert: colours of vertices", "[io]") {
  const std::string off = "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 51 0 255\n0 1 0 0 0 255 255\n3 0 1 2\n";
  const Converted to_off = converted("obj", kColoured, "off");
  CHECK(to_off.bytes == off);
  CHECK(to_off.lost.empty());

  const Converted to_ply = converted("obj", kColoured, "ply");
  CHECK_THAT(to_ply.bytes, Catch::Contains("property double z\nproperty uchar red\nproperty uchar green\nproperty "
                                           "uchar blue\nelement face"));
  CHECK_THAT(body(to_ply.bytes),
             Catch::StartsWith(stored(0., 0., 0., U8{255}, U8{0}, U8{0}, 1., 0., 0., U8{0}, U8{51})));
  CHECK(to_ply.lost.empty());
  CHECK(converted("ply", to_ply.bytes, "obj").bytes == kColoured);
  CHECK(converted("ply", to_ply.bytes, "off").bytes == off);

  CHECK(converted("off", off, "obj").bytes == "v 0 0 0 1 0 0 1\nv 1 0 0 0 0.2 0 1\nv 0 1 0 0 0 1 1\nf 1 2 3\n");
  CHECK_THAT(converted("off", off, "ply").bytes, Catch::Contains("property uchar alpha"));
  CHECK(converted("off", off, "obj").lost.empty());
}

TEST_CASE("convert: colours as other programs write them", "[io]") {
  const std::string fractions = "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 0.2 0\n0 1 0 0 0 1\n3 0 1 2\n";
  CHECK(converted("off", fractions, "obj").bytes == kColoured);
  const std::string floats = ply_text("property float red\nproperty float green\nproperty float blue\n",
                                      "0 0 0 1 0 0\n1 0 0 0 0.2 0\n0 1 0 0 0 1\n");
  CHECK(converted("ply", floats, "obj").bytes == kColoured);
  const std::string halves = ply_text("property float red\nproperty float green\nproperty float blue\n",
                                      "0 0 0 1 0 0\n1 0 0 0 0.5 0\n0 1 0 0 0 1\n");
  CHECK(converted("ply", halves, "obj").lost.empty());
  CHECK(converted("ply", halves, "off").lost == "digits of colours beyond 8 bits");
}

TEST_CASE("convert: texture coordinates, one for each vertex", "[io]") {
  const std::string obj = kTriangle + "vt 0 0\nvt 0.1 0\nvt 0 0.123456789\nf 1/1 2/2 3/3\n";
  const std::string off = "STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 0.1 0\n0 1 0 0 0.123456789\n3 0 1 2\n";
  const Converted to_ply = converted("obj", obj, "ply");
  CHECK_THAT(to_ply.bytes, Catch::Contains("property double s\nproperty double t\nelement face"));
  CHECK_THAT(body(to_ply.bytes), Catch::StartsWith(stored(0., 0., 0., 0., 0., 1., 0., 0., 0.1, 0.)));
  CHECK(to_ply.lost.empty());
  CHECK(converted("ply", to_ply.bytes, "obj").bytes == obj);
  CHECK(converted("obj", obj, "off").bytes == off);
  CHECK(converted("ply", to_ply.bytes, "off").bytes == off);
  CHECK(converted("off", off, "obj").bytes == obj);
  CHECK(converted("off", off, "ply").bytes == to_ply.bytes);
  // Equal values are one value, whatever their indices.
  CHECK(converted("obj", kTriangle + "vt 0 0\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/2 3/3 2/1\n", "off").lost.empty());

  for (const std::string names : {"s t", "u v", "texture_u texture_v"}) {
    const std::size_t blank = names.find(' ');
    const std::string properties =
        "property float " + names.substr(0, blank) + "\nproperty float " + names.substr(blank + 1) + "\n";
    const Converted named = converted("ply", ply_text(properties, "0 0 0 0 0\n1 0 0 0.1 0\n0 1 0 0 1\n"), "obj");
    CHECK(named.bytes == kTriangle + "vt 0 0\nvt 0.1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    CHECK(named.lost.empty());
  }
}

TEST_CASE("convert: texture coordinates with a seam", "[io]") {
  const Converted to_ply = converted("obj", kSeam, "ply");
  CHECK_THAT(to_ply.bytes, Catch::Contains("property list uchar float texcoord\n"));
  CHECK(to_ply.lost.empty());
  const std::string faces = stored(3u, 0u, 1u, 2u, U8{6}, 0.f, 0.f, .25f, 0.f, 0.f, .125f) +
                            stored(3u, 1u, 3u, 2u, U8{6}, .123456f, 1.f, 1.f, 1.f, .75f, .1f);
  CHECK_THAT(to_ply.bytes, Catch::EndsWith(faces));
  // Texture coordinates are in the order of corners now.
  CHECK(converted("ply", to_ply.bytes, "obj").bytes ==
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.25 0\nvt 0 0.125\nvt 0.123456 1\nvt 1 1\nvt 0.75 0.1\n"
        "f 1/1 2/2 3/3\nf 2/4 4/5 3/6\n");
  for (const auto& [from, bytes] : {std::pair<std::string, std::string>{"obj", kSeam}, {"ply", to_ply.bytes}})
    CHECK(converted(from, bytes, "off").lost == "texture coordinates (not one for each vertex)");

  // More digits than a float has are kept.
  std::string fine = kSeam;
  fine.replace(fine.find("0.123456"), 8, "0.123456789012");
  const Converted fine_ply = converted("obj", fine, "ply");
  CHECK_THAT(fine_ply.bytes, Catch::Contains("property list uchar double texcoord\n"));
  CHECK_THAT(converted("ply", fine_ply.bytes, "obj").bytes, Catch::Contains("vt 0.123456789012 1\n"));
}

TEST_CASE("convert: faces without texture coordinates, and of many corners", "[io]") {
  const std::string some = kTriangle + "v 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nf 2 4 3\n";
  CHECK(converted("ply", converted("obj", some, "ply").bytes, "obj").bytes == some);
  const Converted mixed = converted("obj", kTriangle + "vt 0 0\nf 1/1 2 3\nf 1/1 2/1 3/1\n", "ply");
  CHECK(mixed.lost == "texture coordinates of faces that have them at some corners only");
  CHECK(converted("ply", mixed.bytes, "obj").bytes == kTriangle + "vt 0 0\nf 1 2 3\nf 1/1 2/1 3/1\n");
  const Converted none = converted("obj", kTriangle + "vt 0 0\nf 1/1 2 3\n", "ply");
  CHECK(none.lost == mixed.lost);
  CHECK_THAT(none.bytes, !Catch::Contains("texcoord"));

  std::string large, face = "f";
  for (int k = 1; k <= 130; ++k) {
    large += fmt::format("v {} {} 0\n", k, k * k);
    face += fmt::format(" {}/{}", k, k);
  }
  for (int k = 1; k <= 130; ++k) large += fmt::format("vt {} 0\n", k);
  large += "vt 0.5 0.5\n" + face + "\nf 1/131 2/131 3/131\n";
  const Converted to_ply = converted("obj", large, "ply");
  CHECK_THAT(to_ply.bytes, Catch::Contains("property list uint float texcoord\n"));
  CHECK(converted("ply", to_ply.bytes, "obj").bytes == large);
}

TEST_CASE("convert: normals", "[io]") {
  const std::string obj = kTriangle + "vn 0 0 1\nvn 0.6 0 0.8\nvn 0 1 0\nf 1//1 2//2 3//3\n";
  const std::string off = "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0.6 0 0.8\n0 1 0 0 1 0\n3 0 1 2\n";
  const Converted to_ply = converted("obj", obj, "ply");
  CHECK_THAT(to_ply.bytes, Catch::Contains("property double nx\nproperty double ny\nproperty double nz\nelement face"));
  CHECK(to_ply.lost.empty());
  CHECK(converted("ply", to_ply.bytes, "obj").bytes == obj);
  CHECK(converted("ply", to_ply.bytes, "off").bytes == off);
  CHECK(converted("obj", obj, "off").bytes == off);
  CHECK(converted("off", off, "obj").bytes == obj);
  CHECK(converted("off", off, "ply").bytes == to_ply.bytes);

  const std::string crease = kTriangle + "v 1 1 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 2//2 4//2 3//2\n";
  CHECK(converted("obj", crease, "ply").lost == "normals (not one for each vertex)");
  CHECK(converted("obj", crease, "off").lost == "normals (not one for each vertex)");
}

TEST_CASE("convert: a moved vertex gets a new normal", "[io]") {
  const std::string obj = kTriangle + "vn 0.6 0 0.8\nf 1//1 2//1 3//1\n";
  const Vec3d up(0, 0, 1);
  const io::WriteOptions keep{.normals = io::Normals::Keep};
  CHECK(converted("obj", obj, "off", up).bytes == "NOFF\n3 1 0\n0 0 1 0 0 1\n1 0 1 0 0 1\n0 1 1 0 0 1\n3 0 1 2\n");
  CHECK_THAT(converted("obj", obj, "off", up, keep).bytes, Catch::Contains("0 0 1 0.6 0 0.8\n"));
  CHECK_THAT(body(converted("obj", obj, "ply", up).bytes), Catch::StartsWith(stored(0., 0., 1., 0., 0., 1.)));
  CHECK_THAT(body(converted("obj", obj, "ply", up, keep).bytes), Catch::StartsWith(stored(0., 0., 1., 0.6, 0., 0.8)));
  // A normal that is no number does no harm where it is computed anew.
  const std::string nan = kTriangle + "vn nan 0 0\nf 1//1 2//1 3//1\n";
  CHECK(converted("obj", nan, "off", up).lost.empty());
  CHECK(converted("obj", nan, "off").lost == "normals");
  CHECK_THAT(converted("obj", nan, "off").bytes, Catch::StartsWith("OFF\n"));
}

TEST_CASE("convert: where vertices stand is told by triangles", "[io]") {
  // Two prongs that the fan around the first corner does not cover, and a quad.
  const std::string fork = "v 1 1 0\nv 2 3 0\nv 0 3 0\nv 0 0 0\nv 2 0 0\nv 4 0 0\nv 4 3 0\nf 1 2 3 4 5\nf 2 5 6 7\n";
  converted("obj", fork, "stl", Vec3d(0.125, 0.25, 1));
  const io::MeshFile mesh = io::parse_mesh("a.obj", io::Format::Obj, fork + "v 9 9 9\n");
  const Folder folder;
  io::write_mesh(folder.file("a.stl"), mesh.polygons.view());
  Polygons triangles = io::read_mesh(folder.file("a.stl")).polygons;
  REQUIRE(triangles.face_count() == 5);
  const auto in_triangles = io::find_in_triangles(mesh.polygons.view(), triangles.view());
  REQUIRE(in_triangles.has_value());
  CHECK(in_triangles->positions == mesh.polygons.positions);
  CHECK(in_triangles->triangles == split_polygons(mesh.polygons.view()));
  CHECK_FALSE(io::find_in_triangles(triangles.view(), mesh.polygons.view()));
  // Ears of this one, cut one after the other, look like the fan of another that is turned by a corner.
  converted("obj", "v 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nf 1 2 3 4 5 6\n", "stl", Vec3d(0.25, 0, 0));
  triangles.positions[4][2] += 1;  // of a corner that a vertex has more of
  CHECK_FALSE(io::find_in_triangles(mesh.polygons.view(), triangles.view()));
}

TEST_CASE("convert: polygons are split as in the source, wherever their corners have moved", "[io]") {
  const Polygons letter = test::letter_c(8);
  std::vector<Vec3d> moved = letter.positions;
  // Far enough out of plane that the ends are no polygons that could be split as such.
  for (std::size_t v = 0; v < moved.size(); ++v) moved[v] += Vec3d(0, 0, v % 3 == 0 ? 0.0625 : -0.0625);
  const auto right = split_polygons(letter.view());
  CHECK(split_polygons({moved, letter.corners, letter.face_begin}) != right);
  const Folder folder;
  io::write_mesh(folder.file("letter.obj"), letter.view());
  const io::MeshFile source = io::read_mesh(folder.file("letter.obj"));
  for (const std::string to : {"stl", "3mf", "glb", "gltf"}) {
    CAPTURE(to);
    const std::string of_file = folder.file("of_file." + to), of_arrays = folder.file("of_arrays." + to);
    io::write_mesh(of_file, source, moved);
    io::write_mesh(of_arrays, letter.view(), moved);
    for (const std::string& path : {of_file, of_arrays}) {
      const Polygons back = io::read_mesh(path).polygons;
      REQUIRE(back.face_count() == right.size());
      for (std::size_t t = 0; t < right.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
          CHECK(Vec3d(openvdb::Vec3s(back.positions[back.view().face(t)[k]])) ==
                Vec3d(openvdb::Vec3s(moved[right[t][k]])));
      const auto found = io::find_in_triangles(letter.view(), back.view());
      REQUIRE(found.has_value());
      CHECK(found->triangles == right);
    }
  }
  // Another program's choice is taken as it is.
  Polygons fans;
  fans.positions = moved;
  for (std::size_t f = 0; f < letter.face_count(); ++f) {
    const auto face = letter.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k) fans.add_face({face[0], face[k - 1], face[k]});
  }
  const auto as_fans = io::find_in_triangles(letter.view(), fans.view());
  REQUIRE(as_fans.has_value());
  CHECK(as_fans->positions == moved);
  for (std::size_t t = 0; t < fans.face_count(); ++t)
    CHECK(std::equal(as_fans->triangles[t].begin(), as_fans->triangles[t].end(), fans.view().face(t).begin()));
}

TEST_CASE("convert: in every format, random offsets are to check what they were to the run",
          "[io][check][property][random][no_races]") {
  const Folder folder;
  const test::Seeds seeds = test::random_seeds(20);
  for (unsigned seed = seeds.first; seed < seeds.end; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    io::write_mesh(folder.file("source.obj"), scene.mesh.view());
    const io::MeshFile source = io::read_mesh(folder.file("source.obj"));
    for (const std::string format : {"obj", "off", "ply", "stl", "3mf", "glb", "gltf", "vtp", "vtk"}) {
      CAPTURE(seed, format);
      const std::string path = folder.file("out." + format);
      OffsetOptions options;
      options.distance = scene.distance;
      options.weld = WeldOptions::automatic();
      options.precision = io::target_of(path, source).precision;
      const OffsetResult result = offset(source.polygons.view(), options);
      io::write_mesh(path, source, result.positions);
      const Polygons back = io::read_mesh(path).polygons;
      io::InTriangles found{back.positions, {}};
      if (back.corners != source.polygons.corners) {
        const auto in_triangles = io::find_in_triangles(source.polygons.view(), back.view());
        REQUIRE(in_triangles.has_value());
        found = *in_triangles;
      }
      PolygonView judged = source.polygons.view();
      judged.triangles = found.triangles;
      const CheckResult check =
          check_offset(judged, found.positions,
                       {.distance = options.distance, .weld = options.weld, .precision = options.precision});
      CHECK(check.valid());
      CHECK(check.beyond == 0);
      CHECK(result.statistics.limit.left.total() == 0);
      CHECK(result.statistics.limit.crossings_near_source == check.crossings_near_source);
    }
  }
}

TEST_CASE("convert: all at once, there and back", "[io]") {
  const std::string obj =
      "v 0 0 0 1 0 0 0.2\nv 1 0 0 0 0.2 0 1\nv 0 1 0 0 0 1 1\nvt 0 0\nvt 1 0\nvt 0 0.5\nvn 0 0 1\nvn 0 0.6 0.8\n"
      "vn 1 0 0\nf 1/1/1 2/2/2 3/3/3\n";
  const std::string off =
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 51 0 0\n1 0 0 0 0.6 0.8 0 51 0 255 1 0\n"
      "0 1 0 1 0 0 0 0 255 255 0 0.5\n3 0 1 2\n";
  for (const std::string via : {"ply", "off"}) {
    const Converted there = converted("obj", obj, via);
    CHECK(there.lost.empty());
    CHECK(converted(via, there.bytes, "obj").bytes == obj);
    CHECK(converted(via, there.bytes, via).bytes == there.bytes);
  }
  CHECK(converted("obj", obj, "off").bytes == off);
  CHECK(converted("ply", converted("off", off, "ply").bytes, "off").bytes == off);
}

TEST_CASE("convert: what the format has no place for is named, and nothing else", "[io]") {
  const std::string all = kColoured.substr(0, kColoured.find('f')) + "vt 0 0 0.5\nvn 0 0 1\n";
  CHECK(converted("obj", all + "mtllib a.mtl\no part\ns 1\nf 1/1/1 2/1/1 3/1/1\nl 1 2\n", "ply").lost ==
        "materials, groups and object names, smoothing groups, other lines, third texture coordinates");
  CHECK(converted("obj", all + "f 1/1/1 2/1/1 3/1/1\n", "stl").lost ==
        "third texture coordinates, vertex colours, texture coordinates, normals of vertices, shared vertices, digits "
        "beyond single precision");
  CHECK(converted(
            "ply",
            ply_text("property float quality\n", "0 0 0 1\n1 0 0 1\n0 1 0 1\n", "property uchar flags\n", "3 0 1 2 7"),
            "obj")
            .lost == "vertex property 'quality', face property 'flags'");
  CHECK(converted("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n", "obj").lost == "face colours");
  CHECK(converted("off", "OFF\n3 1 0\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n", "obj").lost ==
        "numbers behind the coordinates");

  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
  CHECK(converted("stl", "solid part\n" + facet, "obj").lost == "the name of the solid");
  CHECK(converted("stl", "solid\n" + facet, "obj").lost.empty());
  std::string binary = std::string(80, '\0') + stored(1u, 0.f, 0.f, 1.f) +
                       stored(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, std::uint16_t{0});
  CHECK(converted("stl", binary, "ply").lost.empty());
  binary[0] = 'h';
  binary.back() = 1;
  CHECK(converted("stl", binary, "off").lost == "the header's text, attribute bytes");
}

TEST_CASE("convert: malformed attributes are dropped and named", "[io]") {
  struct Case {
    const char *from, *to;
    std::string bytes, lost;
  };
  const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                    lost_colours = "vertex property 'red', vertex property 'green', vertex property 'blue'",
                    list = "property list uchar float texcoord\n", points = "0 0 0\n1 0 0\n0 1 0\n";
  const Case cases[] = {
      {"obj", "ply", "v 0 0 0 1 x 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n", "vertex weights or colours"},
      {"obj", "ply", "v 0 0 0 1 2 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n", "vertex weights or colours"},
      {"obj", "ply", "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex weights or colours"},
      {"obj", "ply", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n", "vertex weights or colours"},
      {"obj", "ply", "v 0 0 0 1 0 0 1 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex weights or colours"},
      {"obj", "ply", kTriangle + "vt 0 x\nf 1/1 2/1 3/1\n", "texture coordinates"},
      {"obj", "ply", kTriangle + "vt\nf 1/1 2/1 3/1\n", "texture coordinates"},
      {"obj", "ply", kTriangle + "vt 0 nan\nf 1/1 2/1 3/1\n", "texture coordinates"},
      {"obj", "ply", kTriangle + "vt 0 0\nf 1/1 2/2 3/1\n", "texture coordinates"},
      {"obj", "ply", kTriangle + "vt 0 0\nf 1/0 2/1 3/1\n", "texture coordinates"},
      {"obj", "ply", kTriangle + "vt 0 0\nf 1/-2 2/1 3/1\n", "texture coordinates"},
      {"off", "obj", "COFF\n3 1 0\n0 0 0 256 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n", "vertex colours"},
      {"off", "obj", "COFF\n3 1 0\n0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n", "vertex colours"},
      {"off", "obj", "STOFF\n3 1 0\n0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n", "texture coordinates"},
      {"ply", "obj", ply_text(colours, "0 0 0 1 x 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n"), lost_colours},
      {"ply", "obj", ply_text(colours, "0 0 0 1 300 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n"), lost_colours},
      {"ply", "obj", ply_text("", points, list, "3 0 1 2 5 0 0 0 0 0"), "face property 'texcoord'"},
      {"ply", "obj", ply_text("", points, list, "3 0 1 2 6 0 0 0 0 0 x"), "face property 'texcoord'"},
  };
  for (const Case& c : cases) {
    INFO(c.bytes);
    const Converted result = converted(c.from, c.bytes, c.to);
    CHECK(result.lost == c.lost);
    CHECK_THAT(result.bytes, !Catch::Contains("vt") && !Catch::Contains("red") && !Catch::Contains("texcoord"));
  }
}

TEST_CASE("convert: attributes of many vertices, in many pieces", "[io]") {
  constexpr int kSide = 200;
  std::string obj, textures, faces;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      obj += fmt::format("v {} {} 0 0 0.2 {}\n", i, j, i % 2);
      textures += fmt::format("vt {} {}\n", i, j);
      const int at = i * kSide + j + 1;
      if (i + 1 == kSide || j + 1 == kSide) continue;
      faces += "f";
      for (const int v : {at, at + kSide, at + kSide + 1, at + 1}) faces += fmt::format(" {}/{}", v, v);
      faces += "\n";
    }
  obj += textures + faces;
  for (const std::string via : {"ply", "off"}) {
    const std::string back = converted(via, converted("obj", obj, via).bytes, "obj").bytes;
    // OFF has an alpha; but for that all is as it was.
    CHECK(back.substr(back.find("vt")) == obj.substr(obj.find("vt")));
    CHECK((via == "off" || back == obj));
  }
}
