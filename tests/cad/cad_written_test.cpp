// SPDX-License-Identifier: Apache-2.0
// CAD models that are written, as they are read again, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "cad/cad_files.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using Made = CadFileFacts::Made;

namespace {

struct Written {
  CadFileFacts facts;
  io::MeshFile source, again;
  OffsetResult result;
};

std::string path_of(const std::string& name) { return (test::cad_files().folder() / name).string(); }

/// Offsets a model as the command does, and reads what was written.
Written write(const std::string& name, double distance, const std::string& output, const io::CadWriting& how = {}) {
  REQUIRE(test::cad_files().is_made());
  io::ReadOptions reading;
  reading.cad.deflection = 0.01;
  Written written{{}, io::read_mesh(path_of(name), reading), {}, {}};
  OffsetOptions options;
  options.distance = Distances(distance);
  options.corners = Corners::Miter;
  options.exact = written.source.exact.get();
  written.result = offset(written.source.polygons.view(), options);
  written.facts = io::write_cad(path_of(output), written.source, distance, written.result.positions, how);
  written.again = io::read_mesh(path_of(output), reading);
  return written;
}

double volume_of_mesh(const Polygons& mesh) {
  double six = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    six += mesh.positions[face[0]].dot(mesh.positions[face[1]].cross(mesh.positions[face[2]]));
  }
  return six / 6;
}

/// A block of 40 by 30 by 20 with an upright hole of radius 5 and a fillet of radius 4, all moved by a distance.
double volume_of_block(double d) {
  const double fillet = std::max(0.0, 4 + d), hole = 5 - d;
  return ((40 + 2 * d) * (30 + 2 * d) - std::numbers::pi * hole * hole - fillet * fillet * (1 - std::numbers::pi / 4)) *
         (20 + 2 * d);
}

}  // namespace

TEST_CASE("cad written: a block stays what it is, outward and inward", "[cad]") {
  for (const double distance : {0.5, -0.5}) {
    const Written written = write("block.step", distance, "moved.step");
    CHECK(written.facts.made == Made::Solid);
    CHECK(written.facts.kept == 8);
    CHECK(written.facts.fitted == 0);
    CHECK(written.facts.gaps.empty());
    CHECK(written.again.unit_micrometres == 1000.0);
    CHECK(io::read_materials(written.again).of_face == io::read_materials(written.source).of_face);
    CHECK(written.facts.volume == Approx(volume_of_block(distance)).epsilon(1e-3));
    CHECK(volume_of_mesh(written.again.polygons) == Approx(volume_of_block(distance)).epsilon(1e-3));
    CHECK(volume_of_mesh(written.again.polygons) ==
          Approx(volume_of_mesh(
                     {written.result.positions, written.source.polygons.corners, written.source.polygons.face_begin}))
              .epsilon(1e-3));
  }
}

TEST_CASE("cad written: above the apex of a cone, its other half is not what a point is near to", "[cad][long]") {
  const double distance = GENERATE(20.0, 8.24621, -20.0), sine = 1 / std::sqrt(10.0);  // of half the angle at the apex
  const Written written = write("sharp_cone.brep", distance, "sharp_cone_out.brep");
  CHECK(written.facts.made == Made::Solid);
  const double height = 300 + distance + distance / sine, radius = height / 3;
  CHECK(written.facts.volume == Approx(std::numbers::pi / 3 * radius * radius * height).epsilon(1e-3));
}

TEST_CASE("cad written: a fillet that the distance swallows is gone, and its neighbours meet", "[cad]") {
  const Written written = write("block.step", -4.5, "swallowed.brep");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.kept == 7);
  CHECK(written.facts.swallowed == 1);
  CHECK(volume_of_mesh(written.again.polygons) == Approx(volume_of_block(-4.5)).epsilon(2e-3));
}

TEST_CASE("cad written: points of a face are at the distance from the face that it comes of", "[cad][long]") {
  for (const char* const name : {"sphere.brep", "cone.brep", "torus.brep"}) {
    INFO(name);
    const Written written = write(name, 0.25, "round.step");
    CHECK(written.facts.made == Made::Solid);
    const auto& points = written.again.polygons.positions;
    // Each point is near the one of the source whose offset it is: its own closest.
    const std::vector<double> distances(points.size(), 0.25);
    std::vector<std::uint32_t> faces(points.size(), 0);
    std::vector<Vec3d> feet(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      double nearest = INFINITY;
      for (std::size_t f = 0; f < written.source.polygons.face_count(); ++f) {
        const auto face = written.source.polygons.view().face(f);
        const Vec3d centre = (written.source.polygons.positions[face[0]] + written.source.polygons.positions[face[1]] +
                              written.source.polygons.positions[face[2]]) /
                             3.0;
        if ((points[i] - centre).length() >= nearest) continue;
        nearest = (points[i] - centre).length();
        faces[i] = static_cast<std::uint32_t>(f);
        feet[i] = centre;
      }
    }
    std::size_t exact = 0;
    for (const double error : written.source.exact->distance_errors_near(faces, feet, distances, points))
      exact += error < 1e-9;
    CHECK(exact > points.size() * 9 / 10);  // all but those over sharp edges, which are farther from each face's end
  }
}

TEST_CASE("cad written: some faces go, and the others stay", "[cad]") {
  const io::MeshFile block = io::read_mesh(path_of("block.step"));
  // The top alone.
  io::CadWriting how;
  for (std::size_t f = 0; f < block.polygons.face_count(); ++f) {
    const auto face = block.polygons.view().face(f);
    how.only.push_back(
        std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return block.polygons.positions[v].z() == 20; }));
  }
  const CadFileFacts facts = io::write_cad(path_of("taller.step"), block, 2, block.polygons.positions, how);
  CHECK(facts.made == Made::Solid);
  CHECK(volume_of_mesh(io::read_mesh(path_of("taller.step")).polygons) ==
        Approx(volume_of_block(0) * 22 / 20).epsilon(2e-3));
}

TEST_CASE("cad written: a face that OpenCASCADE finds no triangles for goes with the others", "[cad]") {
  const Written written = write("missed_seam.brep", 1, "wider.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.kept == 3);
  const double low = 13 + std::numbers::sqrt2, high = 5 + std::numbers::sqrt2;
  CHECK(written.facts.volume ==
        Approx(std::numbers::pi * 8 / 3 * (low * low + low * high + high * high)).epsilon(1e-6));
}

TEST_CASE("cad written: a model in inches stays one", "[cad]") {
  const Written written = write("inch.stp", 0.1, "inch.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.volume == Approx(2.2 * 3.2 * 4.2));
  CHECK(written.again.unit_micrometres == 25400.0);
  CHECK(volume_of_mesh(written.again.polygons) == Approx(2.2 * 3.2 * 4.2));
  CHECK(write("metre.step", 0.1, "again.step").again.unit_micrometres == 1e6);
  CHECK(volume_of_mesh(write("inch.stp", 0.1, "inch.brep").again.polygons) == Approx(2.2 * 3.2 * 4.2));
}

TEST_CASE("cad written: bodies that get into each other are written each by itself, and reported", "[cad]") {
  const Written written = write("touching.step", 1, "into.step");
  CHECK(written.facts.made == Made::Solid);
  REQUIRE_FALSE(written.facts.gaps.empty());
  CHECK(written.facts.gaps.back() ==
        "bodies get into each other, and each is written by itself: --bodies fuse makes them one");
}

TEST_CASE("cad written: bosses that grow into each other become one", "[cad]") {
  // Cylinders of radius 5, 9 apart and 6 and 8 high, on a plate of 42 x 22 x 7: what both have counts once.
  const double both = 50 * std::acos(0.9) - 4.5 * std::sqrt(100 - 81);
  const double volume = 42 * 22 * 7 + std::numbers::pi * 25 * (6 + 8) - both * 6;
  const Written written = write("bosses.step", 1, "grown.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.gaps.empty());
  CHECK(written.facts.volume == Approx(volume).epsilon(1e-6));
  CHECK(volume_of_mesh(written.again.polygons) == Approx(volume).epsilon(1e-3));
}

TEST_CASE("cad written: a wall that the distance swallows opens a hole to the side", "[cad]") {
  // A hole of radius 4.75, its axis 4.25 inside of a side: a segment of it lies outside.
  const double r = 4.75, in = 4.25, segment = r * r * std::acos(in / r) - in * std::sqrt(r * r - in * in);
  const double volume = (38.5 * 18.5 - std::numbers::pi * r * r + segment) * 3.5;
  const Written written = write("hole_at_side.step", -0.75, "opened.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.volume == Approx(volume).epsilon(1e-6));
  CHECK(volume_of_mesh(written.again.polygons) == Approx(volume).epsilon(1e-3));
}

TEST_CASE("cad written: a groove that closes is gone from the floor that it shares with a wider one", "[cad]") {
  // Two grooves across each other, 2 and 10 wide, 4 deep into a block of 40 x 30 x 10: the narrow one closes.
  const Written written = write("grooves.step", 1.5, "closed.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.volume == Approx(43 * 33 * 13 - 7 * 33 * 4).epsilon(1e-6));
  CHECK(volume_of_mesh(written.again.polygons) == Approx(written.facts.volume).epsilon(1e-6));
}

TEST_CASE("cad written: walls of a hollow block are good to the last, and not when they are gone", "[cad][long]") {
  // Nearly all of each wall's sides lies over the miters of the other side.
  for (const double d : {-2.3, -2.4, -2.49}) {
    INFO(d);
    const Written written = write("hollow.step", d, "thin.step");
    CHECK(written.facts.made == Made::Solid);
    CHECK(
        written.facts.volume ==
        Approx((40 + 2 * d) * (30 + 2 * d) * (20 + 2 * d) - (30 - 2 * d) * (20 - 2 * d) * (10 - 2 * d)).epsilon(1e-6));
  }
  for (const double d : {-2.5, -2.51, -2.6}) {
    INFO(d);
    const Written gone = write("hollow.step", d, "gone.step");
    CHECK(gone.facts.made != Made::Solid);
    REQUIRE_FALSE(gone.facts.gaps.empty());
    CHECK_THAT(gone.facts.gaps.front(), Catch::Contains("walls are gone"));
  }
}

TEST_CASE("cad written: grooves and flanges of turned parts close, and what they part meets", "[cad][long]") {
  using std::numbers::pi;
  const auto cylinder = [](double radius, double height) { return pi * radius * radius * height; };
  for (const double d : {0.3, 0.75, 1.5}) {
    INFO(d);
    const double width = std::max(0.0, 1 - 2 * d), from = d < 0.5 ? 21 - d : 20 + d;
    const Written shaft = write("grooved.step", d, "closed_shaft.step");
    CHECK(shaft.facts.made == Made::Solid);
    CHECK(shaft.facts.volume == Approx(cylinder(10 + d, 20 + 2 * d) + cylinder(8 + d, width) +
                                       cylinder(9 + d, 60 + d - from - width) + cylinder(7 + d, width))
                                    .epsilon(1e-6));
    CHECK(volume_of_mesh(shaft.again.polygons) == Approx(shaft.facts.volume).epsilon(5e-3));
    const Written bore = write("bore.step", d, "closed_bore.step");
    CHECK(bore.facts.made == Made::Solid);
    CHECK(bore.facts.volume ==
          Approx(cylinder(20 + d, 30 + 2 * d) - cylinder(5 - d, 30 + 2 * d - width) - cylinder(7 - d, width))
              .epsilon(1e-6));
  }
  for (const double d : {0.3, 0.75, 1.5}) {
    INFO(-d);
    const double width = std::max(0.0, 1 - 2 * d), from = d < 0.5 ? 11 - d : 10 + d;
    const Written flange = write("flange.step", -d, "no_flange.step");
    CHECK(flange.facts.made == Made::Solid);
    CHECK(flange.facts.volume ==
          Approx(cylinder(5 - d, 10) + cylinder(9 - d, width) + cylinder(6 - d, 20 - d - from)).epsilon(1e-6));
  }
}

TEST_CASE("cad written: edges within a plane or a cylinder lead to where its faces meet others", "[cad][long]") {
  for (const double d : {0.25, 1.0, 2.5, -0.25, -1.0, -1.75}) {
    INFO(d);
    const double side = 10 + 2 * d, radius = 6 + d, x = 0.5 - d;
    const double segment = radius * radius * std::acos(x / radius) - x * std::sqrt(radius * radius - x * x);
    const auto check = [&](const char* const name, double volume, bool keeps_vertices) {
      INFO(name);
      const Written written = write(name, d, "within.step");
      CHECK(written.facts.made == Made::Solid);
      CHECK(written.facts.gaps.empty());
      CHECK(written.facts.swallowed == 0);
      CHECK(written.facts.volume == Approx(volume).epsilon(1e-6));
      CHECK(volume_of_mesh(written.again.polygons) == Approx(volume).epsilon(5e-3));
      // Borders that go to and fro would have more of them.
      if (keeps_vertices) CHECK(written.again.polygons.positions.size() == written.source.polygons.positions.size());
    };
    check("steps.step", side * side * side + 10 * side * (6 + 2 * d), d > 0);
    check("tee.step", (20 + 2 * d) * side * (5 + 2 * d) + (7 + 2 * d) * side * 4, d > 0);
    check("towers.step", side * side * side + 10 * side * (8 + 2 * d) + 10 * side * (6 + 2 * d) + 100 * (4 + 2 * d),
          false);
    check("cut_cylinder.step", std::numbers::pi * radius * radius * (5 + 2 * d) + 4 * segment, false);
  }
}

TEST_CASE("cad written: what is placed has its names again", "[cad]") {
  const Written written = write("robot.step", 0.25, "robots.step");
  CHECK(written.facts.made == Made::Solid);
  const auto source = test::open_cad("robot.step").take_mesh(), again = test::open_cad("robots.step").take_mesh();
  REQUIRE(again.faces.size() == source.faces.size());
  for (std::size_t f = 0; f < source.faces.size(); ++f) {
    INFO(f);
    CHECK(again.faces[f].name == source.faces[f].name);
    CHECK(again.faces[f].solid == source.faces[f].solid);
    CHECK(again.faces[f].instance == source.faces[f].instance);
    REQUIRE(again.faces[f].colour);
    for (std::size_t k = 0; k < 3; ++k) CHECK((*again.faces[f].colour)[k] == Approx((*source.faces[f].colour)[k]));
    for (const char* const name : {"robot", "arm", f < 24 ? "left arm" : "right arm"})
      CHECK(std::count(again.faces[f].within.begin(), again.faces[f].within.end(), name) == 1);
  }
}

TEST_CASE("cad written: what falls apart is two solids", "[cad]") {
  // Two halves of a plate, that hang together by walls of 1 beside a hole of 9.
  const double r = 9.75, wide = 9.25;
  const double hole = 2 * (wide * std::sqrt(r * r - wide * wide) + r * r * std::asin(wide / r));
  const Written written = write("waist.step", -0.75, "apart.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.volume == Approx((38.5 * 18.5 - hole) * 3.5).epsilon(1e-6));
  CHECK(volume_of_mesh(written.again.polygons) == Approx(written.facts.volume).epsilon(1e-3));
}

TEST_CASE("cad written: a trimming curve that leads past its edge is mended", "[cad]") {
  // The pit is a cone that is 3.75 wide where it is 2.25 deep; its tip goes up by the distance over the sine of its
  // angle.
  const double d = 0.9, deep = 2.25 + d - d * std::hypot(3.75, 2.25) / 3.75, wide = deep * 3.75 / 2.25;
  const Written written = write("pit.brep", d, "pit.step");
  CHECK(written.facts.made == Made::Solid);
  CHECK(written.facts.volume == Approx(21.8 * 21.8 * 10.05 - std::numbers::pi * wide * wide * deep / 3).epsilon(1e-5));
}

TEST_CASE("cad written: what cannot be is told in a line", "[cad]") {
  io::MeshFile mesh = io::parse_mesh("a.obj", io::Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK_THROWS_WITH(io::write_cad(path_of("no.step"), mesh, 1, mesh.polygons.positions),
                    Catch::Contains("expected an input that is a CAD model, for an output that is one, got a.obj"));
  const io::MeshFile block = io::read_mesh(path_of("block.step"));
  io::CadWriting some;
  some.only.assign(block.polygons.face_count(), 0);
  some.only[0] = 1;
  CHECK_THROWS_WITH(
      io::write_cad(path_of("no.step"), block, 1, block.polygons.positions, some),
      Catch::Contains("no.step: expected whole faces of a CAD model to be offset alike, got a part of face "));
  CHECK_FALSE(std::filesystem::exists(path_of("no.step")));
}
