// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "support/folder.h"
#include "support/gltf_model.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;
using test::GltfModel;

// Names of its own, as tests are compiled several files at once.
namespace gltf_written {
namespace {

namespace fs = std::filesystem;

/// A cube with its data in `data/the cube.bin`, and an image.
std::string write_cube_beside(const Folder& folder, const std::string& name) {
  const test::HardCube cube;
  GltfModel model;
  const std::size_t position = model.add_points(cube.points, true), normal = model.add_points(cube.normals);
  model.add_mesh(
      {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", model.add_indices(cube.indices)}});
  model.json["images"] = {{{"uri", "data/a.png"}}, {{"uri", "https://example.com/b.png"}}};
  fs::create_directories(folder.path / "data");
  folder.write("data/the cube.bin", model.buffer + "behind");
  folder.write("data/a.png", "a picture");
  return folder.write(name, model.gltf_beside("data/the%20cube.bin"));
}

std::vector<Vec3d> scaled(const io::MeshFile& file, double factor) {
  std::vector<Vec3d> positions = file.polygons.positions;
  for (Vec3d& p : positions) p *= factor;
  return positions;
}

const std::string kPaintedSeam =
    "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0.1 1 1 1\nvt 0 0\nvt 0.25 0\nvt 0 0.125\nvt 0.5 1\nvt 0.75 "
    "0.5\n"
    "vt 1 1\nusemtl red\nf 1/1 2/2 3/3\nusemtl blue\nf 2/4 4/6 3/5\n";

}  // namespace
}  // namespace gltf_written

using namespace gltf_written;

TEST_CASE("gltf: files beside go along, and those of the source are never replaced", "[gltf]") {
  const Folder folder;
  const std::string path = write_cube_beside(folder, "cube.gltf");
  const std::string before = slurp(folder.file("data/the cube.bin"));
  const io::MeshFile file = io::read_mesh(path);

  io::write_mesh(folder.file("larger.gltf"), file, scaled(file, 2));
  CHECK(slurp(folder.file("data/the cube.bin")) == before);
  const std::string data = slurp(folder.file("larger.bin"));
  CHECK(data.size() == before.size());
  CHECK(data.substr(288) == before.substr(288));
  CHECK(io::read_mesh(folder.file("larger.gltf")).polygons.positions == scaled(file, 2));
  CHECK(slurp(folder.file("larger.gltf")).find("\"larger.bin\"") != std::string::npos);

  SECTION("the source itself is replaced with its data") {
    io::write_mesh(path, file, scaled(file, 3));
    CHECK(slurp(folder.file("data/the cube.bin")) != before);
    CHECK(io::read_mesh(path).polygons.positions == scaled(file, 3));
  }
  SECTION("a name that the source uses is not taken") {
    fs::rename(folder.file("data/the cube.bin"), folder.file("out.bin"));
    std::string text = slurp(path);
    text.replace(text.find("data/the%20cube.bin"), 19, "out.bin");
    const io::MeshFile other = io::read_mesh(folder.write("in.gltf", text));
    io::write_mesh(folder.file("out.gltf"), other, scaled(other, 2));
    CHECK(slurp(folder.file("out.bin")) == before);
    CHECK(io::read_mesh(folder.file("out.gltf")).polygons.positions == scaled(other, 2));
    CHECK(fs::exists(folder.file("out.gltf_1.bin")));
  }
  SECTION("in another folder, files that stay are copied") {
    fs::create_directories(folder.path / "out");
    io::write_mesh(folder.file("out/same.gltf"), file, file.polygons.positions);
    CHECK(slurp(folder.file("out/same.gltf")) == slurp(path));
    CHECK(slurp(folder.file("out/data/the cube.bin")) == before);
    CHECK(slurp(folder.file("out/data/a.png")) == "a picture");
    io::write_mesh(folder.file("out/same.gltf"), file, file.polygons.positions);
    folder.write("out/data/a.png", "another picture");
    CHECK_THROWS_WITH(io::write_mesh(folder.file("out/same.gltf"), file, file.polygons.positions),
                      Catch::Contains("expected no other file at"));
    CHECK(slurp(folder.file("out/data/a.png")) == "another picture");
  }
}

TEST_CASE("gltf: a mesh of another format becomes a new file", "[gltf]") {
  const Folder folder;
  const io::MeshFile obj = io::parse_mesh("in.obj", io::Format::Obj, kPaintedSeam);
  for (const char* name : {"out.glb", "out.gltf"}) {
    const io::WriteResult result = io::write_mesh(folder.file(name), obj, obj.polygons.positions);
    CHECK(result.lost == "what materials are made of, digits beyond single precision");
    const io::MeshFile back = io::read_mesh(folder.file(name));
    // Vertices 2 and 3 have two pairs of texture coordinates each: copies behind the others.
    REQUIRE(back.polygons.positions.size() == 6);
    CHECK(back.polygons.corners == std::vector<std::uint32_t>{0, 1, 2, 4, 3, 5});
    CHECK(io::find_in_triangles(obj.polygons.view(), back.polygons.view()).has_value());
    const io::Attributes with = io::read_attributes(back);
    CHECK(with.texture.value == std::vector<Vec2d>{{0, 0}, {0.25, 0}, {0, 0.125}, {1, 1}, {0.5, 1}, {0.75, 0.5}});
    CHECK(with.colours[4] == with.colours[1]);
    CHECK(with.colours[2] == std::array<double, 4>{0, 0, 1, 1});
    CHECK_FALSE(with.has_alpha);
    CHECK(io::read_materials(back).names == std::vector<std::string>{"red", "blue"});
    CHECK(io::patched_bytes(back, back.polygons.positions) == slurp(folder.file(name)));
    io::write_mesh(folder.file("again.obj"), back, back.polygons.positions);
    CHECK(io::read_attributes(io::read_mesh(folder.file("again.obj"))).texture.value == with.texture.value);
  }
}

TEST_CASE("gltf: polygons become triangles, and shells parts", "[gltf]") {
  const Folder folder;
  const io::MeshFile obj = io::parse_mesh("in.obj", io::Format::Obj, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  std::vector<Vec3d> up = obj.polygons.positions;
  for (Vec3d& p : up) p[2] = 1;
  const Shell shell = make_shell(obj.polygons.view(), up, obj.polygons.positions, {});
  io::write_shell(folder.file("shell.glb"), obj, shell);
  const io::MeshFile back = io::read_mesh(folder.file("shell.glb"));
  CHECK(back.polygons.positions.size() == 8);
  CHECK(back.polygons.face_count() == 12);
  CHECK(io::wall_names(back).names == std::vector<std::string>{"outer", "inner", "rim"});

  // A shell of such a file is a new one, too.
  const Shell again = make_shell(back.polygons.view(), back.polygons.positions, scaled(back, 0.5), {});
  io::write_shell(folder.file("again.glb"), back, again);
  CHECK(io::read_mesh(folder.file("again.glb")).polygons.positions.size() == 16);
}

TEST_CASE("gltf: coordinates that single precision cannot hold are refused", "[gltf]") {
  const Folder folder;
  const io::MeshFile obj = io::parse_mesh("in.obj", io::Format::Obj, "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK_THROWS_WITH(io::write_mesh(folder.file("out.glb"), obj, obj.polygons.positions),
                    Catch::Contains("expected coordinates that single precision can hold"));
  CHECK_FALSE(fs::exists(folder.file("out.glb")));
}
