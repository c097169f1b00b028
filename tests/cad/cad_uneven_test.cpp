// SPDX-License-Identifier: Apache-2.0
// CAD models that are written with distances that are not the same everywhere, against closed forms.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "cad/cad_files.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using Made = CadFileFacts::Made;

namespace {

std::string place_of(const std::string& name) { return (test::cad_files().folder() / name).string(); }

io::MeshFile model(const std::string& name) {
  REQUIRE(test::cad_files().is_made());
  io::ReadOptions reading;
  reading.cad.deflection = 0.01;
  return io::read_mesh(place_of(name), reading);
}

/// Marks the faces of the mesh all of whose corners are such points.
template <class Is>
std::vector<std::uint32_t> faces_of(const io::MeshFile& file, Is&& is_of) {
  std::vector<std::uint32_t> marks;
  for (std::size_t f = 0; f < file.polygons.face_count(); ++f) {
    const auto face = file.polygons.view().face(f);
    marks.push_back(
        std::all_of(face.begin(), face.end(), [&](auto v) { return is_of(file.polygons.positions[v]); }) ? 1 : 0);
  }
  return marks;
}

/// Marks the faces of the mesh that are on a plane across an axis.
std::vector<std::uint32_t> on_plane(const io::MeshFile& file, int axis, double at) {
  return faces_of(file, [&](const Vec3d& p) { return std::abs(p[axis] - at) < 1e-9; });
}

/// The distance of those faces, in place of what the others have.
io::CadDistances with_face(std::vector<std::uint32_t> marks, double others, double own, double blend = 0) {
  io::CadDistances distances;
  distances.each = {{others, {}}, {own, {}}};
  distances.of_face = std::move(marks);
  distances.scale = std::max(std::abs(others), std::abs(own));
  distances.blend = blend;
  return distances;
}

}  // namespace

TEST_CASE("cad uneven: a trimmed patch goes by its own u, and keeps its trimming curves", "[cad]") {
  const io::MeshFile patch = model("patch.brep");
  io::CadDistances distances(0);
  distances.each[0].expression.emplace("0.5 + 0.2*sin(2*pi*u)");
  distances.scale = 0.7;
  const CadFileFacts facts = io::write_cad(place_of("wavy.brep"), patch, distances, {});
  CHECK(facts.made == Made::Shells);
  CHECK(facts.fitted == 1);
  CHECK(facts.samples > 1000);
  CHECK(facts.least == Approx(1).margin(1e-4));
  CHECK(facts.most == Approx(1).margin(1e-4));

  const io::MeshFile wavy = model("wavy.brep");
  const auto texture = io::read_attributes(wavy).texture;
  std::map<std::array<std::uint32_t, 2>, int> faces_at;
  for (std::size_t f = 0; f < wavy.polygons.face_count(); ++f) {
    const auto face = wavy.polygons.view().face(f);
    for (std::size_t k = 0; k < 3; ++k)
      ++faces_at[{std::min(face[k], face[(k + 1) % 3]), std::max(face[k], face[(k + 1) % 3])}];
  }
  std::vector<bool> is_at_border(wavy.polygons.positions.size(), false);
  for (const auto& [edge, count] : faces_at)
    if (count == 1) is_at_border[edge[0]] = is_at_border[edge[1]] = true;
  double worst = 0, off_circle = 0;
  std::size_t on_circle = 0;
  for (std::size_t c = 0; c < wavy.polygons.corners.size(); ++c) {
    const Vec2d uv = texture.value[texture.index(c, wavy.polygons.corners[c])];
    const double u = uv[0], v = uv[1], distance = 0.5 + 0.2 * std::sin(2 * std::numbers::pi * u);
    const Vec3d source(40 * u, 30 * v, 8 * u * u - 6 * v * v);
    const Vec3d normal = Vec3d(40, 0, 16 * u).cross(Vec3d(0, 30, -12 * v)).unit();
    // Which side is outward of an open shell is what its face says.
    const Vec3d moved = wavy.polygons.positions[wavy.polygons.corners[c]] - source;
    const double side = moved.dot(normal) < 0 ? -1 : 1;
    worst = std::max(worst, (moved - normal * (side * distance)).length());
    const double radius = std::hypot(u - 0.5, v - 0.5);
    if (radius > 0.3 || !is_at_border[wavy.polygons.corners[c]]) continue;
    ++on_circle;
    off_circle = std::max(off_circle, std::abs(radius - 0.25));
  }
  CHECK(worst < 1e-4 * 0.7);
  CHECK(on_circle > 20);
  CHECK(off_circle < 1e-7);
}

TEST_CASE("cad uneven: a face has a distance of its own, and sharp edges follow", "[cad]") {
  const io::MeshFile block = model("block.step");
  for (const double top : {2.0, -3.0, 0.0}) {
    const CadFileFacts facts =
        io::write_cad(place_of("taller.step"), block, with_face(on_plane(block, 2, 20), 0.5, top), {});
    CHECK(facts.made == Made::Solid);
    CHECK(facts.kept == 8);
    const double round = 4.5, hole = 4.5;
    const double across = 41 * 31 - std::numbers::pi * hole * hole - round * round * (1 - std::numbers::pi / 4);
    CHECK(facts.volume == Approx(across * (20 + 0.5 + top)).epsilon(1e-9));
    CHECK(facts.least == Approx(1).margin(1e-9));
    CHECK(facts.most == Approx(1).margin(1e-9));
  }
}

TEST_CASE("cad uneven: distances change over a length where faces are joined smoothly", "[cad]") {
  const io::MeshFile block = model("block.step");
  // The plane that the round edge goes over into.
  std::vector<std::uint32_t> side;
  for (const auto& [axis, at] : {std::pair{0, 0.0}, {0, 40.0}, {1, 0.0}, {1, 30.0}}) {
    side = on_plane(block, axis, at);
    double widest = 0;
    for (std::size_t f = 0; f < side.size(); ++f)
      for (const std::uint32_t v : block.polygons.view().face(f))
        for (const std::uint32_t w : block.polygons.view().face(f))
          if (side[f])
            widest = std::max(widest,
                              std::abs(block.polygons.positions[v][1 - axis] - block.polygons.positions[w][1 - axis]));
    if (widest > 0 && widest < (axis == 0 ? 29 : 39)) break;
  }
  CHECK_THROWS_WITH(io::write_cad(place_of("step.step"), block, with_face(side, 0.5, 1), {}),
                    Catch::Contains("distances of faces that are joined smoothly differ where they meet"));
  const CadFileFacts blended = io::write_cad(place_of("blended.step"), block, with_face(side, 0.5, 1, 3), {});
  CHECK(blended.made == Made::Solid);
  CHECK(blended.fitted == 2);
  CHECK(blended.samples > 1000);
  CHECK(blended.least == Approx(1).margin(1e-3));
  CHECK(blended.most == Approx(1).margin(1e-3));
  const CadFileFacts all = io::write_cad(place_of("all.step"), block, 0.5, {});
  CHECK(blended.volume > all.volume + 0.45 * 20 * 20);
  CHECK(blended.volume < all.volume + 0.55 * 20 * 40);
}

TEST_CASE("cad uneven: a wall of a tube whose other wall stays is good until they meet", "[cad]") {
  const io::MeshFile tube = model("tube.step");
  for (const double radius : {10.0, 8.0}) {
    const auto wall =
        faces_of(tube, [&](const Vec3d& p) { return std::abs(std::hypot(p.x(), p.y()) - radius) < 1e-6; });
    const double outward = radius > 9 ? 1 : -1;
    for (const double distance : {1.0, -1.0, -1.9}) {
      INFO(radius << " by " << distance);
      const double moved = radius + outward * distance, other = 18 - radius;
      const CadFileFacts facts = io::write_cad(place_of("wall.step"), tube, with_face(wall, 0, distance), {});
      CHECK(facts.made == Made::Solid);
      CHECK(facts.volume == Approx(20 * std::numbers::pi * std::abs(moved * moved - other * other)).epsilon(1e-6));
    }
    // The ring from 7 to 8, as one of material, is where nothing is.
    for (const double distance : {-2.1, -3.0, -6.0}) {
      INFO(radius << " by " << distance);
      CHECK_THROWS_WITH(io::write_cad(place_of("gone.step"), tube, with_face(wall, 0, distance), {}),
                        Catch::Contains("walls are gone"));
    }
  }
  // A bore that closes is gone, and the solid is whole.
  const auto bore = faces_of(tube, [&](const Vec3d& p) { return std::hypot(p.x(), p.y()) < 9; });
  const CadFileFacts closed = io::write_cad(place_of("closed.step"), tube, with_face(bore, 0, 9), {});
  CHECK(closed.made == Made::Solid);
  CHECK(closed.volume == Approx(20 * std::numbers::pi * 100).epsilon(1e-9));
}

TEST_CASE("cad uneven: no wall of a cavity is beyond that of its block", "[cad][long]") {
  const io::MeshFile block = model("hollow.step"), ball = model("hollow_ball.step");
  const auto cavity =
      faces_of(block, [](const Vec3d& p) { return std::abs(p.x() - 20) < 16 && std::abs(p.z() - 10) < 6; });
  const auto outside = faces_of(block, [](const Vec3d& p) { return std::abs(p.x() - 20) > 16; });
  const auto inner = faces_of(ball, [](const Vec3d& p) { return p.length() < 9; });
  const auto made = [&](const io::MeshFile& file, const std::vector<std::uint32_t>& marks, double others, double own) {
    return io::write_cad(place_of("walls.step"), file, with_face(marks, others, own), {});
  };
  // Walls of 5: what goes too far, alone, or with the others, is beyond.
  CHECK(made(block, cavity, 0, -4.9).volume == Approx(24000 - 39.8 * 29.8 * 19.8).epsilon(1e-9));
  CHECK_THROWS_AS(made(block, cavity, 0, -7), io::NoCadModel);
  CHECK_THROWS_AS(made(block, outside, 0, -7), io::NoCadModel);
  CHECK_THROWS_AS(made(block, on_plane(block, 2, 15), -3, -2.8), io::NoCadModel);
  const double third = 4 * std::numbers::pi / 3;
  CHECK(made(ball, inner, 0, 1).volume == Approx(third * (1000 - 343)).epsilon(1e-6));
  CHECK(made(ball, inner, -1, 0).volume == Approx(third * (729 - 512)).epsilon(1e-6));
  for (const double distance : {-3.0, -6.0}) {
    CHECK_THROWS_AS(made(ball, inner, 0, distance), io::NoCadModel);
    CHECK_THROWS_AS(made(ball, inner, distance, 0), io::NoCadModel);
  }
}

TEST_CASE("cad uneven: an expression that has no value is told", "[cad]") {
  const io::MeshFile patch = model("patch.brep");
  io::CadDistances distances(0);
  distances.each[0].expression.emplace("1/(u - 0.5)^0.5");
  distances.scale = 1;
  try {
    io::write_cad(place_of("none.brep"), patch, distances, {});
    FAIL("nothing was told");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("expected a finite number") != std::string::npos);
  }
}

TEST_CASE("cad thick: the solid between a model and its offset", "[cad]") {
  const io::MeshFile block = model("block.step");
  const double volume = (40 * 30 - 25 * std::numbers::pi - 16 * (1 - std::numbers::pi / 4)) * 20;
  for (const double distance : {0.5, -0.5}) {
    const CadFileFacts offset = io::write_cad(place_of("offset.step"), block, distance, {});
    io::CadWriting how;
    how.thick = true;
    const CadFileFacts thick = io::write_cad(place_of("thick.step"), block, distance, {}, how);
    CHECK(thick.made == Made::Solid);
    CHECK(thick.gaps.empty());
    CHECK(thick.volume == Approx(std::abs(offset.volume - volume)).epsilon(1e-9));
    const io::MeshFile again = model("thick.step");
    CHECK(again.polygons.face_count() > block.polygons.face_count());
    CHECK(io::read_materials(again).names.size() == io::read_materials(block).names.size());
  }
}
