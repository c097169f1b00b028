// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "support/folder.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace opened_files {
namespace {

Refinement opened(const io::MeshFile& source) {
  OffsetOptions options;
  options.distance = 0.2;
  options.corners = Corners::Arc;
  Tolerance tolerance;
  tolerance.share = 0.05;
  Refinement refinement = offset_to_tolerance(source.polygons.view(), options, tolerance).refinement;
  REQUIRE(refinement.over_corners > 0);
  REQUIRE(refinement.over_ridges > refinement.over_corners);
  return refinement;
}

io::MeshFile parse(Format format, const std::string& bytes) {
  return io::parse_mesh(std::string("a.") + io::name(format), format, bytes);
}

// Four faces of one material, two of another; each with texture coordinates of its own.
const std::string kCube =
    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 -1\ng sides\nusemtl red\n"
    "f 1/1/1 2/2/1 6/3/1 5/4/1\nf 2/1/1 3/2/1 7/3/1 6/4/1\nf 3/1/1 4/2/1 8/3/1 7/4/1\nf 4/1/1 1/2/1 5/3/1 8/4/1\n"
    "g ends\nusemtl blue\nf 4/1/1 3/2/1 2/3/1 1/4/1\nf 5/1/1 6/2/1 7/3/1 8/4/1\n# end\n";

}  // namespace

TEST_CASE("opened OBJ: faces over ridges come last, in a group, with the material and texture of those beside them",
          "[io]") {
  const io::MeshFile source = parse(Format::Obj, kCube);
  const Refinement refinement = opened(source);
  const io::RefinedFile made = io::refine_file(source, refinement);
  CHECK(made.lost.empty());
  std::istringstream lines{std::string(made.file.text())};
  std::string line, group, material;
  std::size_t faces = 0;
  const PolygonView mesh = source.polygons.view();
  while (std::getline(lines, line)) {
    if (line.starts_with("g ")) group = line.substr(2);
    if (line.starts_with("usemtl ")) material = line.substr(7);
    if (!line.starts_with("f ")) continue;
    const std::uint32_t parent = refinement.parent[faces];
    CHECK(material == (parent < 4 ? "red" : "blue"));
    CHECK(group == (faces >= 6 ? "ridge" : parent < 4 ? "sides" : "ends"));
    std::istringstream corners(line.substr(2));
    for (std::string corner; corners >> corner;) {
      const std::size_t slash = corner.find('/');
      REQUIRE(slash != std::string::npos);
      const auto v = static_cast<std::uint32_t>(std::stoul(corner.substr(0, slash))) - 1;
      const std::uint32_t of = v < 8 ? v : refinement.added[v - 8].vertex[0];
      const auto face = mesh.face(parent);
      const auto at = std::find(face.begin(), face.end(), of);
      REQUIRE(at != face.end());
      CHECK(corner.substr(slash + 1) == std::to_string(at - face.begin() + 1) + (faces < 6 ? "/1" : ""));
    }
    ++faces;
  }
  CHECK(faces == refinement.parent.size());
  CHECK(made.file.text().find("g ridge") == made.file.text().rfind("g ridge"));
}

TEST_CASE("opened PLY, OFF and STL: the source's faces come first, those over ridges last", "[io]") {
  const Folder folder;
  const Polygons mesh = shapes::box({1, 1, 1}, 1, true);
  std::string text = "solid a\n";
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : mesh.view().face(f))
      text += fmt::format("vertex {} {} {}\n", mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
    text += "endloop\nendfacet\n";
  }
  folder.write("b.stl", text + "endsolid a\n");
  for (const std::string name : {"a.ply", "a.off", "a.stl", "b.stl"}) {
    INFO(name);
    if (name != "b.stl") io::write_mesh(folder.file(name), mesh.view());
    const io::MeshFile source = io::read_mesh(folder.file(name));
    const Refinement refinement = opened(source);
    const io::RefinedFile made = io::refine_file(source, refinement);
    const Polygons& found = made.file.polygons;
    REQUIRE(found.face_count() == refinement.parent.size());
    const auto number = [&](std::uint32_t v) { return made.vertex.empty() ? v : made.vertex[v]; };
    for (std::size_t f = 0; f < found.face_count(); ++f) {
      const auto face = found.view().face(f), wanted = refinement.polygons.view().face(f);
      REQUIRE(face.size() == wanted.size());
      for (std::size_t k = 0; k < face.size(); ++k) CHECK(number(face[k]) == wanted[k]);
    }
  }
}

TEST_CASE("opened files: the map has a line for each copy, and for each face over a ridge", "[io]") {
  const Folder folder;
  const io::MeshFile source = parse(Format::Obj, kCube);
  const Refinement refinement = opened(source);
  io::write_vertex_map(folder.file("map.txt"), refinement);
  std::istringstream lines(slurp(folder.file("map.txt")));
  std::size_t copies = 0, faces = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream words(line);
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    if (all.size() == 8) {
      CHECK(all[0] == std::to_string(8 + copies++));
      CHECK(all[5] == "1");
    } else {
      REQUIRE(all.size() == 2);
      CHECK(all[0] == std::to_string(6 + faces));
      CHECK(all[1] == std::to_string(refinement.parent[6 + faces++]));
    }
  }
  CHECK(copies == refinement.added.size());
  CHECK(faces == refinement.over_ridges);
}

}  // namespace opened_files
