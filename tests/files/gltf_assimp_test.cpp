// SPDX-License-Identifier: Apache-2.0
// Files as Assimp reads them, which shares no code with this project.

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/folder.h"
#include "support/gltf_model.h"
#include "vdb_offset/io/mesh_file.h"

using namespace vdb_offset;
using test::GltfModel;

// Names of its own, as tests are compiled several files at once.
namespace gltf_by_assimp {
namespace {

Vec3d vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// All meshes in one, where the nodes place them.
struct Placed {
  std::vector<Vec3d> positions, normals;
  std::vector<Vec2d> texture;
  std::vector<std::uint32_t> corners;

  explicit Placed(const std::string& path) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path, aiProcess_PreTransformVertices);
    INFO(importer.GetErrorString());
    REQUIRE(scene);
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) add(*scene->mMeshes[m]);
  }

 private:
  void add(const aiMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      positions.push_back(vector_of(mesh.mVertices[v]));
      if (mesh.HasNormals()) normals.push_back(vector_of(mesh.mNormals[v]));
      if (mesh.HasTextureCoords(0)) texture.emplace_back(mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) corners.push_back(first + mesh.mFaces[f].mIndices[k]);
  }
};

/// Assimp places vertices in single precision.
void check_same(const io::MeshFile& file, const Placed& placed) {
  REQUIRE(placed.positions.size() == file.polygons.positions.size());
  CHECK(placed.corners == file.polygons.corners);
  double farthest = 0, most_turned = 0, most_shifted = 0;
  const io::Attributes with = io::read_attributes(file);
  for (std::size_t v = 0; v < placed.positions.size(); ++v) {
    farthest = std::max(farthest, (placed.positions[v] - file.polygons.positions[v]).length());
    if (!with.normals.empty())
      most_turned = std::max(most_turned, (placed.normals.at(v) - with.normals.value[v]).length());
    if (!with.texture.empty())
      most_shifted = std::max(most_shifted, (placed.texture.at(v) - with.texture.value[v]).length());
  }
  CHECK(farthest < 1e-5);
  CHECK(most_turned < 1e-5);
  CHECK(most_shifted < 1e-6);
}

}  // namespace
}  // namespace gltf_by_assimp

using namespace gltf_by_assimp;

TEST_CASE("gltf: Assimp reads the same mesh, before and after", "[gltf]") {
  const test::HardCube cube;
  GltfModel model;
  model.json["scene"] = 0;
  model.json["scenes"] = {{{"nodes", {0}}}};
  std::string uv;
  for (std::size_t v = 0; v < 24; ++v) uv += raw(static_cast<float>(v) / 32) + raw(0.25f);
  const std::size_t position = model.add_points(cube.points, true), normal = model.add_points(cube.normals),
                    texture = model.add(uv, 5126, 24, "VEC2"), indices = model.add_indices(cube.indices);
  model.add_mesh(
      {{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", texture}}}, {"indices", indices}},
      {{"rotation", {0.6, 0, 0, 0.8}}, {"scale", {1, 2, 0.5}}, {"translation", {1, 2, 3}}});
  const Folder folder;
  for (const std::string name : {"a.glb", "a.gltf"}) {
    const io::MeshFile file = io::read_mesh(folder.write(name, name == "a.glb" ? model.glb() : model.gltf()));
    check_same(file, Placed(folder.file(name)));
    std::vector<Vec3d> positions = file.polygons.positions;
    for (Vec3d& p : positions) p += Vec3d(0.5 * p[1], 0.25 * p[0], -0.125 * p[1]);
    io::write_mesh(folder.file("moved_" + name), file, positions);
    check_same(io::read_mesh(folder.file("moved_" + name)), Placed(folder.file("moved_" + name)));
  }
}

TEST_CASE("gltf: Assimp reads new files", "[gltf]") {
  const Folder folder;
  const io::MeshFile obj = io::parse_mesh(
      "in.obj", io::Format::Obj,
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.25\nvt 0 0\nvt 0.25 0\nvt 0 0.125\nvt 0.5 1\nvt 0.75 0.5\nvt 1 1\n"
      "vn 0 0 1\nvn 0 1 0\nf 1/1/1 2/2/1 3/3/1\nf 2/4/2 4/6/1 3/5/1\n");
  for (const char* name : {"new.glb", "new.gltf"}) {
    io::write_mesh(folder.file(name), obj, obj.polygons.positions);
    check_same(io::read_mesh(folder.file(name)), Placed(folder.file(name)));
  }
}
