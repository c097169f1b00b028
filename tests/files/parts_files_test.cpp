// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <tuple>
#include "support/countersink.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace parts_files {
using namespace vdb_offset::test::countersink;
namespace {

io::MeshFile as_file(const Polygons& mesh) {
  std::string text;
  for (const Vec3d& p : mesh.positions) text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += 'f';
    for (const auto v : mesh.view().face(f)) text += fmt::format(" {}", v + 1);
    text += '\n';
  }
  return io::parse_mesh("mesh.obj", io::Format::Obj, text);
}

std::vector<std::uint8_t> selected(const Polygons& mesh, const std::vector<std::string>& names) {
  std::vector<io::Selector> selectors;
  selectors.reserve(names.size());
  for (const std::string& name : names) selectors.push_back(io::parse_selector(name));
  return io::select_faces(as_file(mesh), selectors);
}

std::vector<std::uint8_t> negated(std::vector<std::uint8_t> marks) {
  for (auto& mark : marks) mark = mark == 0;
  return marks;
}

}  // namespace

TEST_CASE("selection: round holes by their faces and diameters, wherever they stand", "[selection]") {
  for (const std::uint32_t sides : {8u, 16u, 24u, 32u, 64u}) {
    CAPTURE(sides);
    const Countersink plate(sides, 90);
    Polygons turned = plate.mesh;  // about an axis, and moved away
    for (Vec3d& p : turned.positions) p = Vec3d(p[0] * 0.6 + p[2] * 0.8 + 100, p[1] - 40, p[2] * 0.6 - p[0] * 0.8);
    const auto of_rings = [&](std::initializer_list<std::uint32_t> rings) {
      std::vector<std::uint8_t> marks;
      for (std::uint32_t ring = 0; ring < 6; ++ring)
        marks.insert(marks.end(), 2 * sides, std::find(rings.begin(), rings.end(), ring) != rings.end());
      return marks;
    };
    for (const Polygons& mesh : {plate.mesh, turned, test::torn(turned)}) {
      CHECK(selected(mesh, {"holes"}) == of_rings({0, 1, 2}));  // the cone, whose smaller end is as wide, among them
      CHECK(selected(mesh, {"holes<6.001"}) == of_rings({0, 1, 2}));
      CHECK(selected(mesh, {"holes>5.999"}) == of_rings({0, 1, 2}));
      CHECK_THROWS_WITH(selected(mesh, {"holes<5.999"}), Catch::Contains("below 5.999, found 2 from 6 to 6"));
      CHECK_THROWS_WITH(selected(mesh, {"holes>6.001"}), Catch::Contains("above 6.001"));
      CHECK(selected(mesh, {"concave"}) == of_rings({0, 1, 2}));
      CHECK(selected(mesh, {"convex"}) == of_rings({4}));
      CHECK(selected(mesh, {"not:holes"}) == of_rings({3, 4, 5}));
    }
    CHECK(selected(plate.mesh, {"down"}) == of_rings({5}));
    CHECK(selected(plate.mesh, {"up"}) == of_rings({3}));  // not the cone, at 45 degrees
  }
}

TEST_CASE("selection: what is round and no hole, or has too few sides", "[selection]") {
  CHECK_THROWS_WITH(selected(shapes::cylinder(1, 2, 32, 2, 2), {"holes"}), Catch::Contains("found none"));
  CHECK_THROWS_WITH(selected(Countersink(6, 90).mesh, {"holes"}), Catch::Contains("found none"));
  CHECK_THROWS_WITH(selected(shapes::box(Vec3d(1, 1, 1), 2, true), {"concave"}), Catch::Contains("'concave'"));
  CHECK_THROWS_WITH(selected(shapes::icosphere(1, 3), {"holes"}), Catch::Contains("found none"));
  const auto all = selected(shapes::icosphere(1, 3), {"convex"});
  CHECK(std::count(all.begin(), all.end(), 1) == static_cast<std::ptrdiff_t>(all.size()));
}

TEST_CASE("selection: what is behind not: is taken from all else that is named", "[selection]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 2, false);
  const auto up = selected(box, {"up"}), down = selected(box, {"down"});
  CHECK(std::count(up.begin(), up.end(), 1) == static_cast<std::ptrdiff_t>(up.size() / 6));
  CHECK(selected(box, {"not:up"}) == negated(up));
  CHECK(selected(box, {"up", "not:down"}) == up);
  auto neither = negated(up);
  for (std::size_t f = 0; f < neither.size(); ++f) neither[f] &= down[f] == 0;
  CHECK(selected(box, {"not:up", "not:down"}) == neither);
  CHECK_THROWS_WITH(selected(box, {"up", "not:up"}), Catch::Contains("'not:'"));
  for (const char* const wrong : {"not:", "not:not:up", "not:roof", "holes<", "holes<0", "holes<x", "holes=3", "hole"})
    CHECK_THROWS_AS(io::parse_selector(wrong), InvalidOption);
}

TEST_CASE("selection: the flat end along an axis", "[selection]") {
  Polygons box = shapes::box(Vec3d(1, 1, 1), 2, false);
  const Polygons beyond = shapes::box(Vec3d(1, 1, 3), 1, false);  // its ends are farther along z
  const auto first = static_cast<std::uint32_t>(box.positions.size()), end = box.face_begin.back();
  box.positions.insert(box.positions.end(), beyond.positions.begin(), beyond.positions.end());
  for (const auto v : beyond.corners) box.corners.push_back(first + v);
  for (std::size_t f = 1; f < beyond.face_begin.size(); ++f) box.face_begin.push_back(end + beyond.face_begin[f]);
  const std::size_t faces = 24;  // of the first box
  for (const auto& [end_of, most] : {std::pair("planar:+z", 1.5), std::pair("planar:-z", 1.5)}) {
    const auto chosen = selected(box, {end_of});
    CHECK(std::count(chosen.begin(), chosen.end(), 1) == 1);
    const auto face =
        box.view().face(static_cast<std::size_t>(std::find(chosen.begin(), chosen.end(), 1) - chosen.begin()));
    for (const auto v : face) CHECK(std::abs(box.positions[v].z()) == most);
  }
  const auto side = selected(box, {"planar:-x"});
  CHECK(std::count(side.begin(), side.begin() + faces, 1) == 4);
  CHECK(std::count(side.begin() + faces, side.end(), 1) == 1);
  CHECK_THROWS_WITH(selected(shapes::icosphere(1, 3), {"planar:+y"}), Catch::Contains("'planar:+y', found none"));
  for (const char* const wrong : {"planar", "planar:", "planar:z", "planar:+w", "planar:+zz", "planar=+z"})
    CHECK_THROWS_AS(io::parse_selector(wrong), InvalidOption);
}

TEST_CASE("selection: groups, objects, materials and files of faces", "[selection]") {
  const Folder folder;
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no thing\ng left shared\nusemtl red\nf 1 2 3\ng right shared\nf 1 2 4\n"
      "usemtl blue paint\nf 2 3 4\ng\nf 1 3 4\n";
  const io::MeshFile mesh = io::parse_mesh("m.obj", io::Format::Obj, text);
  const auto marks = [&](const std::vector<std::string>& names) {
    std::vector<io::Selector> selectors;
    selectors.reserve(names.size());
    for (const std::string& name : names) selectors.push_back(io::parse_selector(name));
    return io::select_faces(mesh, selectors);
  };
  using Marks = std::vector<std::uint8_t>;
  CHECK(marks({"group=left"}) == Marks{1, 0, 0, 0});
  CHECK(marks({"group=shared"}) == Marks{1, 1, 1, 0});
  CHECK(marks({"group=thing"}) == Marks{1, 1, 1, 1});
  CHECK(marks({"material=red"}) == Marks{1, 1, 0, 0});
  CHECK(marks({"material=blue paint"}) == Marks{0, 0, 1, 1});
  CHECK(marks({"group=left", "material=blue paint"}) == Marks{1, 0, 1, 1});
  CHECK_THROWS_WITH(marks({"group=wheel"}), Catch::Contains("left, right, shared, thing"));
  CHECK_THROWS_AS(marks({"material=green"}), InvalidOption);
  CHECK_THROWS_AS(io::parse_selector("roof"), InvalidOption);
  CHECK_THROWS_AS(io::parse_selector("group="), InvalidOption);

  const auto from = [&](const std::string& content) {
    std::ofstream(folder.file("faces.txt")) << content;
    return marks({"faces=" + folder.file("faces.txt")});
  };
  CHECK(from("2\n3 # the last\n") == Marks{0, 0, 1, 1});
  CHECK(from("0 1 0 1") == Marks{0, 1, 0, 1});
  CHECK(from("3 1 0 1") == Marks{1, 1, 0, 1});  // indices, as a mark of 3 there is none
  CHECK_THROWS_WITH(from("1\n4\n"), Catch::Contains("line 2"));
  CHECK_THROWS_AS(from("-1"), InvalidInput);
  CHECK_THROWS_AS(from("a"), InvalidInput);
  CHECK_THROWS_AS(marks({"faces=" + folder.file("none.txt")}), ReadError);
}

}  // namespace parts_files
