// SPDX-License-Identifier: Apache-2.0
// Files are built here as other programs write them. These were looked at; all but trimesh's were run through the
// command:
// - Khronos' samples (glTF-Sample-Models: BoxVertexColors, SimpleSkin, SimpleMorph, SimpleMeshes,
// SimpleSparseAccessor):
//   text with blanks around colons, data in base64, one view with a stride for all attributes, a mesh placed twice.
// - Blender 3.4's exporter: compact text, a view for each accessor, bounds of positions alone, in 17 digits; bones,
// morph
//   targets, tangents; a mirrored object has a negative scale.
// - three.js r111's exporter: views with strides, normals and bounds of all accessors, nodes with a matrix.
// - trimesh's test models: mode5.gltf has dozens of strips over one accessor of positions, with bounds of indices that
//   are one too large; in TestScene.gltf, written from Unity, two meshes in two places share all accessors.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <numbers>

#include "ground/numbers/rounding.h"
#include "support/folder.h"
#include "support/gltf_model.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using test::GltfModel;
using test::HardCube;

// Names of its own, as tests are compiled several files at once.
namespace gltf_files {
namespace {

using Json = GltfModel::Json;

io::MeshFile glb_file(const std::string& bytes) { return io::parse_mesh("a.glb", io::Format::Glb, bytes); }
io::MeshFile gltf_file(const std::string& bytes) { return io::parse_mesh("a.gltf", io::Format::Gltf, bytes); }

std::vector<Vec3d> grown(const io::MeshFile& file, double distance) {
  OffsetOptions options;
  options.precision = file.precision;
  options.distance = distance;
  return offset(file.polygons.view(), options).positions;
}

/// The bytes in which two texts of one length differ, as runs [first, last].
std::vector<std::pair<std::size_t, std::size_t>> differences(const std::string& a, const std::string& b) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    if (runs.empty() || runs.back().second + 1 < i) runs.emplace_back(i, i);
    else runs.back().second = i;
  }
  return runs;
}

std::string json_of(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, sizeof size);
  return glb.substr(20, size);
}

std::string binary_of(const std::string& glb) { return glb.substr(20 + json_of(glb).size() + 8); }

/// What is read again is what was judged, and has moved as it should.
void check_there_and_back(const io::MeshFile& file, const std::vector<Vec3d>& positions) {
  CHECK(io::patched_bytes(file, file.polygons.positions) == file.text());
  const std::string bytes = io::patched_bytes(file, positions);
  const io::MeshFile back = io::parse_mesh(file.path, file.format, bytes);
  CHECK(back.polygons.corners == file.polygons.corners);
  CHECK(back.extras == file.extras);
  const Rounding rounding(file.precision);
  std::size_t others = 0;
  for (std::size_t v = 0; v < positions.size(); ++v)
    others += !(back.polygons.positions[v] == rounding(file.polygons.positions[v], positions[v]));
  CHECK(others == 0);
  CHECK(io::patched_bytes(back, back.polygons.positions) == bytes);
}

/// A cube as Blender's exporter (Khronos glTF Blender I/O) writes it: one view for each accessor, bounds for positions
/// alone, compact JSON, names of objects on nodes and of meshes on meshes, an unused second texture coordinate.
GltfModel as_of_blender() {
  const HardCube cube;
  GltfModel model;
  model.json["asset"]["generator"] = "Khronos glTF Blender I/O v4.0.44";
  model.json["scene"] = 0;
  model.json["scenes"] = {{{"name", "Scene"}, {"nodes", {0}}}};
  model.json["materials"] = {{{"doubleSided", true}, {"name", "Material"}}};
  const std::size_t position = model.add_points(cube.points, true), normal = model.add_points(cube.normals);
  std::string uv;
  for (std::size_t v = 0; v < 24; ++v) uv += raw(static_cast<float>(v) / 32) + raw(0.25f);
  const std::size_t texture = model.add(uv, 5126, 24, "VEC2"), indices = model.add_indices(cube.indices);
  model.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", texture}}},
                  {"indices", indices},
                  {"material", 0}},
                 {{"name", "Cube"}});
  model.json["meshes"][0]["name"] = "Cube.001";
  model.json["extras"] = {{"kept", "as it is: {[\"\\"}};
  return model;
}

/// A cube of 8 vertices: all but its corners are smooth.
GltfModel plain_cube(const Json& node = Json::object()) {
  GltfModel model;
  std::vector<Vec3d> points;
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
  const std::size_t position = model.add_points(points, true);
  const std::size_t indices = model.add_indices(
      {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
  model.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", indices}}, node);
  return model;
}

void check_refused(const GltfModel& model, const std::string& message) {
  CHECK_THROWS_WITH(glb_file(model.glb()), Catch::Contains(message));
}

}  // namespace
}  // namespace gltf_files

using namespace gltf_files;

TEST_CASE("gltf: a file of Blender keeps every byte but those of positions, normals and bounds", "[gltf]") {
  const GltfModel model = as_of_blender();
  const std::string glb = model.glb();
  const io::MeshFile file = glb_file(glb);
  CHECK(file.polygons.positions.size() == 24);
  CHECK(file.polygons.face_count() == 12);
  CHECK(file.normal_count == 24);
  CHECK(file.unit_micrometres == 1e6);
  CHECK(io::wall_names(file).names == std::vector<std::string>{"Cube"});
  CHECK(io::read_materials(file).names == std::vector<std::string>{"Material"});

  std::vector<Vec3d> positions = grown(file, 0.5);
  check_there_and_back(file, positions);
  const std::string moved = io::patched_bytes(file, positions);
  // Positions are the first 288 bytes of the buffer, normals, which stay as no face turns, the next.
  const std::string before = binary_of(glb), after = binary_of(moved);
  CHECK(differences(before, after).back().second < 288);
  const auto was = nlohmann::json::parse(json_of(glb)), is = nlohmann::json::parse(json_of(moved));
  for (int k = 0; k < 3; ++k) CHECK(is["accessors"][0]["max"][k].get<double>() == 1.5);
  auto same = is;
  same["accessors"][0] = was["accessors"][0];
  CHECK(same == was);
  CHECK(moved.size() % 4 == 0);
  std::uint32_t length = 0;
  std::memcpy(&length, moved.data() + 8, sizeof length);
  CHECK(length == moved.size());
}

TEST_CASE("gltf: base64 in the text, and data that are interleaved", "[gltf]") {
  // As Khronos' sample models have them, made by JglTF or COLLADA2GLTF: one view for all attributes, with a stride.
  const HardCube cube;
  GltfModel model;
  std::string bytes;
  for (std::size_t v = 0; v < cube.points.size(); ++v)
    for (const Vec3d& each : {cube.points[v], cube.normals[v]})
      for (int k = 0; k < 3; ++k) bytes += raw(static_cast<float>(each[k]));
  model.add(bytes, 5126, 24, "VEC3");
  model.json["bufferViews"][0]["byteStride"] = 24;
  model.json["accessors"].push_back(model.json["accessors"][0]);
  model.json["accessors"][1]["byteOffset"] = 12;
  const std::size_t indices = model.add_indices(cube.indices);
  model.add_mesh({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", indices}});
  const io::MeshFile file = gltf_file(model.gltf());
  CHECK(io::read_attributes(file).normals.value == cube.normals);
  check_there_and_back(file, grown(file, 0.25));
  std::vector<Vec3d> one = file.polygons.positions;
  one[0] = Vec3d(-1.5, -1, -1);
  const std::string moved = io::patched_bytes(file, one);
  // 24 bytes, 12 of a position and 12 of a normal, are 32 digits; the normals of the other three corners of the side
  // and of its vertices change as well, but nothing of the indices, which follow.
  for (const auto& [first, last] : differences(std::string(file.text()), moved)) {
    const std::size_t data = file.text().find("base64,") + 7;
    CHECK(first >= data);
    CHECK(last < data + 24 * 24 / 3 * 4);
  }
}

TEST_CASE("gltf: meshes are where nodes place them", "[gltf]") {
  const double share = std::sqrt(0.5);
  const Json turned = {{"rotation", {0, 0, share, share}}, {"scale", {2, 3, 4}}, {"translation", {10, 0, 0.1}}};
  const io::MeshFile file = glb_file(plain_cube(turned).glb());
  // A quarter turn around z after the scale: x becomes y.
  CHECK((file.polygons.positions[1] - Vec3d(13, 2, -3.9)).length() < 1e-14);
  check_there_and_back(file, grown(file, 0.125));
  check_there_and_back(file, grown(file, -0.125));

  GltfModel mirrored = plain_cube({{"scale", {-1, 1, 1}}});
  const io::MeshFile mirror = glb_file(mirrored.glb());
  const std::vector<Vec3d> larger = grown(mirror, 0.5);
  CHECK(larger[0][0] > 1.2);  // the corner that the file has at -1
  check_there_and_back(mirror, larger);

  GltfModel below = plain_cube({{"translation", {1, 0, 0}}});
  below.json["nodes"].push_back({{"children", {0}}, {"scale", {2, 2, 2}}});
  CHECK(glb_file(below.glb()).polygons.positions[7] == Vec3d(4, 2, 2));
}

TEST_CASE("gltf: two meshes that touch stay together in frames of their own", "[gltf]") {
  GltfModel model = plain_cube({{"translation", {1024, 0, 0}}});
  const std::size_t position = model.add_points(
      {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
  model.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", 1}}, {{"translation", {1026, 0, 0}}});
  const io::MeshFile file = glb_file(model.glb());
  REQUIRE(file.polygons.positions[1] == file.polygons.positions[8]);
  std::vector<Vec3d> positions = file.polygons.positions;
  for (Vec3d& p : positions) p += Vec3d(0.0123, 0.01 * p[0], 1.0 / 3);
  check_there_and_back(file, positions);
  const io::MeshFile back = glb_file(io::patched_bytes(file, positions));
  CHECK(back.polygons.positions[1] == back.polygons.positions[8]);
}

TEST_CASE("gltf: what is left as it is, is told", "[gltf]") {
  GltfModel model = as_of_blender();
  model.json["scenes"][0]["nodes"] = {0, 1, 2};
  model.add_node({{"translation", {5, 0, 0}}}, 0);
  const std::size_t bones = model.add(std::string(24 * 4, '\0'), 5121, 24, "VEC4");
  const std::size_t target = model.add_points(std::vector<Vec3d>(24, Vec3d(0, 1, 0)));
  const std::size_t position = model.add_points(HardCube().points);
  const Json attributes = {{"POSITION", position}, {"JOINTS_0", bones}, {"WEIGHTS_0", bones}};
  model.add_mesh({{"attributes", attributes}, {"indices", 3}, {"targets", {{{"POSITION", target}}}}},
                 {{"translation", {0, 9, 0}}, {"skin", 0}});
  model.json["skins"] = {{{"joints", {0}}}};
  model.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", position}}}, {"mode", 0}}}}});
  model.json["meshes"][1]["primitives"].push_back({{"attributes", {{"POSITION", position}}}, {"mode", 1}});
  const io::MeshFile file = glb_file(model.glb());
  CHECK(file.polygons.positions.size() == 48);
  CHECK(file.polygons.positions[24] == Vec3d(-1, 1, -1));  // bones place it, not its node
  const std::string remarks = fmt::format("{}", fmt::join(file.remarks, "; "));
  CHECK_THAT(remarks, Catch::Contains("1 mesh that the scene does not show"));
  CHECK_THAT(remarks, Catch::Contains("1 mesh that several nodes place"));
  CHECK_THAT(remarks, Catch::Contains("1 mesh with bones"));
  CHECK_THAT(remarks, Catch::Contains("1 part of points or lines"));
  CHECK_THAT(remarks, Catch::Contains("morph targets stay"));
  check_there_and_back(file, grown(file, 0.25));
}

TEST_CASE("gltf: strips and fans are triangles", "[gltf]") {
  GltfModel model;
  const std::size_t position = model.add_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}});
  const std::size_t strip = model.add_indices({0, 1, 2, 3, 3, 4}), fan = model.add_indices({0, 1, 3, 4});
  const auto primitive = [&](std::size_t indices, int mode) {
    return Json{{"attributes", {{"POSITION", position}}}, {"indices", indices}, {"mode", mode}};
  };
  model.add_mesh(primitive(strip, 5));
  model.json["meshes"][0]["primitives"].push_back(primitive(fan, 6));
  const io::MeshFile file = glb_file(model.glb());
  CHECK(file.polygons.positions.size() == 5);
  CHECK(file.polygons.corners == std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 1, 3, 0, 3, 4, 0});
}

TEST_CASE("gltf: meshes may share their vertices", "[gltf]") {
  GltfModel model = plain_cube();
  Json strip = {{"attributes", {{"POSITION", 0}}}, {"indices", model.add_indices({0, 1, 2, 3})}, {"mode", 5}};
  model.json["accessors"].back()["max"] = {4.0};  // one too large
  model.add_mesh(strip);
  model.add_mesh(strip, {{"translation", {5, 0, 0}}});
  const io::MeshFile file = glb_file(model.glb());
  CHECK(file.polygons.positions.size() == 8);
  CHECK(file.polygons.face_count() == 14);
  CHECK(file.remarks.size() == 1);
  CHECK_THAT(file.remarks.front(), Catch::StartsWith("1 part with the vertices of another that is placed elsewhere"));
  check_there_and_back(file, grown(glb_file(plain_cube().glb()), 0.5));
}

TEST_CASE("gltf: vertices that a seam of the texture splits share their new normal", "[gltf]") {
  // Two triangles that are bent along an edge of which each has vertices of its own, with one smooth normal.
  GltfModel model;
  const double h = std::sqrt(0.5);
  const std::size_t position = model.add_points({{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}});
  const std::size_t normal = model.add_points({{0, 0, 1}, {0, 0, 1}, {-h, 0, h}, {0, 0, 1}, {0, 0, 1}, {h, 0, h}});
  model.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                  {"indices", model.add_indices({0, 1, 2, 3, 5, 4})}});
  const io::MeshFile file = glb_file(model.glb());
  std::vector<Vec3d> positions = file.polygons.positions;
  positions[2][2] = -1;
  const io::MeshFile bent = glb_file(io::patched_bytes(file, positions));
  const std::vector<Vec3d> normals = io::read_attributes(bent).normals.value;
  CHECK(normals[0] == normals[3]);
  CHECK(normals[1] == normals[4]);
  CHECK(normals[0][0] < -0.1);
  CHECK(std::abs(normals[0].length() - 1) < 1e-6);
}

TEST_CASE("gltf: tangents stay at right angles to normals", "[gltf]") {
  GltfModel model = as_of_blender();
  std::string tangents;
  for (const Vec3d& n : HardCube().normals)
    for (const double number : {n[1], n[2], n[0], 1.0}) tangents += raw(static_cast<float>(number));
  model.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = model.add(tangents, 5126, 24, "VEC4");
  const io::MeshFile file = glb_file(model.glb());
  std::vector<Vec3d> positions = file.polygons.positions;
  for (Vec3d& p : positions) p += Vec3d(0.5 * p[1], 0.25 * p[2], 0);
  const std::string moved = io::patched_bytes(file, positions), binary = binary_of(moved);
  const std::vector<Vec3d> normals = io::read_attributes(glb_file(moved)).normals.value;
  for (std::size_t v = 0; v < 24; ++v) {
    float tangent[4];
    std::memcpy(tangent, binary.data() + model.json["bufferViews"].back()["byteOffset"].get<std::size_t>() + 16 * v,
                sizeof tangent);
    const Vec3d t(tangent[0], tangent[1], tangent[2]);
    CHECK(std::abs(t.dot(normals[v])) < 1e-6);
    CHECK(tangent[3] == 1);
  }
}

TEST_CASE("gltf: what cannot be rewritten is refused by name", "[gltf]") {
  const auto with = [](const std::function<void(GltfModel&)>& change) {
    GltfModel model = as_of_blender();
    change(model);
    return model;
  };
  const auto attributes = [](GltfModel& m) -> Json& { return m.json["meshes"][0]["primitives"][0]["attributes"]; };
  check_refused(with([](GltfModel& m) { m.json["extensionsRequired"] = {"KHR_mesh_quantization"}; }),
                "a.glb: extensionsRequired[0]: expected geometry as plain floats, got KHR_mesh_quantization");
  check_refused(
      with([](GltfModel& m) {
        m.json["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", 0}}}};
      }),
      "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: expected geometry as plain floats");
  check_refused(with([](GltfModel& m) {
                  m.json["bufferViews"][0]["extensions"] = {{"EXT_meshopt_compression", Json::object()}};
                }),
                "bufferViews[0].extensions.EXT_meshopt_compression: expected plain data");
  check_refused(with([](GltfModel& m) {
                  m.json["accessors"][0]["sparse"] = {{"count", 1}};
                }),
                "accessors[0].sparse: expected an accessor that is not sparse");
  check_refused(with([](GltfModel& m) { m.json["accessors"][0]["componentType"] = 5122; }),
                "accessors[0]: expected a POSITION of floats, VEC3");
  check_refused(with([&](GltfModel& m) { attributes(m)["_REST"] = 0; }),
                "attributes._REST: expected an accessor of its own, as one of POSITION is to be rewritten");
  check_refused(with([&](GltfModel& m) { attributes(m)["NORMAL"] = 0; }), "expected elements with bytes of their own");
  check_refused(with([&](GltfModel& m) {
                  m.json["accessors"].push_back(m.json["accessors"][0]);
                  attributes(m)["_REST"] = 4;
                }),
                "accessors[0]: expected elements with bytes of their own, as they are to be rewritten, got bytes that "
                "accessors[4] has, too");
  check_refused(with([](GltfModel& m) { m.json["images"] = {{{"bufferView", 1}}}; }), "or an image has, too");
  check_refused(with([](GltfModel& m) {
                  m.json["nodes"][0]["scale"] = {1, 0, 1};
                }),
                "nodes[0]: expected a transform that can be undone");
}

TEST_CASE("gltf: a broken or hostile file is refused with what was expected where", "[gltf]") {
  const auto with = [](const std::function<void(Json&)>& change) {
    GltfModel model = as_of_blender();
    change(model.json);
    return model;
  };
  check_refused(
      with([](Json& j) { j["accessors"][0]["count"] = 25; }),
      "accessors[0].count: expected elements that fit into 288 bytes of bufferViews[0], got 25, which take 300");
  check_refused(with([](Json& j) { j["accessors"][0]["count"] = 4294967295u; }),
                "accessors[0].count: expected a whole number");
  check_refused(with([](Json& j) { j["accessors"][1]["count"] = 23; }),
                "attributes.NORMAL: expected an accessor of 24 elements");
  check_refused(with([](Json& j) { j["accessors"][0]["byteOffset"] = 9e15; }),
                "accessors[0].count: expected elements that fit");
  check_refused(with([](Json& j) { j["accessors"][0]["bufferView"] = 99; }),
                "accessors[0].bufferView: expected a whole number from 0 to 3, got 99");
  check_refused(with([](Json& j) { j["accessors"][0].erase("bufferView"); }),
                "accessors[0]: expected \"bufferView\", got none");
  check_refused(with([](Json& j) { j["bufferViews"][0]["byteLength"] = 1u << 30; }),
                "bufferViews[0]: expected a view that ends at byte");
  check_refused(with([](Json& j) { j["bufferViews"][0]["byteStride"] = 8; }), "byteStride: expected at least 12");
  check_refused(with([](Json& j) { j["nodes"][0]["children"] = {0}; }),
                "nodes[0].children[0]: expected nodes that form trees");
  check_refused(with([](Json& j) {
                  j["scenes"][0]["nodes"] = {0, 0};
                }),
                "scenes[0].nodes[1]: expected nodes that form trees");
  check_refused(with([](Json& j) { j["scenes"][0].erase("nodes"); }),
                "expected meshes of triangles that a scene shows");
  check_refused(with([](Json& j) { j["meshes"] = 7; }), "a.glb: meshes: expected an array, got 7");
  check_refused(with([](Json& j) { j["asset"]["version"] = "1.0"; }), "asset.version: expected 2.0, got \"1.0\"");
  check_refused(with([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 9; }),
                "mode: expected a whole number from 0 to 6");
  check_refused(with([](Json& j) { j["accessors"][3]["count"] = 35; }), "expected triangles of three corners each");
  // One list of indices, which many primitives name, is not many lists.
  GltfModel many = as_of_blender();
  const Json primitive = {{"attributes", {{"POSITION", 0}}},
                          {"indices", many.add(std::string(4000, '\0'), 5121, 4000, "SCALAR")},
                          {"mode", 5}};
  for (int i = 0; i < 100; ++i) many.json["meshes"][0]["primitives"].push_back(primitive);
  check_refused(many, "corners in a file of its size");
  GltfModel far = as_of_blender();
  far.buffer.replace(0, 4, raw(std::numeric_limits<float>::infinity()));
  check_refused(far, "accessors[0]: expected finite numbers, got others in element 0");
  GltfModel index = as_of_blender();
  index.buffer.replace(index.json["bufferViews"][3]["byteOffset"].get<std::size_t>() + 4, 2, raw(std::uint16_t{24}));
  check_refused(index, "primitives[0].indices: expected indices below 24, got 24 in element 2");
}

TEST_CASE("gltf: containers that promise too much are refused", "[gltf]") {
  const std::string glb = as_of_blender().glb();
  const auto refused = [](const std::string& bytes, const std::string& message) {
    CHECK_THROWS_WITH(glb_file(bytes), Catch::Contains(message));
  };
  for (std::size_t size : {1, 11, 19, 20, 30}) CHECK_THROWS_AS(glb_file(glb.substr(0, size)), InvalidInput);
  refused("glTX" + glb.substr(4), "a.glb, byte 0: expected \"glTF\"");
  refused("glTF" + raw(1u) + glb.substr(8), "a.glb, byte 4: expected version 2, got 1");
  refused(glb.substr(0, 8) + raw(0xffffffffu) + glb.substr(12), "a.glb, byte 8: expected a length from 20 to");
  refused(glb.substr(0, 12) + raw(0x7fffffffu) + glb.substr(16), "a.glb, byte 12: expected a chunk of at most");
  refused(glb.substr(0, 16) + "BIN!" + glb.substr(20), "a.glb, byte 16: expected a chunk of JSON");
  CHECK_THROWS_WITH(gltf_file(glb), Catch::Contains("a.gltf, byte 0: expected JSON text, got a binary file"));
  CHECK_THROWS_WITH(gltf_file(std::string(100000, '[')), Catch::Contains("nested at most 200 deep, got 100000"));
  CHECK_THROWS_WITH(gltf_file("{\"asset\": }"), Catch::Contains("a.gltf, byte 10: expected JSON text"));
  CHECK_THROWS_WITH(gltf_file("{\"asset\":{\"version\":1e999}}"), Catch::Contains("numbers that a double can hold"));

  const auto uri_refused = [](const std::string& uri, const std::string& message) {
    CHECK_THROWS_WITH(gltf_file(as_of_blender().gltf_beside(uri)), Catch::Contains(message));
  };
  uri_refused("/etc/passwd", "buffers[0].uri: expected a path relative to the file");
  uri_refused("%2Fetc/passwd", "buffers[0].uri: expected a path relative to the file");
  uri_refused("file:///etc/passwd", "buffers[0].uri: expected a path relative to the file");
  uri_refused("C:\\windows", "buffers[0].uri: expected a path relative to the file");
  uri_refused("../../../../../../../../dev/zero", "buffers[0].uri: expected a file at");
  uri_refused("no such.bin", "expected a file at no such.bin, got none");
  uri_refused("data:;base64,????", "buffers[0].uri: expected data in base64");
  uri_refused("data:;base64,AAAA", "buffers[0].byteLength: expected at most 3");
}
