// SPDX-License-Identifier: Apache-2.0
// Files that Assimp reads.
//
// Files of other programs that were tried, and are not here: .fbx and .dae of Blender 3.4 (a monkey under a scaled,
// turned node and a mirrored cube), .dae and .3ds of Assimp 5.2's own exporters.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

/// A Collada file of one quad and one triangle, placed twice: as it is, and mirrored and moved.
std::string collada() {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g" name="patch"><mesh>
<source id="p"><float_array id="pa" count="15">0 0 0 1 0 0 1 1 0 0 1 0 0.5 0.5 2</float_array>
<technique_common><accessor source="#pa" count="5" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 3</vcount><p>0 1 2 3 0 1 4</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="first" name="first"><instance_geometry url="#g"/></node>
<node id="second" name="second"><matrix>-2 0 0 10 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

}  // namespace

TEST_CASE("files that Assimp reads: each mesh where its nodes place it", "[documents][assimp]") {
  const io::MeshFile file = io::parse_mesh("a.dae", io::Format::Assimp, collada());
  REQUIRE(file.polygons.face_count() == 4);
  CHECK(file.polygons.face_begin == std::vector<std::uint32_t>{0, 4, 7, 11, 14});
  const auto corner = [&](std::size_t c) { return file.polygons.positions[file.polygons.corners[c]]; };
  CHECK(corner(1) == Vec3d(1, 0, 0));
  // Mirrored, the face is turned round, so that its outside stays outside.
  CHECK(corner(7) == Vec3d(10, 2, 0));
  CHECK(corner(9) == Vec3d(8, 0, 0));
  CHECK(io::wall_names(file).names == std::vector<std::string>{"first", "second"});
  CHECK(io::select_faces(file, std::vector{io::Selector{io::Selector::By::Group, "second"}}) ==
        std::vector<std::uint8_t>{0, 0, 1, 1});
}

TEST_CASE("files that Assimp reads: what cannot be read or written is told", "[documents][assimp]") {
  CHECK_THROWS_WITH(io::parse_mesh("a.dae", io::Format::Assimp, collada().substr(0, 900)),
                    Catch::Contains("a.dae: expected a file that Assimp reads, got: "));
  CHECK_THROWS_AS(io::parse_mesh("a.fbx", io::Format::Assimp, "Kaydara FBX Binary  "), InvalidInput);
  CHECK_THROWS_AS(io::parse_mesh("a.3ds", io::Format::Assimp, std::string("MM\xff\xff\xff\x7f", 6)), InvalidInput);
  const io::MeshFile file = io::parse_mesh("a.dae", io::Format::Assimp, collada());
  CHECK_THROWS_WITH(io::write_mesh("b.dae", file, file.polygons.positions), Catch::Contains("read only"));
  CHECK(io::unit_micrometres("nowhere.glb") == 1e6);
}
