// SPDX-License-Identifier: Apache-2.0
// CAD models whose offset has another topology than they have, or no exact face in places, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "cad/cad_files.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"

using namespace vdb_offset;
using Made = CadFileFacts::Made;

namespace {

std::string path_in(const std::string& name) { return (test::cad_files().folder() / name).string(); }

struct Moved {
  CadFileFacts facts;
  io::MeshFile again;
};

/// Offsets a model as the command does, with the mesh for where exact faces fail, and reads what was written.
Moved moved(const std::string& name, const io::CadDistances& distances, const io::CadWriting& how = {},
            bool fuses_bodies = false) {
  REQUIRE(test::cad_files().is_made());
  io::ReadOptions reading;
  reading.cad.deflection = 0.01;
  reading.cad.fuses_bodies = fuses_bodies;
  const io::MeshFile source = io::read_mesh(path_in(name), reading);
  OffsetOptions options;
  options.distance = Distances(distances.each.front().number);
  options.corners = Corners::Miter;
  options.exact = source.exact.get();
  const OffsetResult mesh = offset(source.polygons.view(), options);
  Moved result;
  result.facts = io::write_cad(path_in("body.step"), source, distances, mesh.positions, how);
  result.again = io::read_mesh(path_in("body.step"), reading);
  return result;
}

/// How many parts of a mesh have no vertex in common, and its volume.
struct Solids {
  std::size_t count = 0;
  double volume = 0;
};

Solids solids_of(const io::MeshFile& file) {
  std::vector<std::size_t> part(file.polygons.positions.size());
  for (std::size_t v = 0; v < part.size(); ++v) part[v] = v;
  const auto first = [&](std::size_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  Solids solids;
  for (std::size_t f = 0; f < file.polygons.face_count(); ++f) {
    const auto face = file.polygons.view().face(f);
    for (const auto v : face) part[std::max(first(v), first(face[0]))] = std::min(first(v), first(face[0]));
    const auto at = [&](std::size_t k) { return file.polygons.positions[face[k]]; };
    solids.volume += at(0).dot(at(1).cross(at(2))) / 6;
  }
  for (std::size_t v = 0; v < part.size(); ++v) solids.count += first(v) == v;
  return solids;
}

/// The face of the block that is upright at x = 0 goes farther than the others, which it is joined to by a fillet.
io::CadDistances stepped(const io::MeshFile& block) {
  io::CadDistances distances;
  distances.each = {{0.5, {}}, {1.2, {}}};
  distances.scale = 1.2;
  for (std::size_t f = 0; f < block.polygons.face_count(); ++f) {
    const auto face = block.polygons.view().face(f);
    const bool is_far =
        std::all_of(face.begin(), face.end(), [&](auto v) { return std::abs(block.polygons.positions[v].x()) < 1e-9; });
    distances.of_face.push_back(is_far ? 1 : 0);
  }
  return distances;
}

}  // namespace

TEST_CASE("cad bodies: a block whose fillets the distance swallows all is a block", "[cad]") {
  for (const double d : {-3.5, -4.0}) {
    const Moved block = moved("rounded_block.step", d);
    CHECK(block.facts.made == Made::Solid);
    CHECK(block.facts.kept == 6);
    CHECK(block.facts.swallowed == 20);
    CHECK(block.facts.volume == Approx((30 + 2 * d) * (20 + 2 * d) * (15 + 2 * d)).epsilon(1e-6));
  }
}

TEST_CASE("cad bodies: a solid falls apart where a bar of it vanishes", "[cad]") {
  const Moved cubes = moved("dumbbell.step", -1.2);
  CHECK(cubes.facts.made == Made::Solid);
  CHECK(cubes.facts.volume == Approx(2 * 7.6 * 7.6 * 7.6).epsilon(1e-6));
  const Solids solids = solids_of(cubes.again);
  CHECK(solids.count == 2);
  CHECK(solids.volume == Approx(2 * 7.6 * 7.6 * 7.6).epsilon(1e-6));
}

TEST_CASE("cad bodies: a tip of twelve faces moves along its axis", "[cad]") {
  // Sides and base go by d along their normals: the pyramid stays similar about a point of its axis.
  const double foot = 10 * std::cos(std::numbers::pi / 12), slope = std::hypot(foot, 10);
  const double area = 12 * 0.5 * 100 * std::sin(2 * std::numbers::pi / 12);
  for (const double d : {0.3, -0.3}) {
    const double height = 10 + d + d * slope / foot;  // the base goes down, the tip up
    const Moved pyramid = moved("pyramid.step", d);
    CHECK(pyramid.facts.made == Made::Solid);
    CHECK(pyramid.facts.kept == 13);
    CHECK(pyramid.facts.volume == Approx(area * height / 3 * std::pow(height / 10, 2)).epsilon(1e-6));
  }
}

TEST_CASE("cad bodies: a solid of which nothing is left is reported, and the others are written", "[cad]") {
  const Moved left = moved("block_and_plate.step", -0.3);
  CHECK(left.facts.made == Made::Solid);
  CHECK(left.facts.vanished == 1);
  CHECK(left.facts.volume == Approx(29.4 * 19.4 * 14.4).epsilon(1e-9));
  CHECK_THROWS_WITH(moved("block_and_plate.step", -8), Catch::Contains("nothing is left of it"));
}

TEST_CASE("cad bodies: solids that touch or get into each other are offset as one where that is asked for", "[cad]") {
  for (const double d : {0.1, -0.1}) {
    const Moved boxes = moved("touching.step", d, {}, true);  // unit cubes, face to face
    CHECK(boxes.facts.made == Made::Solid);
    CHECK(boxes.facts.kept == 10);
    CHECK(boxes.facts.gaps.empty());
    CHECK(boxes.facts.volume == Approx((2 + 2 * d) * (1 + 2 * d) * (1 + 2 * d)).epsilon(1e-9));
    CHECK(solids_of(boxes.again).count == 1);
  }
  // Of two that share a part, it counts once; a third one that is apart stays what it is.
  const Moved crossed = moved("crossed.step", 0.5, {}, true);
  CHECK(crossed.facts.made == Made::Solid);
  CHECK(crossed.facts.volume == Approx(21 * 5 * 5 * 2 - 5 * 5 * 5 + 27).epsilon(1e-9));
  CHECK(solids_of(crossed.again).count == 2);
}

TEST_CASE("cad bodies: faces in IGES that lie as they come are a solid where they close", "[cad]") {
  const Moved cube = moved("turned_cube.igs", 0.2);
  CHECK(cube.facts.made == Made::Solid);  // in inches
  CHECK(solids_of(cube.again).volume == Approx(std::pow(10 / 25.4 + 0.4, 3)).epsilon(1e-7));
}

TEST_CASE("cad bodies: triangles take the place of faces that fail, in one closed solid", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const io::MeshFile block = io::read_mesh(path_in("block.step"));
  io::CadDistances distances = stepped(block);
  REQUIRE(std::count(distances.of_face.begin(), distances.of_face.end(), 1) > 0);
  OffsetOptions options;
  options.corners = Corners::Miter;
  options.exact = block.exact.get();
  std::vector<double> own;
  for (const Vec3d& at : block.polygons.positions) own.push_back(std::abs(at.x()) < 1e-9 ? 1.2 : 0.5);
  options.distance = Distances(own);
  const OffsetResult mesh = offset(block.polygons.view(), options);
  const CadFileFacts facts = io::write_cad(path_in("hybrid.step"), block, distances, mesh.positions);
  CHECK(facts.made == Made::Hybrid);
  CHECK(facts.triangles > 0);
  CHECK(facts.faceted > 0);
  CHECK(facts.exact_share > 0.3);
  CHECK(facts.exact_share < 1);
  CHECK_FALSE(facts.gaps.empty());
  io::MeshFile moved_block = block;
  moved_block.polygons.positions.assign(mesh.positions.begin(), mesh.positions.end());
  CHECK(facts.volume == Approx(solids_of(moved_block).volume).epsilon(1e-3));
  const Solids again = solids_of(io::read_mesh(path_in("hybrid.step")));
  CHECK(again.count == 1);
  CHECK(again.volume == Approx(facts.volume).epsilon(1e-3));

  io::CadWriting how;
  how.exact = true;
  CHECK_THROWS_AS(io::write_cad(path_in("none.step"), block, distances, mesh.positions, how), io::NoCadModel);
  CHECK_FALSE(std::filesystem::exists(path_in("none.step")));
}

TEST_CASE("cad bodies: an opened solid has a rim in the surface of each open face", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const io::MeshFile both = io::read_mesh(path_in("block_and_plate.step"));
  const double block = 30 * 20 * 15, plate = 30 * 20 * 0.5;
  struct Case {
    double d;
    std::vector<const char*> open;  // the block's alone, which is the farther one either way
    double volume;
  };
  const Case cases[] = {
      {-0.2, {"planar:+z"}, block - 29.6 * 19.6 * 14.8 + plate - 29.6 * 19.6 * 0.1},
      {1, {"planar:+z"}, 32 * 22 * 16 - block + 32 * 22 * 2.5 - plate},
      {1, {"planar:+z", "planar:-x"}, 31 * 22 * 16 - block + 32 * 22 * 2.5 - plate},  // side by side
  };
  for (const Case& each : cases) {
    std::vector<io::Selector> open;
    for (const char* const part : each.open) open.push_back(io::parse_selector(std::string("not:") + part));
    io::CadWriting how;
    how.exact = how.thick = true;
    how.only = io::select_faces(both, open);
    const CadFileFacts facts = io::write_cad(path_in("opened.step"), both, each.d, {}, how);
    CHECK(facts.made == Made::Solid);
    CHECK(facts.volume == Approx(each.volume).epsilon(1e-6));
    const io::MeshFile again = io::read_mesh(path_in("opened.step"));
    const Solids solids = solids_of(again);
    CHECK(solids.volume == Approx(each.volume).epsilon(1e-6));
    CHECK(solids.count == 3);  // the block's wall is one, the plate's has two skins
    for (const Vec3d& at : again.polygons.positions)
      if (at.x() < 35) CHECK(at.z() < 15 + 1e-9);
  }
}

TEST_CASE("cad bodies: walls of an opened solid that hang together nowhere are solids each", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const io::MeshFile tube = io::read_mesh(path_in("tube.step"));  // radii 8 and 10, height 20
  io::CadWriting how;
  how.exact = how.thick = true;
  const std::vector<io::Selector> walls = {io::parse_selector("not:planar:+z"), io::parse_selector("not:planar:-z")};
  how.only = io::select_faces(tube, walls);
  const CadFileFacts facts = io::write_cad(path_in("rings.step"), tube, -0.2, {}, how);
  CHECK(facts.made == Made::Solid);
  const double volume = std::numbers::pi * 20 * (10 * 10 - 9.8 * 9.8 + 8.2 * 8.2 - 8 * 8);
  CHECK(facts.volume == Approx(volume).epsilon(1e-6));
  const Solids solids = solids_of(io::read_mesh(path_in("rings.step")));
  CHECK(solids.count == 2);
  CHECK(solids.volume == Approx(volume).epsilon(1e-3));
}
