// SPDX-License-Identifier: Apache-2.0
// Writes small meshes of every kind that the readers know to FOLDER/obj, off, ply, stl, gltf, glb, and numbers of three
// vertices to FOLDER/numbers, curves to FOLDER/curves, 3MF's model parts to FOLDER/threemf, and options to
// FOLDER/toml: what fuzzing starts from.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/bytes.h"
#include "support/dxf_text.h"
#include "support/gltf_model.h"
#include "support/threemf_packages.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
namespace fs = std::filesystem;

namespace {

fs::path folder;

std::string write(const std::string& name, const std::string& bytes) {
  const fs::path path = folder / name.substr(name.rfind('.') + 1) / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
  return path.string();
}

std::string with_cr(std::string text) {
  std::replace(text.begin(), text.end(), '\n', '\r');
  return text;
}

/// Most seeds must be meshes, else they would lead nowhere: checked here.
void seed(const std::string& name, const std::string& bytes) { io::read_mesh(write(name, bytes)); }

/// What a reader may refuse, next to what it must.
void odd_seed(const std::string& name, const std::string& bytes) { write(name, bytes); }

std::string with_crlf(const std::string& text) {
  std::string bytes;
  for (const char c : text) bytes += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return bytes;
}

/// A triangle and a quadrilateral on five vertices, none of which is round.
Polygons two_faces() {
  Polygons mesh;
  mesh.positions = {{0.1, 0, 1.0 / 3}, {1.5, -0.25, 0}, {0, 1e-7, 2}, {-1, 123456.789, 0.5}, {1, 1, 1}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({0, 2, 3, 4});
  return mesh;
}

/// The project's own writers.
void plain_seeds() {
  const Polygons mesh = two_faces();
  for (const char* format : {"obj", "off", "ply", "stl", "gltf", "glb"}) {
    fs::create_directories(folder / format);
    io::write_mesh((folder / format / (std::string("plain.") + format)).string(), mesh.view());
  }
}

/// Cubes: placed, with normals, tangents, colours, strips, bones and morph targets.
void gltf_seeds() {
  using Json = test::GltfModel::Json;
  const test::HardCube cube;
  test::GltfModel model;
  const std::size_t position = model.add_points(cube.points, true), normal = model.add_points(cube.normals);
  std::string tangents, uv;
  for (const Vec3d& n : cube.normals) {
    for (const double number : {n[1], n[2], n[0], 1.0}) tangents += raw(static_cast<float>(number));
    uv += raw(0.25f) + raw(0.75f);
  }
  Json attributes = {{"POSITION", position}, {"NORMAL", normal}};
  attributes["TANGENT"] = model.add(tangents, 5126, 24, "VEC4");
  attributes["TEXCOORD_0"] = model.add(uv, 5126, 24, "VEC2");
  attributes["COLOR_0"] = model.add(std::string(96, 'c'), 5121, 24, "VEC4");
  model.json["accessors"].back()["normalized"] = true;
  const std::size_t indices = model.add_indices(cube.indices);
  model.json["materials"] = {{{"name", "red"}}, {{"name", "blue"}}};
  model.add_mesh({{"attributes", attributes}, {"indices", indices}, {"material", 0}},
                 {{"name", "a"}, {"scale", {1, 2, 1}}});
  const auto seed_both = [&](const std::string& name) {
    seed(name + ".glb", model.glb());
    seed(name + ".gltf", model.gltf());
  };
  seed_both("cube");
  model.json["nodes"][0]["children"] = {1};
  model.add_mesh({{"attributes", {{"POSITION", model.add_points(cube.points)}}}, {"mode", 5}},
                 {{"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
  model.json["scenes"] = {{{"nodes", {0}}}};
  seed_both("placed");
  model.json["meshes"][1]["primitives"][0]["targets"] = {{{"POSITION", model.add_points(cube.points)}}};
  model.json["nodes"][1]["skin"] = 0;
  model.json["skins"] = {{{"joints", {0}}}};
  seed_both("skinned");
}

void obj_seeds() {
  const std::string rich =
      "# a comment\nmtllib x.mtl\nv 0 0 0 0.5 0.5 0.5\nv  1.50 0 \t0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n"
      "o part\ng group\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/1/1 # face\nf -3//1 -1//1 -2//1\nl 1 2\nunknown 1 2 3";
  seed("rich.obj", rich);
  seed("crlf.obj", with_crlf(rich));
  seed("cr.obj", with_cr(rich));
  seed("unnamed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//-2 3//1\nf 1/1/7 2/2 3/-3\n");
  seed("numbers.obj", "v +0 -0 .5\nv 1e-3 2E+2 3.\nv 1e-400 1e300 0.1000000000000000055\nf 1 +2 3\n");
  const std::string continued =
      "v 0 \\\n0 0\nv 1 0 0\\\nv 0 1 0\nv 1\\\n 0 0\nv 0 1 0\nf 1\\\n 2 \\\n 3\n# end \\\nf 1 2 3\n";
  seed("continued.obj", continued);
  seed("continued_crlf.obj", with_crlf(continued));
  seed("mark_forward.obj",
       "\xef\xbb\xbf"
       "f 1 2 3\nf 1/7 3/8 2/9\nv 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n");
  seed("negative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf -3/-1/-2 -2/-1/-1 -1/-1/-2\nf -1 -2 -3\n");
  seed("normals.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan inf x\nvn 0 1 0\nf 1//1 2//1 3//2\nf 3//2 2 1//2\n");
}

void off_seeds() {
  const std::string rows = "0 0 0%\n1 0 0%\n0 1 0%\n1 1 0.5%\n", faces = "3 0 1 2\n4 0 1 3 2 255 0 0\n";
  const auto with = [&](const std::string& keyword, const std::string& rest) {
    std::string text = keyword + "\n4 2 0\n";
    for (const char c : rows) text += c == '%' ? rest : std::string(1, c);
    return text + faces;
  };
  seed("coff.off", with("COFF", " 255 0 0 128"));
  seed("noff.off", with("NOFF", " 0 0 1"));
  seed("cnoff.off", with("CNOFF", " 0 nan 1 0.5 0.5 0.5 1"));
  seed("stoff.off", with("STOFF", " 0.25 0.75"));
  seed("stcnoff.off", with("STCNOFF", " 0 0 1 1 1 1 1 0.25 0.75"));
  seed("crlf.off", with_crlf(with("OFF", "")));
  seed("cr.off", with_cr(with("COFF", " 255 0 0 128")));
  seed("comments.off",
       "# first\nOFF # keyword\n\n# counts\n3 1 # two of three\n0 0 0#near\n#\n1 0 0\n0 1 0\n\n3 0 1 2");
  seed("one_line.off", "\xef\xbb\xbfOFF 3 1 0\n0 0 0\n1e-3 +0 -0\n0 1 .5\n3 0 1 2");
}

/// A triangle with a colour and a quadrilateral without, of Geomview's kind.
void binary_off_seeds() {
  for (const auto& [keyword, numbers] : {std::pair{"OFF", 3}, {"COFF", 7}, {"STCNOFF", 12}}) {
    std::string bytes = keyword + std::string(" BINARY\n");
    for (const std::int32_t count : {4, 2, 5}) bytes += raw(count, true);
    for (int i = 0; i < 4 * numbers; ++i) bytes += raw(0.125f * static_cast<float>(i * 7 % 8), true);
    for (const std::int32_t number : {3, 0, 1, 2, 3}) bytes += raw(number, true);
    for (const float colour : {1.f, 0.5f, 0.f}) bytes += raw(colour, true);
    for (const std::int32_t number : {4, 0, 1, 3, 2, 0}) bytes += raw(number, true);
    seed(std::string("binary_") + keyword + ".off", bytes);
  }
}

std::string ply_header(const std::string& encoding, const std::string& elements) {
  return "ply\nformat " + encoding + " 1.0\ncomment made by hand\n" + elements + "end_header\n";
}

void ply_text_seeds() {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string corners = "property list uchar int vertex_indices\n";
  const std::string normals =
      ply_header("ascii", "obj_info by nobody\nelement vertex 3\n" + xyz + "property float nx\nproperty float ny\n" +
                              "property float nz\nelement face 2\n" + corners) +
      "0 0 0 nan 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n3 2 1 0\n";
  seed("text_normals.ply", normals);
  seed("text_crlf.ply", with_crlf(normals));
  seed("text_lists.ply",
       ply_header("ascii",
                  "element camera 1\nproperty list char short view\nelement face 1\nproperty double quality\n" +
                      std::string("property list uint ushort vertex_index\nproperty list uchar float texcoord\n") +
                      "element vertex 3\nproperty list uchar uchar ring\n" + xyz + "property uchar red\n") +
           "2 7 8\n0.5 3 0 1 2 6 0 0 1 0 0 1\n0 0 0 0 255\n1 5 1 0 0 255\n2 5 6 0 1 0 255\n");
  seed("text_one_line.ply",
       ply_header("ascii", "element vertex 3\n" + xyz + "element face 1\n" + corners) + "0 0 0 1 0 0 0 1 0 3 0 1 2");
  const std::string strips = "element vertex 4\n" + xyz + "element tristrips 2\nproperty list int int vertex_indices\n";
  seed("text_strips.ply",
       ply_header("ascii", strips) + "0 0 0 1 0 0 0 1 0 0 0 1\n9 0 1 2 3 0 1 -1 2 2\n5 3 3 0 1 -1\n");
  seed("text_cr.ply", with_cr(normals));
  std::string binary = with_cr(ply_header("binary_little_endian", strips));
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) binary += raw(x);
  for (const std::int32_t i : {5, 0, 1, 2, 3, -1, 3, 0, 1, 3}) binary += raw(i);
  seed("binary_cr_strips.ply", binary);
  const std::string three = "element vertex 3\n" + xyz + "property float nx\nproperty float ny\nproperty float nz\n";
  const std::string one = "element face 1\n" + corners;
  odd_seed("text_twice.ply", ply_header("ascii", three + three + one + one + "element edge 1000\n") +
                                 "0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 0 0 1 0 0 1 1 0 1 0 0 1 0 1 1 0 0 1\n"
                                 "3 0 1 2\n3 3 4 5\n");
}

/// Every number of the file is binary: a vertex with a colour and a normal, lists in front and behind.
std::string binary_ply(bool big) {
  std::string bytes = ply_header(
      std::string("binary_") + (big ? "big" : "little") + "_endian",
      "element vertex 3\nproperty list uchar short ring\nproperty float64 x\nproperty uint8 red\nproperty float64 y\n"
      "property float64 z\nproperty float32 nx\nproperty float32 ny\nproperty float32 nz\nelement face 1\n"
      "property list uint16 uint32 vertex_indices\nproperty float quality\nelement edge 1\nproperty int8 a\n");
  for (int v = 0; v < 3; ++v) {
    bytes += raw(static_cast<std::uint8_t>(v));
    for (int k = 0; k < v; ++k) bytes += raw(std::int16_t{-2}, big);
    bytes += raw(v == 1 ? 1.1 : 0.0, big) + raw(std::uint8_t{200}) + raw(v == 2 ? 1.1 : 0.0, big) + raw(0.25, big);
    for (const float n : {0.f, 0.f, 1.f}) bytes += raw(n, big);
  }
  bytes += raw(std::uint16_t{3}, big);
  for (const std::uint32_t v : {0u, 1u, 2u}) bytes += raw(v, big);
  return bytes + raw(0.25f, big) + raw(std::int8_t{-1}) + "rest";
}

/// The plainest of binary files: three floats a vertex, nothing but triangles.
std::string triangles_ply(bool big) {
  std::string bytes =
      ply_header(std::string("binary_") + (big ? "big" : "little") + "_endian",
                 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
                 "property list uchar int vertex_indices\n");
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) bytes += raw(x, big);
  for (const std::int32_t first : {0, 1}) {
    bytes += raw(std::uint8_t{3});
    for (const std::int32_t k : {0, 1, 2}) bytes += raw((first + k) % 3, big);
  }
  return bytes;
}

std::string binary_stl(std::string header, std::uint32_t facets, std::uint16_t attribute) {
  header.resize(80, ' ');
  std::string bytes = header + raw(facets);
  for (std::uint32_t f = 0; f < facets; ++f) {
    for (const float x : {9.f, 9.f, 9.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.1f}) bytes += raw(x);
    bytes += raw(attribute);
  }
  return bytes;
}

void stl_seeds() {
  const std::string facet =
      "  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex 0 1.0e-1 0\n"
      "    endloop\n  endfacet\n";
  const std::string text = "solid my part\n" + facet + facet + "endsolid my part\n";
  std::string upper = text;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  seed("text.stl", text);
  seed("crlf.stl", with_crlf(text));
  seed("cr.stl", with_cr(text));
  seed("upper.stl", upper);
  seed("two_solids.stl", text + "\n" + text);
  seed("remarks.stl",
       "solid\nfacet normal inf -inf word\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop foo\n"
       "endfacet blah\nendsolid");
  seed("attributes.stl", binary_stl("made by hand", 2, 0xabcd));
  seed("solid_in_binary.stl", binary_stl("solid COLOR=abcd", 1, 0));
  seed("longer.stl", binary_stl("", 1, 1) + "bytes behind the last facet");
}

/// A number for each of three vertices.
void numbers_seed(const std::string& name, const std::string& bytes) {
  io::read_vertex_numbers(write(name + ".numbers", bytes), 3);
}

std::string npy(char version, const std::string& type, const std::string& shape, const std::string& numbers) {
  const std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }   \n";
  const std::string bytes = std::string("\x93NUMPY", 6) + version + '\0';
  const auto length = static_cast<std::uint32_t>(header.size());
  return bytes + (version == 1 ? raw(static_cast<std::uint16_t>(length)) : raw(length)) + header + numbers;
}

void numbers_seeds() {
  numbers_seed("lines", "# a comment\n0.5\n-1e-3 # near\n+2\n");
  numbers_seed("crlf",
               "\xef\xbb\xbf"
               "1\r\n2 .5\r\n");
  numbers_seed("f8", npy(1, "<f8", "(3,)", raw(0.1) + raw(-2.0) + raw(1e300)));
  numbers_seed("f4_big", npy(2, ">f4", "(3, 1)", raw(0.1f, true) + raw(-2.f, true) + raw(3.f, true)));
  numbers_seed("i1", npy(3, "|i1", "(3L,)", "\x01\xff\x7f"));
  numbers_seed("u8", npy(1, ">u8", "(3,1)", std::string(24, '\xab')));
}

/// The first byte stands for the format.
void curves_seeds() {
  write("title.curves", "Bairfoil\n1 0\n0.5 0.1\n0 0\n\n# closed\n3 4\n5 6\n7 1e3\n");
  write("lednicer.curves", "BNACA 1\n 3. 3.\n\n0 0\n.5 .1\n1 0\n\n0 0\n.5 -.1\n1 0\n");
  write("lines.curves", "@v 0 0 0\nv 1 0 0 1\nv 1 1e-3 -0\no a\nl 1 2/1 3\nl -1 -2\n");
  write("drawing.curves",
        "A<svg xmlns='x'><g transform='translate(1)'><path d='m0,0 1-1.5.5h3V2z l1 1'/></g>"
        "<polygon points='0 0 1,0 1 1'/><polyline points='2 2 3 3'/><defs><path d='M0'/></defs></svg>");
  write(
      "curved.curves",
      "A<svg><defs><g id='g'><circle id='c' cx='1' r='2'/><use href='#c' x='3'/></g><symbol id='s' viewBox='0 0 2 1'>"
      "<rect width='2' height='1' rx='.2'/></symbol></defs><use href='#g' id='u'/><use href='#s' width='4' height='4'/>"
      "<ellipse rx='2' ry='1' transform='skewX(9)'/><line x2='5'/>"
      "<path d='m1,2c1,1,2,1,3,0s2-1 3 0q1 1 2 0t2 0a1 2 30 01-1 1z'/></svg>");
  write("entities.curves",
        "C" + dxf_text::file("0|LINE 5|A 8|cut 10|0 20|0 11|4 21|1 0|LWPOLYLINE 8|a 90|3 70|1 38|1 10|0 20|0 42|.5 "
                             "10|4 20|0 10|4 20|3 0|POLYLINE "
                             "8|a 66|1 70|0 0|VERTEX 10|0 20|0 42|1 0|VERTEX 10|2 20|1 0|SEQEND 0|ARC 10|1 20|1 40|2 "
                             "50|30 51|200 230|-1 0|CIRCLE "
                             "10|0 20|0 40|1 0|ELLIPSE 10|0 20|0 11|2 21|1 40|.5 41|0 42|3 0|TEXT 1|a",
                             "9|$ACADVER 1|AC1015 9|$HANDSEED 5|F"));
  write("blocks.curves",
        "C" + dxf_text::file("0|INSERT 8|cut 2|b 10|1 20|2 41|2 42|3 50|30 70|2 71|2 44|5 45|6 0|INSERT 2|c 62|5 "
                             "0|SPLINE 71|2 40|0 40|0 40|0 40|1 "
                             "40|2 40|2 40|2 10|0 20|0 41|1 10|1 20|2 41|2 10|3 20|0 41|1 10|5 20|5 41|1 1001|X 1040|1",
                             "9|$INSUNITS 70|4",
                             "0|BLOCK 2|b 10|1 20|1 0|LINE 8|0 62|0 11|1 0|ENDBLK 0|BLOCK 2|c 0|INSERT 2|b 10|7 "
                             "0|CIRCLE 40|1 0|ENDBLK",
                             "0|TABLE 2|LAYER 0|LAYER 2|cut 70|0 62|-7 0|ENDTAB"));
  write("plain.curves", "A<svg><path d=\"M0 0L1 0L1 1Z m2 2 3 3\"/><text>a</text></svg>");
}

/// The first byte says how the others are made into a package; see threemf_fuzz.cpp.
void threemf_seeds() {
  const std::string tetrahedron = "<object id=\"1\" name=\"a\">" + kTetrahedronXml + "</object>";
  const auto model_seed = [](const std::string& name, char how, const std::string& model) {
    io::parse_mesh(name, io::Format::ThreeMf, package_of(model));
    write(name + ".threemf", how + model);
  };
  model_seed("plain", 0, model_of(tetrahedron, "<item objectid=\"1\"/>", "unit=\"inch\""));
  model_seed("placed", 1,
             model_of(tetrahedron + "<object id=\"2\"><components><component objectid=\"1\" "
                                    "transform=\"0 2 0 -2 0 0 0 0 -2 1 2 3\"/></components></object>",
                      "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 10 .5 0\"/><item objectid=\"1\"/>"));
  model_seed("coloured", 2,
             model_of("<m:colorgroup id=\"5\"><m:color color=\"#102030\"/></m:colorgroup><basematerials id=\"6\"><base "
                      "name=\"b\" displaycolor=\"#00f\"/></basematerials><object id=\"1\" pid=\"5\" pindex=\"0\">" +
                          kTetrahedronXml + "</object><object id=\"2\" pid=\"6\" pindex=\"0\">" + kTetrahedronXml +
                          "</object>",
                      "<item objectid=\"1\"/><item objectid=\"2\"/>",
                      "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\""));
  write("parts.threemf",
        '\5' + model_of(tetrahedron + "<object id=\"2\"><components><component p:path=\"/3D/o.model\" objectid=\"1\"/>"
                                      "</components></object>",
                        "<item objectid=\"2\"/><item objectid=\"1\" p:path=\"/3D/o.model\"/>",
                        "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\""));
  const std::string archive = package_of(model_of(tetrahedron, "<item objectid=\"1\"/>"));
  io::parse_mesh("archive", io::Format::ThreeMf, archive);
  write("archive.threemf", '\10' + archive);
}

void toml_seeds() {
  odd_seed("options.toml",
           "distance = \"1%\"\nshell = true # closed\nthreads = 2\n'jobs' = 0x2\nonly = [\"a\", 'b', \"\"]\n");
  odd_seed("table.toml",
           "[batch]\nreports = false\ntext = \"\"\"a\nb\\u00e9\"\"\"\n[[part]]\nat = {x.y = 1e-3, z = [1, [2.5]]}\n");
  odd_seed("dates.toml", "a.b.c = 1979-05-27T07:32:00.5-07:00\nd = 07:32:00\ne = +inf\nf = -nan\ng = 0b11_01\n");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: fuzz_corpus FOLDER\n");
    return 1;
  }
  folder = arguments[1];
  try {
    plain_seeds();
    obj_seeds();
    gltf_seeds();
    off_seeds();
    binary_off_seeds();
    ply_text_seeds();
    for (const bool big : {false, true}) {
      const std::string name = big ? "big.ply" : "little.ply";
      seed("rows_" + name, binary_ply(big));
      seed("triangles_" + name, triangles_ply(big));
    }
    stl_seeds();
    numbers_seeds();
    curves_seeds();
    threemf_seeds();
    toml_seeds();
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 4;
  }
}
