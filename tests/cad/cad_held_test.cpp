// SPDX-License-Identifier: Apache-2.0
// CAD models whose faces are held back where fronts meet, against closed forms.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "cad/cad_files.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/polygons.h"

using namespace vdb_offset;
using Made = CadFileFacts::Made;

namespace {

std::string place_for(const std::string& name) { return (test::cad_files().folder() / name).string(); }

io::MeshFile model_of(const std::string& name) {
  REQUIRE(test::cad_files().is_made());
  io::ReadOptions reading;
  reading.cad.deflection = 0.01;
  return io::read_mesh(place_for(name), reading);
}

io::CadWriting held() {
  io::CadWriting how;
  how.holds_back = true;
  return how;
}

/// A closed box.
Polygons box(const Vec3d& least, const Vec3d& most) {
  Polygons made;
  for (int corner = 0; corner < 8; ++corner)
    made.positions.emplace_back((corner & 1) != 0 ? most.x() : least.x(), (corner & 2) != 0 ? most.y() : least.y(),
                                (corner & 4) != 0 ? most.z() : least.z());
  made.add_face({0, 2, 3, 1});
  made.add_face({4, 5, 7, 6});
  made.add_face({0, 1, 5, 4});
  made.add_face({2, 6, 7, 3});
  made.add_face({0, 4, 6, 2});
  made.add_face({1, 3, 7, 5});
  return made;
}

}  // namespace

TEST_CASE("cad held: the walls of a narrow groove stop before they meet, and stay planes", "[cad][long]") {
  const io::MeshFile grooves = model_of("grooves.step");
  for (const double d : {1.4, 2.5}) {
    const CadFileFacts facts = io::write_cad(place_for("grooves_held.step"), grooves, d, {}, held());
    CHECK(facts.made == Made::Solid);
    CHECK(facts.kept == 22);
    CHECK(facts.held == 4);
    // Half of its width of 2, less the margin; the groove across, 10 wide, goes as far as is asked.
    const double wall = facts.least_held * d;
    CHECK(wall > 0.95);
    CHECK(wall < 1);
    const double outer = (40 + 2 * d) * (30 + 2 * d) * (10 + 2 * d), wide = (10 - 2 * d) * (30 + 2 * d) * 4,
                 narrow = (2 - 2 * wall) * (40 + 2 * d - (10 - 2 * d)) * 4;
    CHECK(facts.volume == Approx(outer - wide - narrow).epsilon(1e-9));
  }
}

TEST_CASE("cad held: a bore that the distance would close stays a cylinder", "[cad]") {
  const CadFileFacts facts = io::write_cad(place_for("bore_held.step"), model_of("block.step"), 7, {}, held());
  CHECK(facts.made == Made::Solid);
  CHECK(facts.kept == 8);
  CHECK(facts.held == 1);
  const double bore = 5 - facts.least_held * 7, round = 4 + 7;
  CHECK(bore > 0);
  CHECK(bore < 0.5);
  const double across =
      (40 + 14) * (30 + 14) - round * round * (1 - std::numbers::pi / 4) - std::numbers::pi * bore * bore;
  CHECK(facts.volume == Approx(across * (20 + 14)).epsilon(1e-9));
}

TEST_CASE("cad held: bosses that grow towards each other stop before the plane between them", "[cad][long]") {
  const io::MeshFile bosses = model_of("bosses.step");
  for (const double d : {1.6, 3.0}) {
    const CadFileFacts facts = io::write_cad(place_for("bosses_held.step"), bosses, d, {}, held());
    REQUIRE(facts.made == Made::Solid);
    CHECK(facts.held == 2);
    CHECK(facts.least == Approx(1).margin(1e-2));
    CHECK(facts.most == Approx(1).margin(1e-2));
    const io::MeshFile again = model_of("bosses_held.step");
    double left = 0, right = 40;  // how far the two bosses reach, above the plate and below the lower one's top
    double leftmost = 40, highest = 0;
    for (const Vec3d& at : again.polygons.positions) {
      highest = std::max(highest, at.z());
      if (at.z() < 5.5 + d || at.z() > 10.5) continue;
      leftmost = std::min(leftmost, at.x());
      if (at.x() < 20) left = std::max(left, at.x());
      else right = std::min(right, at.x());
    }
    CHECK(left < 20);
    CHECK(left > 19.8);
    CHECK(right > 20);
    CHECK(right < 20.2);
    // Away from each other they go all the way.
    CHECK(leftmost == Approx(11.5 - d).margin(0.02));
    CHECK(highest == Approx(13 + d).margin(0.02));
  }
}

TEST_CASE("cad held: walls that the distance would break through hold, where cut faces leave two solids",
          "[cad][long]") {
  const io::MeshFile waist = model_of("waist.step");
  CHECK(io::write_cad(place_for("waist_cut.step"), waist, -0.8, {}).made == Made::Solid);
  const CadFileFacts facts = io::write_cad(place_for("waist_held.step"), waist, -0.8, {}, held());
  CHECK(facts.made == Made::Solid);
  CHECK(facts.held == 3);
  CHECK(facts.swallowed == 0);
}

TEST_CASE("cad held: what holds a face goes on across its smooth edges", "[cad]") {
  const io::MeshFile plate = model_of("halves_at_side.step");
  const CadFileFacts facts = io::write_cad(place_for("halves_held.step"), plate, -1, {}, held());
  CHECK(facts.made == Made::Solid);
  // The half at the side, the side, and the other half, as far as it is joined to the first.
  CHECK(facts.held == 3);
  CHECK(facts.kept == 5);
  CHECK(facts.fitted == 3);
  CHECK(facts.least == Approx(1).margin(1e-2));
  CHECK(facts.most == Approx(1).margin(1e-2));
}

TEST_CASE("cad held: bodies that touch stay where they touch", "[cad]") {
  const io::MeshFile touching = model_of("touching.step");
  const CadFileFacts facts = io::write_cad(place_for("touching_held.step"), touching, 0.1, {}, held());
  CHECK(facts.made == Made::Solid);
  CHECK(facts.held == 2);
  CHECK(facts.least_held == 0);
  CHECK(facts.volume == Approx(2 * 1.1 * 1.2 * 1.2).epsilon(1e-9));
}

TEST_CASE("cad held: faces keep clear of an obstacle, and go all the way beside it", "[cad][long]") {
  const io::MeshFile block = model_of("block.step");
  const Polygons obstacle = box(Vec3d(28, 20, 21.5), Vec3d(32, 24, 30));
  for (const double clearance : {0.0, 0.5}) {
    io::CadWriting how = held();
    how.obstacles = obstacle.view();
    how.clearance = clearance;
    const CadFileFacts facts = io::write_cad(place_for("block_clear.step"), block, 3, {}, how);
    REQUIRE(facts.made == Made::Solid);
    CHECK(facts.kept == 7);
    CHECK(facts.held == 1);
    const io::MeshFile again = model_of("block_clear.step");
    double gap = 30, highest_below = 0, highest = 0;
    for (const Vec3d& at : again.polygons.positions) {
      highest = std::max(highest, at.z());
      Vec3d away(0, 0, 0);
      for (int k = 0; k < 3; ++k)
        away[k] = std::max({obstacle.positions[0][k] - at[k], at[k] - obstacle.positions[7][k], 0.0});
      gap = std::min(gap, away.length());
      if (away.x() == 0 && away.y() == 0) highest_below = std::max(highest_below, at.z());
    }
    CHECK(gap > clearance);
    REQUIRE(facts.obstacle_gap);
    CHECK(*facts.obstacle_gap == Approx(gap).margin(0.03));
    // The way of 3 is rounded down to 64ths, less 2 %.
    CHECK(highest_below > 21.5 - clearance - 0.1);
    CHECK(highest == Approx(23).margin(1e-9));
  }
}

TEST_CASE("cad held: what an obstacle is in the way of is never called whole", "[cad][long]") {
  const io::MeshFile block = model_of("block.step");
  // One that is met, beside a triangle without area.
  Polygons met = box(Vec3d(28, 20, 21.5), Vec3d(32, 24, 30));
  met.add_face({0, 0, 3});
  io::CadWriting how = held();
  how.obstacles = met.view();
  const CadFileFacts facts = io::write_cad(place_for("met.step"), block, 3, {}, how);
  CHECK(facts.made == Made::Solid);
  CHECK(facts.held == 1);
  CHECK(facts.least_held < 0.5);
  // One that lies between the points that are looked at: the result would enclose it.
  const Polygons small = box(Vec3d(30, 22, 25), Vec3d(30.02, 22.02, 25.02));
  how.obstacles = small.view();
  CHECK_THROWS_AS(io::write_cad(place_for("enclosed.step"), block, 12, {}, how), io::NoCadModel);
  // One that only a mitered edge comes near to.
  const Polygons at_edge = box(Vec3d(43.05, 33.05, 5), Vec3d(50, 50, 15));
  how.obstacles = at_edge.view();
  how.clearance = 0.5;
  CHECK_THROWS_AS(io::write_cad(place_for("at_edge.step"), block, 3, {}, how), io::NoCadModel);
  how.clearance = 0;
  CHECK(io::write_cad(place_for("beside_edge.step"), block, 3, {}, how).made == Made::Solid);
}

TEST_CASE("cad held: where nothing meets, the result is the one that is cut", "[cad]") {
  const io::MeshFile block = model_of("block.step");
  const CadFileFacts facts = io::write_cad(place_for("block_free.step"), block, 1.5, {}, held());
  const CadFileFacts cut = io::write_cad(place_for("block_cut.step"), block, 1.5, {});
  CHECK(facts.made == Made::Solid);
  CHECK(facts.held == 0);
  CHECK(facts.samples == cut.samples);
  CHECK(facts.volume == cut.volume);
}
