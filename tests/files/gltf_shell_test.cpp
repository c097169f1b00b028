// SPDX-License-Identifier: Apache-2.0
// Shells of glTF files, written into the file that they are of.
#include <catch2/catch.hpp>

#include <cstring>

#include "gltf/container.h"
#include "space/surface/surface.h"
#include "support/folder.h"
#include "support/gltf_model.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"

using namespace vdb_offset;
using test::GltfModel;
using test::HardCube;

// Names of its own, as tests are compiled several files at once.
namespace gltf_shells {
namespace {

using Json = GltfModel::Json;

/// A cube of hard edges in two primitives of two materials, over one set of vertices with texture coordinates,
/// tangents, weights of bones and a morph target, mirrored and moved; and a plain triangle beside it.
GltfModel two_materials() {
  const HardCube cube;
  GltfModel model;
  model.json["scene"] = 0;
  model.json["scenes"] = {{{"nodes", {0, 1}}}};
  model.json["materials"] = {{{"name", "red"}}, {{"name", "blue"}, {"extras", {{"kept", 1.5}}}}};
  model.json["skins"] = {{{"joints", {1}}}};
  std::string uv, joints, weights, tangents;
  for (std::size_t v = 0; v < 24; ++v) {
    uv += raw(static_cast<float>(v) / 32) + raw(0.25f);
    joints += std::string(3, '\0') + static_cast<char>(v);
    weights += raw(1.f) + raw(0.f) + raw(0.f) + raw(0.f);
    const Vec3d &n = cube.normals[v], along(n[1], n[2], n[0]);
    for (int k = 0; k < 3; ++k) tangents += raw(static_cast<float>(along[k]));
    tangents += raw(1.f);
  }
  const std::size_t position = model.add_points(cube.points, true), normal = model.add_points(cube.normals);
  Json attributes = {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", model.add(uv, 5126, 24, "VEC2")}};
  attributes["TANGENT"] = model.add(tangents, 5126, 24, "VEC4");
  attributes["JOINTS_0"] = model.add(joints, 5121, 24, "VEC4");
  attributes["WEIGHTS_0"] = model.add(weights, 5126, 24, "VEC4");
  const Json targets = {{{"POSITION", model.add_points(cube.normals, true)}}};
  const std::vector<std::uint16_t> first(cube.indices.begin(), cube.indices.begin() + 18),
      second(cube.indices.begin() + 18, cube.indices.end());
  Json primitive = {{"attributes", attributes}, {"material", 0}, {"targets", targets}}, other = primitive;
  primitive["indices"] = model.add_indices(first);
  other["indices"] = model.add_indices(second);
  other["material"] = 1;
  model.add_mesh(primitive, {{"name", "box"}, {"scale", {-1, 1, 1}}, {"translation", {8, 0, 0}}, {"skin", 0}});
  model.json["meshes"][0]["primitives"].push_back(other);
  model.add_mesh({{"attributes", {{"POSITION", model.add_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, true)}}}},
                 {{"name", "leaf"}});
  return model;
}

/// The JSON of a written file, and numbers of its accessors.
struct Read {
  Json json;
  std::string binary;

  explicit Read(const std::string& glb) {
    const io::MeshFile file = io::parse_mesh("a.glb", io::Format::Glb, glb);
    const io::gltf::Container container = io::gltf::read_container(file);
    json = Json::parse(container.json_of(glb));
    binary = glb.substr(container.bin->begin, container.bin->size);
  }
  template <class Number>
  std::vector<Number> element(const std::string& attribute, std::size_t i, std::size_t width) const {
    const Json& accessor =
        json["accessors"][json["meshes"][0]["primitives"][0]["attributes"][attribute].get<std::size_t>()];
    const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    std::vector<Number> numbers(width);
    std::memcpy(numbers.data(), binary.data() + view["byteOffset"].get<std::size_t>() + i * width * sizeof(Number),
                width * sizeof(Number));
    return numbers;
  }
};

Shell thick(const io::MeshFile& file, const std::vector<std::uint8_t>& only = {}) {
  std::vector<Vec3d> inner = file.polygons.positions;
  for (Vec3d& p : inner) p = p * 0.5 + Vec3d(4, 0, 0);
  return make_shell(file.polygons.view(), file.polygons.positions, inner, {}, file.precision, only);
}

}  // namespace
}  // namespace gltf_shells
using namespace gltf_shells;

TEST_CASE("gltf: a shell keeps nodes, materials, texture coordinates and weights", "[gltf][shell]") {
  const Folder folder;
  const GltfModel model = two_materials();
  for (const bool is_text : {false, true}) {
    const std::string bytes = is_text ? model.gltf() : model.glb(), name = is_text ? "s.gltf" : "s.glb";
    const io::MeshFile file = io::parse_mesh("a", is_text ? io::Format::Gltf : io::Format::Glb, bytes);
    const Shell shell = thick(file);
    const io::WriteResult result = io::write_shell(folder.file(name), file, shell);
    CHECK_THAT(result.lost, Catch::StartsWith("the parts of the shell"));
    CHECK(result.lost.find(';') == std::string::npos);
    const io::MeshFile back = io::read_mesh(folder.file(name));
    CHECK(back.extras == file.extras);
    CHECK(build_surface(back.polygons.view(), WeldOptions::automatic()).facts.closed());
    CHECK(back.polygons.face_count() == shell.polygons.face_count() + shell.facts.rim_quads);
    const io::Materials materials = io::read_materials(back);
    CHECK(std::count(materials.of_face.begin(), materials.of_face.end(), materials.of_face[0]) == 12);
    const WallNames walls = io::wall_names(back);
    CHECK(walls.names == std::vector<std::string>{"box", "leaf"});
    CHECK(std::count(walls.of_face.begin(), walls.of_face.end(), 0) == 24);
    // Each vertex has texture coordinates and is where it should be.
    const io::Attributes attributes = io::read_attributes(back);
    REQUIRE(attributes.texture.value.size() == back.polygons.positions.size());
    CHECK(attributes.texture.value[24] == attributes.texture.value[0]);
    CHECK(back.polygons.positions[24 + 5] == shell.polygons.positions[shell.source_vertices() + 5]);
    if (is_text) continue;
    const Read read(slurp(folder.file(name)));
    CHECK(read.json["nodes"] == model.json["nodes"]);
    CHECK(read.json["materials"] == model.json["materials"]);
    CHECK(read.json["skins"] == model.json["skins"]);
    CHECK(read.element<std::uint8_t>("JOINTS_0", 24 + 7, 4) == std::vector<std::uint8_t>{0, 0, 0, 7});
    CHECK(read.element<float>("WEIGHTS_0", 24 + 7, 4) == std::vector<float>{1, 0, 0, 0});
    // In the mesh's own frame the cube's first side looks along -x; the inner one looks back, and the bitangent stays.
    CHECK(read.element<float>("NORMAL", 0, 3) == std::vector<float>{-1, 0, 0});
    CHECK(read.element<float>("NORMAL", 24, 3) == std::vector<float>{1, 0, 0});
    CHECK(read.element<float>("TANGENT", 24, 4)[3] == -1);
    const Json& position = read.json["accessors"][0];
    CHECK(position["count"] == 48);
    CHECK(position["min"] == Json({-1, -1, -1}));
  }
}

TEST_CASE("gltf: meshes of which a shell has no faces stay, and others lose faces that are not of it",
          "[gltf][shell]") {
  const Folder folder;
  const io::MeshFile file = io::parse_mesh("a.glb", io::Format::Glb, two_materials().glb());
  std::vector<std::uint8_t> only(file.polygons.face_count(), 0);
  std::fill_n(only.begin(), 6, std::uint8_t{1});  // those of the first primitive
  io::write_shell(folder.file("s.glb"), file, thick(file, only));
  const io::MeshFile back = io::read_mesh(folder.file("s.glb"));
  const Read read(slurp(folder.file("s.glb")));
  CHECK(read.json["meshes"][0]["primitives"].size() == 1);
  CHECK(read.json["meshes"][1] == two_materials().json["meshes"][1]);
  // Six triangles on each side, with a rim around three sides, and the leaf.
  CHECK(back.polygons.face_count() > 13);
  CHECK(io::read_materials(back).names == std::vector<std::string>{"red", ""});
}
