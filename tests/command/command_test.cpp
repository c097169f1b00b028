// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <thread>

#include "command/shell_command.h"
#include "space/surface/surface.h"
#include "support/dxf_text.h"
#include "support/places.h"
#include "support/solids.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
namespace fs = std::filesystem;

TEST_CASE("command: a warning names what is inside out, and the option that enlarges it", "[command]") {
  const ShellCommand shell;
  Polygons sphere = shapes::icosphere(1, 3);
  std::reverse(sphere.corners.begin(), sphere.corners.end());
  io::write_mesh(shell.file("reversed.obj"), sphere.view());
  const auto least_radius = [&](const std::string& name) {
    double least = 1e300;
    for (const Vec3d& p : io::read_mesh(shell.file(name)).polygons.positions) least = std::min(least, p.length());
    return least;
  };
  const Run keep = shell("reversed.obj keep.obj -d 0.1 --report keep.json");
  CHECK(keep.code == 0);
  CHECK_THAT(
      keep.out,
      Catch::Contains("warning: the mesh is inside out: positive distances shrink it. To enlarge it: --orient fix"));
  CHECK(least_radius("keep.obj") < 0.91);
  const Run fixed = shell("reversed.obj fixed.obj -d 0.1 -v --orient fix-direction-only --report fixed.json");
  CHECK_THAT(fixed.out, Catch::Contains("treated as flipped"));
  CHECK(least_radius("fixed.obj") > 1.09);
  CHECK(io::read_mesh(shell.file("fixed.obj")).polygons.corners == sphere.corners);
  for (const std::string name : {"keep", "fixed"}) {
    const auto report = nlohmann::json::parse(shell.slurp(shell.file(name + ".json")));
    CHECK(report["mesh"]["closed_components"] == 1);
    CHECK(report["mesh"]["inside_out_components"] == 1);
    CHECK(report["options"]["orient"] == (name == "keep" ? "keep" : "fix-direction-only"));
    CHECK(report["mesh"]["largest_inside_out"]["vertices"] == 642);
  }
  // What the run says is in the report, too.
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("keep.json")));
  const std::string verdict = report["verdict"];
  CHECK_THAT(keep.out, Catch::StartsWith(verdict + " ("));
  CHECK(report["warnings"][0]["kind"] == "wrong");
  CHECK_THAT(keep.out, Catch::Contains("\nwarning: " + report["warnings"][0]["text"].get<std::string>() + "\n"));
  CHECK(report["notes"].is_array());
  CHECK(shell("check reversed.obj fixed.obj -d 0.1 --orient fix-direction-only --strict").code == 0);
  CHECK(shell("check reversed.obj fixed.obj -d 0.1").code == 3);
  CHECK(shell("check reversed.obj keep.obj -d 0.1 --strict").code == 0);
  CHECK_THAT(shell("sphere.obj out.obj -d 0.1").out, !Catch::Contains("inward"));
  // A cavity whose faces point outward grows by a distance above 0, unless it is told to be one.
  Polygons hollow = shapes::icosphere(1, 3), cavity = shapes::icosphere(0.5, 3);
  const auto first = static_cast<std::uint32_t>(hollow.positions.size());
  hollow.positions.insert(hollow.positions.end(), cavity.positions.begin(), cavity.positions.end());
  for (std::size_t f = 0; f < cavity.face_count(); ++f) {
    const auto face = cavity.view().face(f);
    hollow.add_face({first + face[0], first + face[1], first + face[2]});
  }
  io::write_mesh(shell.file("hollow.obj"), hollow.view());
  CHECK_THAT(shell("hollow.obj kept.obj -d 0.1").out, Catch::Contains("--orient fix-cavities"));
  CHECK(least_radius("kept.obj") > 0.55);
  const Run shrunk = shell("hollow.obj shrunk.obj -d 0.1 -v --orient fix-cavities");
  CHECK_THAT(
      shrunk.out,
      Catch::Contains("one of 2 closed pieces (642 vertices, 1.73 across, around 0 0 0) is inside out: treated as"));
  CHECK(least_radius("shrunk.obj") < 0.41);
  CHECK(shell("check hollow.obj shrunk.obj -d 0.1 --orient fix-cavities --strict").code == 0);
  const Run wrong = shell("sphere.obj out2.obj -d 0.1 --orient outward");
  CHECK(wrong.code == 1);
  CHECK_THAT(wrong.err, Catch::Contains("'keep', 'fix-direction-only' or 'fix-cavities'"));
}

namespace {

/// A mesh without the faces that lie across an axis at one of its ends, or at both; turned round, if so told.
Polygons opened(const Polygons& whole, std::size_t axis, bool at_both, bool turned) {
  double least = 1e300, most = -1e300;
  for (const Vec3d& p : whole.positions) {
    least = std::min(least, p[static_cast<int>(axis)]);
    most = std::max(most, p[static_cast<int>(axis)]);
  }
  Polygons mesh;
  mesh.positions = whole.positions;
  for (std::size_t f = 0; f < whole.face_count(); ++f) {
    std::vector<std::uint32_t> face(whole.view().face(f).begin(), whole.view().face(f).end());
    const auto all_at = [&](double end) {
      return std::all_of(face.begin(), face.end(),
                         [&](auto v) { return whole.positions[v][static_cast<int>(axis)] == end; });
    };
    if (all_at(least) || (at_both && all_at(most))) continue;
    if (turned) std::reverse(face.begin(), face.end());
    mesh.corners.insert(mesh.corners.end(), face.begin(), face.end());
    mesh.close_face();
  }
  return mesh;
}

}  // namespace

TEST_CASE("command: layers that end on the wrong side of an open surface: a warning names the option that turns them",
          "[command][layers][long]") {
  const ShellCommand shell;
  const std::string hint = "If faces point the wrong way: ";
  const auto coverage = [&] {
    return nlohmann::json::parse(shell.slurp(shell.file("r.json")))["layers"]["coverage"].get<double>();
  };
  const Polygons tube = shapes::cylinder(1, 3, 40, 10, 1), wing = shapes::naca_wing("0012", 1, 1, 60, 20);
  for (const std::string name : {"tube", "wing"}) {
    INFO(name);
    const bool is_tube = name == "tube";
    for (const bool turned : {false, true})
      io::write_mesh(shell.file(name + (turned ? "_in.obj" : "_out.obj")),
                     opened(is_tube ? tube : wing, is_tube ? 2 : 1, is_tube, turned).view());
    // As thick as there is no room for inside.
    const std::string thickness = is_tube ? "1.5" : "0.1";
    const std::string to = " o.vtu --report r.json --layers 4 ", total = "--total-thickness " + thickness;
    // No other warning asks for a smaller distance.
    CHECK_THAT(shell(name + "_in.obj" + to + total).out,
               Catch::Contains(hint + "--total-thickness -" + thickness) && !Catch::Contains("smaller distance"));
    CHECK(coverage() < 0.5);
    // That option does it, and the warning is gone; nor is there one where faces point outward.
    for (const std::string& arguments : {"_in.obj" + to + "--total-thickness -" + thickness, "_out.obj" + to + total}) {
      CHECK_THAT(shell(name + arguments).out, !Catch::Contains(hint));
      CHECK(coverage() > 0.99);
    }
    CHECK_THAT(shell(name + "_out.obj" + to + "--total-thickness -" + thickness).out,
               Catch::Contains(hint + "--total-thickness " + thickness));
    // Inward is what was meant, where there is room.
    CHECK_THAT(shell(name + "_in.obj" + to + "--total-thickness 0.001").out, !Catch::Contains(hint));
  }
  CHECK_THAT(shell("tube_in.obj o.vtu --layers 4 --first-height 0.4").out,
             Catch::Contains(hint + "--first-height -0.4"));
  std::ofstream(shell.file("heights.txt")) << "0.5\n1.5\n";
  CHECK_THAT(shell("tube_in.obj o.vtu --heights heights.txt").out, Catch::Contains(hint + "use heights below 0"));
}

TEST_CASE("command: distances of each vertex, as an expression and from files", "[command]") {
  const ShellCommand shell;
  const auto radii = [&](const std::string& name) {
    std::vector<double> r;
    for (const Vec3d& p : io::read_mesh(shell.file(name)).polygons.positions) r.push_back(p.length());
    return r;
  };
  const Polygons sphere = io::read_mesh(shell.file("sphere.obj")).polygons;
  CHECK(shell("sphere.obj a.obj -d '0.1*(1 + nz)' --report a.json --states a.csv").code == 0);
  std::ofstream numbers(shell.file("numbers.txt"));
  numbers.precision(17);
  for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
    const double asked = 0.1 * (1 + sphere.positions[v][2]);
    CHECK(radii("a.obj")[v] == Approx(1 + asked).epsilon(0.002));
    numbers << asked << "\n";
  }
  numbers.close();
  CHECK(shell("sphere.obj b.obj --distance-from numbers.txt").code == 0);
  CHECK(radii("b.obj").front() == Approx(radii("a.obj").front()).epsilon(1e-3));
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("a.json")));
  CHECK(report["achieved"]["share_reached"] == 1);
  CHECK(report["achieved"]["asked"]["most"].get<double>() == Approx(0.2).epsilon(0.01));
  CHECK(report["distance_as_given"] == "0.1*(1 + nz)");
  CHECK_THAT(shell.slurp(shell.file("a.csv")), Catch::Contains("reached"));
  check_failure(shell, "sphere.obj c.obj -d '0.1*foo'", 1, "column 5");
  check_failure(shell, "sphere.obj c.obj -d '0.1*(1'", 1, "column");
  check_failure(shell, "sphere.obj c.obj -d 'sqrt(z)'", 2, "vertex");
  check_failure(shell, "sphere.obj c.obj -d 'u'", 2, "texture coordinates");
  check_failure(shell, "sphere.obj c.obj --distance-from a.csv", 2, "a.csv");
  check_failure(shell, "sphere.obj c.obj --distance-from ply:thickness", 2, "sphere.obj");
  check_failure(shell, "sphere.obj c.obj -d 1 --distance-from numbers.txt", 1,
                "--distance-from and --distance exclude each other");
}

TEST_CASE("command: thickness by the surface's own parameters", "[command]") {
  const ShellCommand shell;
  std::ofstream file(shell.file("strip.obj"));
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 4; ++j) file << "v " << i << ' ' << j << " 0\n";
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 4; ++j) file << "vt " << i / 8.0 << ' ' << j / 4.0 << "\n";
  for (int i = 0; i < 8; ++i)
    for (int j = 1; j <= 4; ++j) {
      const int a = 5 * i + j;
      for (const int v : {a, a + 5, a + 6, a + 1}) file << (v == a ? "f " : " ") << v << '/' << v;
      file << "\n";
    }
  file.close();
  CHECK(shell("strip.obj out.obj -d '0.1 + 0.2*u*u'").code == 0);
  for (const Vec3d& p : io::read_mesh(shell.file("out.obj")).polygons.positions)
    CHECK(p[2] == Approx(0.1 + 0.2 * (p[0] / 8) * (p[0] / 8)));
}

TEST_CASE("command: a point says to which side a mesh is offset", "[command]") {
  ShellCommand shell;
  const auto radius = [&](const std::string& options) {
    const Run run = shell("sphere.obj out.obj " + options);
    INFO(run.err);
    CHECK(run.code == 0);
    return io::read_mesh(shell.file("out.obj")).polygons.positions[0].length();
  };
  CHECK(radius("-d 0.1 --side-of 0.1,0.2,0") == Approx(0.9).epsilon(0.01));
  CHECK(radius("-d 0.1 --side-of 0,0,-3") == Approx(1.1).epsilon(0.01));
  CHECK(shell("sphere.obj out.obj -d=-0.1 --side-of 0,0,0").code == 1);
  CHECK(shell("sphere.obj out.obj -d 0.1 --side-of 0,0").code == 1);
}

TEST_CASE("command: several distances, one output each", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 -d 0.2 -d -0.1 --report r.json").code == 0);
  for (const auto& [number, radius] : {std::pair{"001", 1.1}, {"002", 1.2}, {"003", 0.9}}) {
    const auto positions = io::read_mesh(shell.file("out_" + std::string(number) + ".obj")).polygons.positions;
    for (const Vec3d& p : positions) CHECK(p.length() == Approx(radius).epsilon(1e-3));
    CHECK(shell.has("r_" + std::string(number) + ".json"));
  }
  CHECK(shell("sphere.obj 'at_{d}_{i}.ply.gz' -d 1% -d 2%").code == 0);
  CHECK(shell.has("at_1%_001.ply.gz"));
  CHECK(shell.has("at_2%_002.ply.gz"));
  CHECK(shell("sphere.obj one.obj -d 0.1").code == 0);
  CHECK(shell.has("one.obj"));
  check_failure(shell, "sphere.obj 'same_{d}.obj' -d 0.1 -d 0.1", 1, "names that differ");
  check_failure(shell, "sphere.obj - --format obj -d 0.1 -d 0.2", 1, "for each distance");
}

TEST_CASE("command: parts, obstacles and shells", "[command]") {
  const ShellCommand shell;
  std::ofstream(shell.file("two.obj")) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                                          "g left\nf 1 2 3 4\ng right\nf 2 5 6 3\n";
  CHECK(shell("two.obj left.obj -d 0.1 --only group=left --border free").code == 0);
  const auto left = io::read_mesh(shell.file("left.obj")).polygons.positions;
  CHECK(left[0][2] == Approx(0.1));
  CHECK(left[1][2] == Approx(0.1));
  CHECK(left[4][2] == 0);
  CHECK(shell("two.obj fixed.obj -d 0.1 --only group=left --border fixed").code == 0);
  CHECK(io::read_mesh(shell.file("fixed.obj")).polygons.positions[1][2] == 0);
  check_failure(shell, "two.obj no.obj -d 0.1 --only group=top", 1, "left, right");
  check_failure(shell, "two.obj no.obj -d 0.1 --only top", 1, "group=NAME");
  check_failure(shell, "two.obj no.obj -d 0.1 --only holes", 1, "round holes");
  CHECK(shell("two.obj right.obj -d 0.1 --only not:group=left --border free").code == 0);
  CHECK(io::read_mesh(shell.file("right.obj")).polygons.positions[4][2] == Approx(0.1));
  CHECK(io::read_mesh(shell.file("right.obj")).polygons.positions[0][2] == 0);
  CHECK(shell("two.obj both.obj --distance-of group=left:0.1 --distance-of not:group=left:0.2").code == 0);
  CHECK(io::read_mesh(shell.file("both.obj")).polygons.positions[4][2] == Approx(0.2));
  check_failure(shell, "two.obj no.obj -d 0.1 --border round", 1, "'slide', 'fixed' or 'free'");

  Polygons lid = shapes::patch(6, 0, 2);
  for (Vec3d& p : lid.positions) p[2] += 1.2;
  io::write_mesh(shell.file("lid.obj"), lid.view());
  CHECK(shell("sphere.obj under.obj -d 0.5 --obstacle lid.obj --clearance 0.05").code == 0);
  double highest = 0;
  for (const Vec3d& p : io::read_mesh(shell.file("under.obj")).polygons.positions) highest = std::max(highest, p[2]);
  CHECK(highest == Approx(1.15));
  check_failure(shell, "sphere.obj no.obj -d 0.5 --obstacle none.obj", 2, "none.obj");
  check_failure(shell, "sphere.obj no.obj -d 0.5 --clearance 0.1", 1, "--obstacle");
  check_failure(shell, "sphere.obj no.obj -d 0.5 --obstacle lid.obj --clearance -1", 1, "0 or more");

  const Run solid = shell("sphere.obj solid.obj -d 0.1 --inner 0.2 --shell --report solid.json");
  CHECK(solid.code == 0);
  CHECK_THAT(solid.out, Catch::Contains("shell closed, volume"));
  const auto facts = nlohmann::json::parse(shell.slurp(shell.file("solid.json")))["shell"];
  CHECK(facts["closed"] == true);
  CHECK(facts["crossings"] == 0);
  CHECK(facts["pinched_vertices"] == 0);
  CHECK(facts["volume"].get<double>() == Approx(4.18879 * (1.331 - 0.512)).epsilon(0.03));
  CHECK_THAT(shell.slurp(shell.file("solid.obj")), Catch::Contains("g outer") && Catch::Contains("g inner"));
  const Run open = shell("two.obj plate.obj -d -0.1 --shell -v");
  CHECK_THAT(open.out, Catch::Contains("volume 0.2 (") && Catch::Contains("rim of 6 quads"));
  check_failure(shell, "sphere.obj no.obj -d 0.1 --inner 0.1", 1, "--shell");
  check_failure(shell, "sphere.obj no.obj -d 0.1 --shell --inner -0.1", 1, "above 0");
}

TEST_CASE("command: 0 and an output when all is well", "[command]") {
  const ShellCommand shell;
  const Run run = shell("sphere.obj out.obj --distance 0.1");
  CHECK(run.code == 0);
  CHECK(run.err.empty());
  CHECK_THAT(run.out, Catch::Contains("100.000 % of 642 vertices reached it"));
  const io::MeshFile source = io::read_mesh(shell.file("sphere.obj")), out = io::read_mesh(shell.file("out.obj"));
  CHECK(out.polygons.corners == source.polygons.corners);
  CHECK(out.polygons.positions[0].length() == Approx(1.1).epsilon(1e-3));
  CHECK(shell.count() == 2);
  CHECK(shell("sphere.obj out.obj --distance=-1% --quiet").out.empty());
  CHECK(shell("sphere.obj sphere.obj -d -1% -q").code == 0);  // in place
}

TEST_CASE("command: all causes of a quarter or more of the faces' error are reported, the largest first", "[command]") {
  const ShellCommand shell;
  // A coarse ball beside a cube that is as large: the ball's faces are coarse, the cube's have corners.
  const auto warnings_of = [&](double radius, const std::string& options) {
    Polygons both = shapes::icosphere(radius, 1);
    const auto first = static_cast<std::uint32_t>(both.positions.size());
    const Polygons cube = shapes::box(Vec3d(1), 6, false);
    for (const Vec3d& p : cube.positions) both.positions.push_back(p + Vec3d(5, 0, 0));
    for (std::size_t f = 0; f < cube.face_count(); ++f) {
      for (const auto v : cube.view().face(f)) both.corners.push_back(first + v);
      both.close_face();
    }
    io::write_mesh(shell.file("both.obj"), both.view());
    const Run run = shell("both.obj out.obj -d 0.2 " + options);
    CHECK(run.code == 0);
    return run.out.substr(run.out.find('\n') + 1);
  };
  const std::string
      coarse = " % of the faces' error is between the vertices of large faces. To split these: --tolerance 1%\n",
      corners =
          " % of the faces' error is at sharp corners, where --corners round keeps the vertices at it. To split the "
          "faces there: --tolerance 1%\n";
  const std::string coarse_first = warnings_of(1, "--corners round"),
                    corners_first = warnings_of(0.8, "--corners round");
  CHECK(coarse_first.find(coarse) < coarse_first.find(corners));
  CHECK(coarse_first.find(corners) != std::string::npos);
  CHECK(corners_first.find(corners) < corners_first.find(coarse));
  CHECK(corners_first.find(coarse) != std::string::npos);
  CHECK(warnings_of(1, "") == "warning: 100" + coarse);
  CHECK(warnings_of(0.3, "--corners round").find(coarse) == std::string::npos);
}

TEST_CASE("command: --strict-faces judges layers and iso-surfaces as well", "[command][layers][capture]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("box.obj"), shapes::box(Vec3d(1), 4, false).view());
  std::ofstream(shell.file("square.txt")) << "0 0\n1 0\n1 1\n0 1\n0 0\n";
  for (const std::string input : {"box.obj", "square.txt"}) {
    const std::string layers = input + " out.vtu --layers 3 --first-height 0.02 ";
    const Run off = shell(layers + "--fan-angle 0 --strict-faces 1 --report off.json");
    CHECK(off.code == 3);
    CHECK_THAT(off.err, Catch::Contains("--strict-faces: out.vtu: 99 %") &&
                            Catch::Contains("--strict-faces: out.vtu at the first height: 99 %"));
    CHECK_THAT(off.out, Catch::Contains("error is at sharp corners. Use --corners miter"));
    const auto report = nlohmann::json::parse(shell.slurp(shell.file("off.json")));
    CHECK(report["faces"]["error_quantile_99"].get<double>() > 0.01);
    CHECK(report["faces_at_first_height"]["error_quantile_99"].get<double>() > 0.01);
    CHECK(shell(layers + "--strict-faces 1 --corners miter").code == 0);
  }
  const std::string iso = "sphere.obj out.obj --mode iso -d 0.3 ";
  const Run coarse = shell(iso + "--voxel-size 0.4 --strict-faces 1");
  CHECK(coarse.code == 3);
  CHECK_THAT(coarse.err, Catch::Contains("--strict-faces: out.obj: 99 %"));
  CHECK_THAT(coarse.out, Catch::Contains("% of the area is within 1 %") && Catch::Contains("a smaller --voxel-size"));
  const Run fine = shell(iso + "--voxel-size 0.04 --strict-faces 1");
  CHECK(fine.code == 0);
  CHECK_THAT(fine.out, !Catch::Contains("a smaller --voxel-size"));
}

TEST_CASE("command: help and version", "[command]") {
  const ShellCommand shell;
  const Run first = shell("--help");
  CHECK(first.code == 0);
  CHECK_THAT(first.out, Catch::Contains("--distance") && Catch::Contains("--preset") && !Catch::Contains("--solver"));
  CHECK_THAT(shell("--help run").out, Catch::Contains("--solver") && !Catch::Contains("--distance D"));
  CHECK_THAT(shell("check --help").out, Catch::Contains("--help accuracy") && !Catch::Contains("--help layers"));
  const Run help = shell("--help all");
  CHECK(help.code == 0);
  for (const char* word : {"--distance", "--voxel-size", "--voxels-per-distance", "--collision", "--solver", "--weld",
                           "--threads", "--max-memory", "--report", "--states", "--paths", "--save-vdb", "--strict",
                           "--dry-run", "--quiet", "--verbose", "Examples", "Exit codes"})
    CHECK_THAT(help.out, Catch::Contains(word));
  CHECK_THAT(shell("--version").out, Catch::StartsWith("vdb_offset "));
}

TEST_CASE("command: --states tells of every vertex", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 --states s.csv -q").code == 0);
  const std::string csv = shell.slurp(shell.file("s.csv"));
  const io::MeshFile source = io::read_mesh(shell.file("sphere.obj"));
  CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) == source.polygons.positions.size() + 1);
  CHECK_THAT(csv, Catch::StartsWith("vertex,state,target,achieved\n0,reached,0.1,0.1"));
  CHECK(shell("sphere.obj out.obj -d 0.1 --states s.ply -q").code == 0);
  const io::MeshFile coloured = io::read_mesh(shell.file("s.ply")), out = io::read_mesh(shell.file("out.obj"));
  CHECK(coloured.polygons.positions == out.polygons.positions);
  CHECK(coloured.polygons.corners == source.polygons.corners);
  check_failure(shell, "sphere.obj out2.obj -d 0.1 --states s.txt", 1, "s.txt");
  check_failure(shell, "sphere.obj out2.obj -d 0.1 --states out2.obj", 1, "out2.obj");
}

TEST_CASE("command: --paths draws a line for each vertex that moves", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 -d 0.2 --paths p.obj -q").code == 0);
  const io::MeshFile source = io::read_mesh(shell.file("sphere.obj")), out = io::read_mesh(shell.file("out_002.obj"));
  const Curves paths = io::read_curves(shell.file("p_002.obj")).file.polygons;
  const std::size_t count = source.polygons.positions.size();
  REQUIRE(paths.face_count() == count);
  for (std::size_t v = 0; v < count; ++v) {
    const auto path = paths.view().face(v);
    CHECK(paths.positions[path.front()] == source.polygons.positions[v]);
    CHECK(paths.positions[path.back()] == out.polygons.positions[v]);
  }
  CHECK(io::read_curves(shell.file("p_001.obj")).file.polygons.face_count() == count);
  check_failure(shell, "sphere.obj out2.obj -d 0.1 --paths p.ply", 1, "p.ply: expected a file of paths");
  check_failure(shell, "sphere.obj out2.obj -d 0.1 --paths out2.obj", 1, "file of its own");
  check_failure(shell, "sphere.obj out2.vtu --layers 2 --first-height 0.1 --paths p.obj", 1,
                "--paths and --layers exclude each other");
}

TEST_CASE("command: check measures any two meshes", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 -q").code == 0);
  const Run text = shell("check sphere.obj out.obj");
  CHECK(text.code == 0);
  CHECK_THAT(text.out, Catch::Contains("100.000 %") && Catch::Contains("0 inverted") && Catch::EndsWith("\nvalid\n"));
  const Run json = shell("check sphere.obj out.obj --distance 0.1 --json --report r.json");
  const auto found = nlohmann::json::parse(json.out);
  CHECK(found["valid"] == true);
  CHECK(found["distance"] == 0.1);
  CHECK(json.out == shell.slurp(shell.file("r.json")));
  CHECK(shell("check sphere.obj out.obj -d 0.2").code == 0);
  CHECK(shell("check sphere.obj out.obj -d 0.2 --strict").code == 3);
  CHECK(shell("check --help").code == 0);
  Polygons turned = io::read_mesh(shell.file("out.obj")).polygons;
  std::swap(turned.positions[turned.corners[0]], turned.positions[turned.corners[1]]);
  io::write_mesh(shell.file("bad.obj"), turned.view());
  CHECK(shell("check sphere.obj bad.obj").code == 3);
  io::write_mesh(shell.file("box.obj"), shapes::box(Vec3d(1), 2, true).view());
  // What is asked to stay in a plane and has left it is told, as is a plane on which nothing lies.
  CHECK(shell("check sphere.obj out.obj -d 0.1 --symmetry none").code == 0);
  CHECK(shell("box.obj moved.obj -d 0.1 --symmetry z=0.5 -q").code == 0);
  CHECK(shell("box.obj free.obj -d 0.1 -q").code == 0);
  CHECK(shell("check box.obj moved.obj -d 0.1 --symmetry z=0.5").code == 0);
  CHECK(shell("check box.obj free.obj -d 0.1").code == 0);
  CHECK_THAT(shell("check box.obj free.obj -d 0.1 --symmetry z=0.5").out,
             Catch::Contains("9 on the wrong side\n") && Catch::EndsWith("\nnot valid\n"));
  check_failure(shell, "check box.obj free.obj --symmetry z=7", 2, "symmetry: expected vertices on the plane");
  check_failure(shell, "check box.obj free.obj --symmetry up", 1, "--symmetry: expected 'x=0'");
  check_failure(shell, "check sphere.obj box.obj", 2, "box.obj");
  check_failure(shell, "check sphere.obj none.obj", 2, "none.obj");
  check_failure(shell, "check sphere.obj", 1, "OFFSET");
  check_failure(shell, "check sphere.obj out.obj -d 1x", 1, "'1x'");
}

TEST_CASE("command: behind -- names may start with a dash", "[command]") {
  const ShellCommand shell;
  fs::rename(shell.file("sphere.obj"), shell.file("-in.obj"));
  CHECK(shell("-d 0.1 -- -in.obj -out.obj").code == 0);
  CHECK(shell.has("-out.obj"));
  CHECK(shell("--distance=0.1 -q --report r.json -- -in.obj --out.ply").code == 0);
  CHECK(shell.has("--out.ply"));
  CHECK(shell("-d 0.1 -d 0.2 --obstacle far.obj -- -in.obj -o.obj").code == 2);  // it is not there
  CHECK(shell("-d 0.1 -d 0.2 --dry-run -- -in.obj -o.obj").code == 0);
  CHECK(shell("check --distance 0.1 --strict -- -in.obj -out.obj").code == 0);
  CHECK(shell("check -- -in.obj -out.obj").code == 0);
  CHECK(shell("-d 0.1 -- -in.obj").code == 1);
  CHECK(shell("-- -in.obj -out.obj -d 0.1").code == 1);  // two names too many
}

TEST_CASE("command: reports of names that are no UTF-8", "[command]") {
  const ShellCommand shell;
  const std::string name = "a\xff\xc3.obj";
  std::ofstream file(shell.file(name));
  file << "g sk\xe9\n";
  for (const Vec3d& p : shapes::box(Vec3d(1), 1, true).positions)
    file << "v " << p[0] << " " << p[1] << " " << p[2] << "\n";
  const Polygons box = shapes::box(Vec3d(1), 1, true);
  for (std::size_t f = 0; f < box.face_count(); ++f) {
    file << "f";
    for (const auto v : box.view().face(f)) file << " " << v + 1;
    file << "\n";
  }
  file.close();
  for (const std::string& run :
       {"'" + name + "' o\xff.obj -d 0.1", "'" + name + "' o.obj -d 0.1 --only 'group=sk\xe9'",
        "'" + name + "' i.ply -d 0.1 --mode iso --voxel-size 0.1",
        "'" + name + "' o.vtu --layers 2 --first-height 0.01", "check '" + name + "' '" + name + "'"}) {
    INFO(run);
    CHECK(shell(run + " --report r.json").code == 0);
    CHECK_NOTHROW(nlohmann::json::parse(shell.slurp(shell.file("r.json"))));
    fs::remove(shell.file("r.json"));
  }
}

TEST_CASE("command: seams that are closed, and those that look like it", "[command]") {
  const ShellCommand shell;
  const auto write = [&](const std::string& name, double gap) {
    Polygons box = shapes::box(Vec3d(1), 4, true);
    const auto first = static_cast<std::uint32_t>(box.positions.size());
    const Polygons whole = box;
    for (const Vec3d& p : whole.positions) box.positions.push_back(p + Vec3d(gap, -gap, gap));
    for (std::size_t c = box.corners.size() / 2 / 3 * 3; c < box.corners.size(); ++c) box.corners[c] += first;
    io::write_mesh(shell.file(name), box.view());
  };
  write("cracked.obj", 1e-13);
  const Run run = shell("cracked.obj o.obj -d 0.05 -v --report r.json");
  CHECK(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("boundary vertices were welded to others") && Catch::Contains("--weld exact"));
  const auto mesh = nlohmann::json::parse(shell.slurp(shell.file("r.json")))["mesh"];
  CHECK(mesh["seams"]["welded_vertices"] > 0);
  CHECK(mesh["seams"]["widest"].get<double>() < 2e-13);
  CHECK(mesh["closed"] == true);
  CHECK_THAT(shell("check cracked.obj o.obj").out, Catch::Contains("seams ") && Catch::EndsWith("\nvalid\n"));
  CHECK_THAT(shell("cracked.obj o.obj -d 0.05 -v --weld exact").out, !Catch::Contains("rounding"));
  CHECK_THAT(shell("cracked.obj i.obj -d -0.1 --mode iso --voxel-size 0.05 -v").out,
             Catch::Contains("closed, manifold") && Catch::Contains("were welded"));
  CHECK_THAT(shell("cracked.obj l.vtu --layers 2 --first-height 0.01 -v").out, Catch::Contains("were welded"));

  write("slit.obj", 1e-5);
  const Run slit = shell("slit.obj o.obj -d 0.05");
  CHECK_THAT(slit.out, Catch::Contains("face another boundary") && Catch::Contains("unintended: --weld 0.0001"));
  CHECK_THAT(shell("slit.obj o.obj -d 0.0001").out,
             !Catch::Contains("another boundary"));  // not far below the distance
  CHECK_THAT(shell("slit.obj o.obj -d 0.05 --weld 0.0001").out, !Catch::Contains("another boundary"));
  CHECK_THAT(shell("sphere.obj o.obj -d 0.05").out, !Catch::Contains("--weld"));
}

TEST_CASE("command: faces that name normals which are not there", "[command]") {
  const ShellCommand shell;
  std::ofstream(shell.file("a.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n";
  const Run run = shell("a.obj b.obj -d 0.1");
  CHECK(run.code == 0);
  CHECK_THAT(run.err, Catch::Contains("a.obj: faces name normals (as in f 1//1)"));
  CHECK(shell("a.obj b.obj -d 0.1 -q").err.empty());
}

TEST_CASE("command: 1 for wrong usage", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "", 1, "INPUT");
  check_failure(shell, "sphere.obj", 1, "OUTPUT");
  check_failure(shell, "sphere.obj out.obj", 1, "--distance");
  check_failure(shell, "sphere.obj out.obj --distance abc", 1, "'abc'");
  check_failure(shell, "sphere.obj out.obj --distance nan", 1, "'nan'");
  check_failure(shell, "sphere.obj out.xyz --distance 1", 1, "out.xyz");
  check_failure(shell, "sphere.xyz out.obj --distance 1", 1, "sphere.xyz");
  check_failure(shell, "sphere.obj out.obj --distance 1 --nonsense", 1, "--nonsense");
  check_failure(shell, "sphere.obj out.obj --distance 1 --voxel-size 0", 1, "--voxel-size");
  check_failure(shell, "sphere.obj out.obj --distance 1 --voxel-size 1 --voxels-per-distance 1", 1,
                "--voxel-size and --voxels-per-distance exclude each other");
  check_failure(shell, "sphere.obj out.obj --distance 1 --collision bounce", 1, "'bounce'");
  check_failure(shell, "sphere.obj out.obj --distance 1 --solver magic", 1, "'magic'");
  check_failure(shell, "sphere.obj out.obj --distance 1 --weld some", 1, "'some'");
  check_failure(shell, "sphere.obj out.obj --distance 1 --threads -1", 1, "--threads");
  check_failure(shell, "sphere.obj out.obj --distance 1 --max-memory lots", 1, "'lots'");
  check_failure(shell, "sphere.obj out.obj --distance 1 --quiet --verbose", 1,
                "--quiet and --verbose exclude each other");
  check_failure(shell, "sphere.obj out.obj --distance 1 --report sphere.obj", 1, "file of its own");
  check_failure(shell, "sphere.obj out.obj --distance 1 --save-vdb ./out.obj", 1, "file of its own");
  check_failure(shell, "sphere.obj out.obj --distance 0 --save-vdb f.vdb", 1, "other than 0");
}

TEST_CASE("command: what is misspelt or missing is named, with what is meant", "[command]") {
  const ShellCommand shell;
  const std::string in_out = "sphere.obj out.obj ";
  for (const auto& [arguments, message] :
       {std::pair{in_out, "missing --distance"},
        {in_out + "-d 1 --corner miter", "unknown option --corner; did you mean --corners?"},
        {in_out + "-d 1 --corner=miter", "unknown option --corner; did you mean --corners?"},
        {in_out + "--distnace 1", "unknown option --distnace; did you mean --distance?"},
        {in_out + "--dist 1", "unknown option --dist; did you mean --distance?"},
        {"--xyz", "unknown option --xyz (vdb_offset --help all lists the options)"},
        {in_out + "-d 1 -w", "unknown option -w (vdb_offset --help all lists the options)"},
        {in_out + "-d 1 more", "not expected: more"},
        {in_out + "-d 0.2 mm", "mm: expected the unit without a space, as in 0.2mm"},
        {in_out + "--offset 1", "unknown option --offset; did you mean --distance?"},
        {"--help corner", "the name of an option, got 'corner'; did you mean --help corners?"},
        {"--help nonsense", "--help: expected distances, accuracy, "},
        {"check sphere.obj sphere.obj --stric", "unknown option --stric; did you mean --strict?"},
        {"check sphere.obj sphere.obj --layers 1", "unknown option --layers (vdb_offset check --help all lists"},
        {"batch . out -d 1 --model x", "unknown option --model; did you mean --models?"},
        {"batch . out -d 1 --corner round", "unknown option --corner; did you mean --corners?"},
        {"bach in out --distance 1", "bach: no such file; did you mean vdb_offset batch?"},
        {"chek sphere.obj sphere.obj", "chek: no such file; did you mean vdb_offset check?"},
        {"cheque out.obj -d 1", "cheque: expected an input that ends in"}})
    check_failure(shell, arguments, 1, message);
  CHECK(shell("--distance-xyz --help").code == 0);
  CHECK_THAT(shell("--help -d").out, Catch::Contains("--distance D") && !Catch::Contains("--corners KIND"));
  CHECK(shell(in_out + "-d=0.1 -q").code == 0);
  check_failure(shell, in_out + "-d '-x=1 ? 1 : 2'", 1, "'==' compares");
  CHECK(shell(in_out + "-d=-1% -q").code == 0);
  CHECK_THAT(shell("--help corners").out, Catch::Contains("--corners KIND") && !Catch::Contains("--miter-limit L"));
  // A file of nearly such a name is one.
  std::ofstream(shell.file("patch")) << shell.slurp(shell.file("sphere.obj"));
  CHECK(shell("patch out.obj -d 0.1 --format obj -q").code == 0);
}

TEST_CASE("command: what options need and exclude holds for the line and a file of options together", "[command]") {
  const ShellCommand shell;
  const auto written = [&](const char* text) {
    std::ofstream(shell.file("o.toml")) << text;
    return "sphere.obj out.obj --config o.toml ";
  };
  check_failure(shell, written("inner = 0.1") + std::string("-d 0.1"), 1, "--inner needs --shell");
  check_failure(shell, written("collision = 'limit'") + std::string("-d 0.1 --mode iso"), 1,
                "--collision and --mode iso exclude each other");
  CHECK(shell(written("inner = 0.1") + std::string("-d 0.1 --shell -q")).code == 0);
  CHECK(shell(written("mode = 'iso'") + std::string("-d 0.1 --keep-specks --voxel-size 0.1 -q")).code == 0);
  // A flag that is off is none.
  CHECK(shell("sphere.obj out.obj -d 0.1 --tolerance 5% --shell=false -q").code == 0);
  CHECK(shell("sphere.obj out.obj -d 0.1 -q -q").code == 0);
  for (const auto& [arguments, message] :
       {std::pair{"--fit sphere.obj", "--fit needs --clearance"},
        {"-d 1 --clearance 1", "--clearance needs --obstacle or --fit"},
        {"--distance-z 1", "--distance-z needs --distance-xy"},
        {"--layers 2 --heights h.txt --growth 2", "--growth and --heights exclude each other"},
        {"--distance-xy 1 --distance-z 1 --distance-of up:1", "--distance-of and --distance-xy exclude each other"},
        {"-d 1 --exact", "--exact needs an output that ends in .step, .stp or .brep"}})
    check_failure(shell, std::string("sphere.obj out.obj ") + arguments, 1, message);
}

TEST_CASE("command: 2 for input that cannot be read", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "none.obj out.obj --distance 1", 2, "none.obj: cannot be opened");
  std::ofstream(shell.file("broken.obj")) << "v 0 0 0\nf 1 2 3\n";
  check_failure(shell, "broken.obj out.obj --distance 1", 2, "broken.obj, line 2");
  std::ofstream(shell.file("broken.json")) << "{}";
  check_failure(shell, "broken.json out.obj", 2, "broken.json: expected");
}

TEST_CASE("command: 3 for work that is refused or falls short", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj out.obj --distance 0.1 --voxel-size 1e-4 --max-memory 1G", 3, "would fit");
  const std::string plates = test::scenes_path() + "/plates_closing.json";
  CHECK(shell("'" + plates + "' out.obj").code == 0);
  const Run strict = shell("'" + plates + "' out.obj --strict");
  CHECK(strict.code == 3);
  CHECK_THAT(strict.err, Catch::Contains("--strict") && Catch::Contains("fall short"));
  CHECK(shell.has("out.obj"));  // told, but made
  std::ofstream(shell.file("scene.json")) << R"({"shape": {"type": "icosphere", "radius": 1, "subdivisions": 2},
    "offset": {"distance": 0.1}, "expect": {"max_reached": 0.5}})";
  const Run unmet = shell("scene.json out.obj");
  CHECK(unmet.code == 3);
  CHECK_THAT(unmet.err, Catch::Contains("expected a share reached of at most"));
  CHECK(shell("scene.json out.obj --distance 0.2").code == 0);  // another distance, other expectations
}

TEST_CASE("command: 4 for output that cannot be written", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj no/such/out.obj --distance 0.1", 4, "cannot be written");
  check_failure(shell, "sphere.obj out.obj --distance 0.1 --report no/such/report.json", 4, "report.json");
  check_failure(shell, "sphere.obj out.obj --distance 0.1 --report /dev/full", 4, "cannot be written");
  // A .gltf of a mesh that has no numbers of its own beside it needs no .bin.
  std::filesystem::create_directory(shell.file("all.bin"));
  CHECK(shell("sphere.obj all.gltf --distance 0.1 -q").code == 0);
}

TEST_CASE("command: a dry run tells the plan and writes nothing", "[command]") {
  const ShellCommand shell;
  const Run run = shell("sphere.obj out.obj --distance 1% --dry-run --report r.json");
  CHECK(run.code == 0);
  for (const char* word : {"voxel size", "leaf nodes", "voxels", "MiB", "s on"})
    CHECK_THAT(run.out, Catch::Contains(word));
  CHECK(shell.count() == 1);
}

TEST_CASE("command: the report has the keys that scripts rely on", "[command]") {
  const ShellCommand shell;
  REQUIRE(shell("sphere.obj out.obj --distance 5% --report report.json --save-vdb field.vdb").code == 0);
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("report.json")));
  CHECK(report["distance"].get<double>() == Approx(0.05 * report["mesh"]["diagonal"].get<double>()));
  CHECK(report["voxel_size"].get<double>() > 0);
  CHECK(report["threads"].get<int>() >= 1);
  for (const char* stage : {"read", "rasterise", "sweep", "gradient", "propagate", "limit", "write", "total"})
    CHECK(report["seconds"][stage].get<double>() >= 0);
  for (const char* state : {"reached", "collision", "limited", "outside_field", "unused"})
    CHECK(report["vertices_by_state"].contains(state));
  CHECK(report["vertices_by_state"]["reached"] == 642);
  CHECK(report["peak_memory_bytes"].get<std::size_t>() > 1000000);
  CHECK(report["options"]["distance"] == "5%");
  CHECK(report["mesh"]["faces_by_corners"]["3"] == 1280);
  CHECK(report["grid"]["bytes"]["phi"].get<std::size_t>() > 0);
  CHECK(fs::file_size(shell.file("field.vdb")) > 1000);
}

TEST_CASE("command: same bytes for any number of threads", "[command]") {
  const ShellCommand shell;
  REQUIRE(shell("sphere.obj one.obj --distance=-3% --threads 1").code == 0);
  REQUIRE(shell("sphere.obj two.obj --distance=-3% --threads 2").code == 0);
  CHECK(shell.slurp(shell.file("one.obj")) == shell.slurp(shell.file("two.obj")));
}

TEST_CASE("command: an interrupt ends it by that signal and leaves nothing", "[command]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("big.obj"), shapes::bumpy_sphere(1, 0.4, 2, 1, 7).view());
  const std::size_t before = shell.count();
  const std::string command = test::command_path(), input = shell.file("big.obj"), output = shell.file("out.obj");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    execl(command.c_str(), command.c_str(), input.c_str(), output.c_str(), "-d", "-4%", "--threads", "1", "-q",
          nullptr);
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGINT);
  CHECK(shell.count() == before);
}

TEST_CASE("command: layers go to volume files, or to a surface each", "[command][layers]") {
  const ShellCommand shell;
  const std::string layers = " --layers 4 --first-height 0.01 --growth 1.5 ";
  for (const char* name : {"out.vtu", "out.msh", "out.cgns", "out.su2", "case/polyMesh"}) {
    INFO(name);
    const Run run = shell("sphere.obj " + std::string(name) + layers + "--report report.json --strict");
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("4 layers full on 100.0 % of the area") && Catch::Contains("5120 cells"));
    CHECK(shell.has(name));
    const auto report = nlohmann::json::parse(shell.slurp(shell.file("report.json")));
    CHECK(report["layers"]["cells"] == 5120);
    CHECK(report["seconds"]["measure"].get<double>() > 0);
    CHECK(report["layers"]["coverage"].get<double>() == Approx(1));
    CHECK(report["options"]["growth"] == "1.5");
  }
  CHECK(shell("sphere.obj s.obj" + layers + "-q").code == 0);
  const auto source = io::read_mesh(shell.file("sphere.obj"));
  const auto last = io::read_mesh(shell.file("s_004.obj"));
  CHECK(last.polygons.corners == source.polygons.corners);
  CHECK(last.polygons.positions[0].length() == Approx(1 + 0.01 * (1 + 1.5 + 2.25 + 3.375)));
  CHECK(shell.has("s_001.obj"));
  CHECK(!shell.has("s_005.obj"));
}

TEST_CASE("command: heights of layers from a file, and structured blocks", "[command][layers]") {
  const ShellCommand shell;
  std::ofstream(shell.file("heights.txt")) << "# above the wall\n0.01\n\n0.5 % # of the diagonal\n0.04 + 0.01*z\n";
  const Run run = shell("sphere.obj out.vtu --heights heights.txt");
  CHECK(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("3 layers"));
  std::ofstream(shell.file("wrong.txt")) << "0.01\n0.02\n0.03 + q\n";
  check_failure(shell, "sphere.obj new.vtu --heights wrong.txt", 2, "line 3");
  check_failure(shell, "sphere.obj new.vtu --heights wrong.txt --layers 2", 2, "line 3");
  std::ofstream(shell.file("falling.txt")) << "0.02\n0.01\n";
  check_failure(shell, "sphere.obj new.vtu --heights falling.txt", 2, "expected heights that rise");
  io::write_mesh(shell.file("patch.obj"), shapes::patch(1, 0.1, 8).view());
  for (const char* name : {"block.vts", "block.xyz"}) {
    CHECK(shell("patch.obj " + std::string(name) + " --layers 3 --total-thickness 2% --structured").code == 0);
    CHECK(shell.has(name));
  }
  check_failure(shell, "sphere.obj new.vts --layers 3 --total-thickness 2% --structured", 2, "expected quads");
}

TEST_CASE("command: heights of layers for each vertex from a file", "[command][layers]") {
  const ShellCommand shell;
  const auto source = io::read_mesh(shell.file("sphere.obj"));
  std::filesystem::create_directory(shell.file("given"));
  std::ofstream numbers(shell.file("given/numbers.txt"));
  for (const Vec3d& p : source.polygons.positions) numbers << (p[2] > 0 ? 0.04 : 0.02) << '\n';
  numbers.close();
  std::ofstream(shell.file("given/heights.txt")) << "0.01\n@numbers.txt\n";  // beside the file that names it
  const auto check_radii = [&](const std::string& arguments, const char* last) {
    INFO(arguments);
    CHECK(shell("sphere.obj s.obj " + arguments + " -q").code == 0);
    const auto outermost = io::read_mesh(shell.file(last)).polygons.positions;
    for (std::size_t v = 0; v < outermost.size(); v += 7)
      if (const double z = source.polygons.positions[v][2]; std::abs(z) > 0.2)
        CHECK(outermost[v].length() == Approx(z > 0 ? 1.04 : 1.02).epsilon(2e-4));
  };
  check_radii("--heights given/heights.txt", "s_002.obj");
  check_radii("--layers 3 --total-thickness @given/numbers.txt", "s_003.obj");
  check_radii("-d @given/numbers.txt", "s.obj");
  // Copies that disagree at one height alone are told.
  std::ofstream(shell.file("seam.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n";
  std::ofstream(shell.file("given/inner.txt")) << "0.01\n0.01\n0.01\n0.02\n0.02\n0.02\n";
  std::ofstream(shell.file("given/seam.txt")) << "@inner.txt\n0.05\n";
  CHECK_THAT(shell("seam.obj s.vtu --heights given/seam.txt").out,
             Catch::Contains("2 vertices share a position with one that was given a different distance"));
  CHECK_THAT(shell("seam.obj s.vtu --layers 2 --total-thickness 0.05").out, !Catch::Contains("another distance"));
  check_failure(shell, "sphere.obj new.vtu --layers 2 --first-height ply:thickness", 2, "sphere.obj");
  check_failure(shell, "sphere.obj new.vtu --layers 2 --first-height @missing.txt", 2, "missing.txt");
  check_failure(shell, "sphere.obj new.vtu --layers 2 --first-height @", 1, "--first-height");
  check_failure(shell, "sphere.obj new.vtu --layers 1000 --total-thickness 1% --max-memory 60M", 3, "MiB");
}

TEST_CASE("command: options of layers that do not go together", "[command][layers]") {
  const ShellCommand shell;
  for (const auto& [arguments, message] :
       {std::pair{"out.cgns --distance 1", "--layers"},
        {"out.obj --distance 1 --growth 1.2", "--growth needs --layers"},
        {"out.vtu --layers 3", "needs --first-height"},
        {"out.vtu --layers 3 --first-height 1 --total-thickness 2 --growth 2", "expected three of"},
        {"out.vtu --layers 0 --first-height 1", "--layers: expected 1 to 1000"},
        {"out.vtu --layers 2 --first-height 1 --growth 0", "--growth: expected"},
        {"out.vtu --layers 2 --first-height 'x+' ", "--first-height"},
        {"out.vtu --layers 2 --first-height 1 --shell", "--shell and --layers exclude each other"},
        {"out.vtu --layers 2 --first-height 1 --distance 1", "--distance and --layers exclude each other"},
        {"out.vts --layers 2 --first-height 1", "--structured"},
        {"out.vtu --layers 2 --first-height 1 --structured", "--structured"}})
    check_failure(shell, std::string("sphere.obj ") + arguments, 1, message);
}

TEST_CASE("command: where layers have no room, the side that has is named", "[command][layers]") {
  const ShellCommand shell;
  // An open curve that runs clockwise, so that layers of far more than its width go into it: not one cell is left.
  std::ofstream(shell.file("open.txt")) << "0 0\n0 0.02\n0.02 0.02\n0.02 0\n0.0004 0\n";
  const std::string run = "open.txt out.su2 --layers 5 --total-thickness 3";
  check_failure(shell, run, 2, "open.txt: expected room for one cell at least, got none (1 open curve");
  check_failure(shell, run, 2, "To join the ends: --close; only 0 % of the curves has room on this side");
  check_failure(shell, run, 2, "wrong way: --total-thickness -3");
  CHECK(shell(run + " --close -q").code == 0);
  // A closed plate whose faces point into it, as hulls of buildings come.
  std::ofstream(shell.file("plate.obj")) << "v 0 0 0\nv 10 0 0\nv 0 8 0\nv 10 8 0\nv 0 0 0.1\nv 10 0 0.1\nv 0 8 0.1\n"
                                            "v 10 8 0.1\nf 2 4 3 1\nf 7 8 6 5\nf 5 6 2 1\nf 4 8 7 3\nf 3 7 5 1\n"
                                            "f 6 8 4 2\n";
  const Run inward = shell("plate.obj in.vtu --layers 3 --total-thickness 0.2");
  CHECK(inward.code == 0);
  CHECK_THAT(inward.out,
             Catch::Contains("\nwarning: only 0 % of the surface has room on this side, 100 % on the other. If "
                             "faces point the wrong way: --total-thickness -0.2\n"));
  const Run outward = shell("plate.obj out.vtu --layers 3 --total-thickness=-0.2");
  CHECK_THAT(outward.out, Catch::Contains("full on 100.0 %") && !Catch::Contains("has room"));
}

TEST_CASE("command: a captured surface, its report and what comes along", "[command][capture]") {
  const ShellCommand shell;
  std::ofstream(shell.file("square.obj")) << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\n";
  const Run run = shell("square.obj tube.obj -d 0.1 --mode iso --voxel-size 0.05 --report tube.json --strict");
  CHECK(run.code == 0);
  CHECK(run.err.empty());
  CHECK_THAT(run.out, Catch::Contains("closed, manifold, 0 crossings") && Catch::Contains("on all sides"));
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("tube.json")));
  const auto& surface = report["surface"];
  CHECK(surface["valid"] == true);
  CHECK(surface["closed"] == true);
  CHECK(surface["manifold"] == true);
  CHECK(surface["signed"] == false);
  CHECK(surface["crossings"] == 0);
  CHECK(surface["distance_error"]["worst"] < 1e-8);
  CHECK(report["voxel_size"] == 0.05);
  CHECK(report["options"]["mode"] == "iso");
  CHECK(report["seconds"]["capture"] > 0);
  const std::string tube = shell.slurp(shell.file("tube.obj"));
  for (const char* line : {"mtllib a.mtl\n", "usemtl red\n", "\nvt ", "\nvn "}) CHECK_THAT(tube, Catch::Contains(line));
  CHECK(io::read_mesh(shell.file("tube.obj")).polygons.face_count() == surface["triangles"]);

  CHECK(shell("square.obj bare.obj -d 0.1 --mode iso --voxel-size 0.05 --transport none").code == 0);
  CHECK_THAT(shell.slurp(shell.file("bare.obj")), !Catch::Contains("usemtl") && !Catch::Contains("vt "));
  CHECK(shell("square.obj '{d}.stl' -d 0.1 -d 0.2 --mode iso --voxel-size 0.05 -q").code == 0);
  CHECK(shell.has("0.1.stl"));
  CHECK(shell.has("0.2.stl"));
  const Run plan = shell("sphere.obj out.obj -d 5% --mode iso --dry-run");
  CHECK(plan.code == 0);
  CHECK_THAT(plan.out, Catch::Contains("voxel size") && Catch::Contains("triangles"));
  CHECK(!shell.has("out.obj"));
}

TEST_CASE("command: a hollow solid by captured skins", "[command][capture]") {
  const ShellCommand shell;
  const std::string iso = " --mode iso --shell --voxel-size 0.1 --report out.json ";
  for (const char* distance : {"-d -0.2", "-d 0.2", "-d 0.1 --inner 0.1"}) {
    const Run run = shell("sphere.obj out.obj" + iso + distance);
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("1 component, closed, manifold") &&
                            Catch::Contains("hollow solid, closed, volume ") && !Catch::Contains("intersects itself"));
    const auto report = nlohmann::json::parse(shell.slurp(shell.file("out.json")));
    CHECK(report["shell"]["closed"] == true);
    CHECK(report["shell"]["volume"] > 0);
    CHECK(report.contains("inner_surface") == (std::string(distance).find("--inner") != std::string::npos));
    const std::string text = shell.slurp(shell.file("out.obj"));
    CHECK_THAT(text, Catch::Contains("g outer\n") && Catch::Contains("g inner\n"));
  }
  std::ofstream(shell.file("square.obj")) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  check_failure(shell, "square.obj out.obj -d -0.1" + iso, 2, "expected a mesh that has an inside");
  check_failure(shell, "sphere.obj out.obj -d -2" + iso, 2, "expected a surface at distance -2");
}

TEST_CASE("command: skins of a hollow solid that meet are not written", "[command][capture]") {
  const ShellCommand shell;
  // A cube with a slot of next to no width: chords between its two sides cut through the cavity's wall.
  std::ofstream(shell.file("slot.obj")) << "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1.03 2 0\nv 1.013 0.5 0\nv 1 2 0\nv 0 2 0\n"
                                           "v 0 0 2\nv 2 0 2\nv 2 2 2\nv 1.03 2 2\nv 1.013 0.5 2\nv 1 2 2\nv 0 2 2\n"
                                           "f 1 2 9 8\nf 2 3 10 9\nf 3 4 11 10\nf 4 5 12 11\nf 5 6 13 12\n"
                                           "f 6 7 14 13\nf 7 1 8 14\nf 1 5 2\nf 2 5 4\nf 2 4 3\nf 1 7 6\nf 1 6 5\n"
                                           "f 8 9 12\nf 9 11 12\nf 9 10 11\nf 8 13 14\nf 8 12 13\n";
  const std::string run = "slot.obj out.obj -d -0.05 --mode iso --shell ";
  check_failure(shell, run + "--voxel-size 0.1", 3, "hollow: expected skins that do not meet, got ");
  const Run fine = shell(run + "--voxel-size 0.025");
  CHECK(fine.code == 0);
  CHECK_THAT(fine.out, Catch::Contains("hollow solid, closed") && !Catch::Contains("intersects itself"));
  // What lies inside the solid meets its cavity, however small voxels are.
  const Polygons box = shapes::box(Vec3d(2), 1, true);
  Polygons both = box;
  for (const Vec3d& p : box.positions) both.positions.push_back(p + Vec3d(1, 0.1, 0.2));
  for (std::size_t f = 0; f < box.face_count(); ++f) {
    for (const auto v : box.view().face(f))
      both.corners.push_back(v + static_cast<std::uint32_t>(box.positions.size()));
    both.close_face();
  }
  io::write_mesh(shell.file("both.obj"), both.view());
  check_failure(shell, "both.obj hollow.obj -d -0.1 --mode iso --shell --voxel-size 0.05", 3,
                "with -d and --inner both skins are new");
  CHECK(shell("both.obj hollow.obj -d 0.1 --inner 0.1 --mode iso --shell --voxel-size 0.05 -q").code == 0);
}

TEST_CASE("command: options of captured surfaces that do not go together", "[command][capture]") {
  const ShellCommand shell;
  const std::string iso = "sphere.obj out.obj -d 0.1 --mode iso ";
  check_failure(shell, "sphere.obj out.obj -d 0.1 --mode front", 1, "--mode: expected 'topology' or 'iso'");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --adaptivity 0.5", 1, "--adaptivity needs --mode iso");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --transport uv", 1, "--transport needs --mode iso");
  for (const std::string option : {"--only group=a", "--border fixed", "--obstacle sphere.obj", "--collision merge",
                                   "--solver eikonal", "--states a.csv", "--paths a.obj", "--save-vdb a.vdb"})
    check_failure(shell, iso + option, 1, option.substr(0, option.find(' ')) + " and --mode iso exclude each other");
  check_failure(shell, iso + "--normals keep", 1, "--normals keep and --mode iso exclude each other");
  check_failure(shell, "sphere.obj out.vtu --mode iso --layers 3 --first-height 0.1", 1,
                "--layers and --mode iso exclude each other");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --keep-specks", 1, "--keep-specks needs --mode iso");
  check_failure(shell, iso + "--inside out", 1, "--inside: expected 'winding' or 'never'");
  check_failure(shell, iso + "--adaptivity 2", 1, "--adaptivity: expected a number from 0 to 1");
  check_failure(shell, iso + "--transport uv,", 1, "--transport: expected 'uv'");
  check_failure(shell, iso + "--transport uv", 1, "expected texture coordinates");
  check_failure(shell, "sphere.obj out.obj --mode iso -d 'x+1'", 1, "--distance: expected a number");
  check_failure(shell, "sphere.obj out.obj --mode iso -d 0", 1, "--distance: expected one other than 0");
  check_failure(shell, "sphere.obj out.obj --mode iso --distance-from a.txt", 1, "--distance-from and ");
  check_failure(shell, "sphere.obj out.obj --mode iso -d -2", 2, "expected a surface at distance -2");
  check_failure(shell, iso + "--voxel-size 0.0001 --max-memory 1G", 3, "a larger voxel size needs less");
  check_failure(shell, "absent.obj out.obj --mode iso -d 1", 2, "absent.obj");
}

TEST_CASE("command: curves are offset, reported, and refuse what is for meshes", "[command][curves]") {
  const ShellCommand shell;
  std::ofstream(shell.file("square.dat")) << "A square\n1 0\n1 1\n0 1\n0 0\n1 0\n";
  const Run run = shell("square.dat out.dat --distance 0.5 --corners round --report r.json --states s.csv");
  REQUIRE(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("% of the length is within 1 % of 0.5") &&
                          Catch::Contains("100.000 % of 5 points reached it"));
  std::ifstream out(shell.file("out.dat"));
  std::string title, line;
  std::getline(out, title);
  CHECK(title == "A square");
  const double far = 1 + std::sqrt(0.125);
  for (const auto& [x, y] : {std::pair{far, 1 - far}, {far, far}, {1 - far, far}, {1 - far, 1 - far}, {far, 1 - far}}) {
    double a = 0, b = 0;
    REQUIRE(out >> a >> b);
    CHECK(a == Approx(x));
    CHECK(b == Approx(y).margin(1e-12));
  }
  const auto report = nlohmann::json::parse(std::ifstream(shell.file("r.json")));
  CHECK(report["mesh"]["closed_components"] == 1);
  CHECK(report["mesh"]["faces"] == 4);
  CHECK(shell.has("s.csv"));
  CHECK(shell("square.dat lines.obj --distance 10% -q").code == 0);
  CHECK(shell("lines.obj back.txt --distance '-0.1*(1 + nx*nx)' -q").code == 0);
  CHECK(shell("square.dat none.dat --distance 1 --dry-run").code == 0);
  // A check takes uneven distances as an offset does.
  for (const char* const uneven : {"--distance '0.1 + 0.05*x'", "--distance-from each.txt"}) {
    std::ofstream(shell.file("each.txt")) << "0.1 0.2 0.2 0.1 0.1\n";
    const std::string distance = std::string(" ") + uneven;
    CHECK(shell("square.dat uneven.txt -q" + distance).code == 0);
    CHECK(shell("check square.dat uneven.txt --strict" + distance).code == 0);
    CHECK(shell("check square.dat uneven.txt --strict --distance 0.1").code == 3);
  }
  for (const char* const wrong : {"none.ply", "none.dat --only group=a", "none.dat --shell", "none.dat --mode iso"}) {
    const Run refused = shell(std::string("square.dat ") + wrong + " --distance 1");
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::Contains("expected"));
  }
  CHECK(shell("square.dat none.dat --distance u").code == 2);
  CHECK_FALSE(shell.has("none.dat"));
}

TEST_CASE("command: curved shapes of a drawing are flattened alike by an offset and a check", "[command][curves]") {
  const ShellCommand shell;
  std::ofstream(shell.file("plate.svg")) << "<svg><rect width='20' height='10' rx='3'/><circle cx='50' r='2'/></svg>";
  const Run run = shell("plate.svg cut.svg -d 0.1 -v --report r.json");
  REQUIRE(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("2 curved shapes became straight segments, at most "));
  const auto report = nlohmann::json::parse(std::ifstream(shell.file("r.json")));
  CHECK(std::stod(report["options"]["flatten"].get<std::string>()) == Approx(1e-5 * std::hypot(52, 12)).epsilon(1e-9));
  CHECK(shell("check plate.svg cut.svg -d 0.1 --strict").code == 0);
  // Told coarser, an offset has fewer points, and so has what it is compared with.
  CHECK(shell("plate.svg coarse.svg -d 0.1 --flatten 0.05 -q").code == 0);
  CHECK(fs::file_size(shell.file("coarse.svg")) < fs::file_size(shell.file("cut.svg")) / 4);
  CHECK(shell("check plate.svg coarse.svg -d 0.1 --flatten 0.05 --strict").code == 0);
  check_failure(shell, "check plate.svg coarse.svg -d 0.1", 2, "expected the points of plate.svg");
  // Percent are of the diagonal; shapes that stay are curved in the output, and get the points of the source.
  CHECK(shell("plate.svg percent.svg -d '(x > 30 ? 0 : 0.1)' --flatten 0.1% -q").code == 0);
  CHECK_THAT(shell.slurp(shell.file("percent.svg")), Catch::Contains("<circle cx='50' r='2'/>"));
  CHECK(shell("check plate.svg percent.svg --flatten 0.1%").code == 0);
  CHECK(shell("plate.svg same.svg -d 0 -q").code == 0);
  CHECK(shell.slurp(shell.file("same.svg")) == shell.slurp(shell.file("plate.svg")));
  check_failure(shell, "plate.svg no.svg -d 0.1 --flatten 0", 1,
                "--flatten: expected a number of world units or percent");
  check_failure(shell, "sphere.obj no.obj -d 0.1 --flatten 1", 1, "--flatten: expected curves");
  check_failure(shell, "check sphere.obj sphere.obj --flatten 1", 1, "--flatten: expected curves");
}

TEST_CASE("command: a DXF drawing has its own unit, and keeps what is no curve", "[command][curves][dxf]") {
  const ShellCommand shell;
  const std::string text = dxf_text::file(
      "0|LINE 8|a 10|0 20|0 11|10 21|0 0|ARC 8|a 10|5 20|0 40|5 50|0 51|180 0|TEXT 8|a 1|x", "9|$INSUNITS 70|5");
  std::ofstream(shell.file("half.dxf")) << text;
  const Run run = shell("half.dxf cut.dxf -d 2mm -v");
  REQUIRE(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("of 2 mm (") && Catch::Contains("1 curved shape became straight"));
  CHECK_THAT(run.err, Catch::Contains("half.dxf: not curves, copied unchanged: 1 TEXT"));
  CHECK(shell("check half.dxf cut.dxf -d 2mm --strict").code == 0);
  CHECK(shell("half.dxf other.dxf -d 2mm --unit mm").code == 0);
  CHECK(shell.slurp(shell.file("other.dxf")) != shell.slurp(shell.file("cut.dxf")));
  CHECK(shell("half.dxf half.svg -d 0.2 -q").code == 0);
  CHECK(shell("half.svg back.dxf -d 0 -q").code == 0);
  CHECK(shell("half.dxf same.dxf -d 0 -q").code == 0);
  CHECK(shell.slurp(shell.file("same.dxf")) == text);
  std::ofstream(shell.file("cut_off.dxf")) << text.substr(0, text.size() / 2);
  check_failure(shell, "cut_off.dxf no.dxf -d 2mm", 2, "expected 'ENDSEC', got the end of the file");
  std::ofstream(shell.file("none.dxf")) << dxf_text::file("0|LINE 11|1");
  check_failure(shell, "none.dxf no.dxf -d 2mm", 1, "does not state its unit; add --unit mm");
}

TEST_CASE("command: layers on curves are cells, blocks and curves", "[command][curves][layers]") {
  const ShellCommand shell;
  std::ofstream(shell.file("square.dat")) << "1 0\n1 1\n0 1\n0 0\n1 0\n";
  const std::string layers = " --layers 3 --first-height 0.1 --growth 1.5 ";
  const Run run = shell("square.dat out.vtu" + layers + "--report r.json --states s.csv");
  REQUIRE(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("3 layers full on 100.0 % of the length") &&
                          Catch::Contains("36 cells, 24 of them in fans over sharp edges"));
  REQUIRE(shell("square.dat out.vtu" + layers + "--report r.json --fan-angle 0").code == 0);
  const auto report = nlohmann::json::parse(std::ifstream(shell.file("r.json")));
  // Corners go along the diagonals: a square in a square.
  const double side = 1 + 2 * 0.475 / std::sqrt(2.0);
  CHECK(report["layers"]["volume"] == Approx(side * side - 1));
  CHECK(report["layers"]["fan_cells"] == 0);
  CHECK(report["layers"]["area"] == Approx(4));
  CHECK(report["layers"]["coverage"] == 1);
  for (const char* const right : {"out.su2", "out.msh", "out.cgns", "polyMesh", "filled.vtu --fill",
                                  "out.vts --structured", "out.xyz --structured", "layer.dat", "none.vtu --dry-run"}) {
    INFO(right);
    CHECK(shell(std::string("square.dat ") + right + layers).code == 0);
  }
  std::ifstream block(shell.file("out.xyz"));
  unsigned ni = 0, nj = 0, nk = 0;
  CHECK((block >> ni >> nj >> nk && ni == 5 && nj == 4 && nk == 1));
  for (const char* const made : {"layer_001.dat", "layer_002.dat", "layer_003.dat"}) CHECK(shell.has(made));
  for (const char* const wrong : {"none.xyz", "none.vtu --structured", "none.obj --only group=a",
                                  "none.dat --fan-angle 30", "none.dat --fill", "none.vtu --fill --farfield box.obj"}) {
    INFO(wrong);
    const Run refused = shell(std::string("square.dat ") + wrong + layers);
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::Contains("expected"));
  }
  CHECK_FALSE(shell.has("none.vtu"));
}

TEST_CASE("command: distances by axis and fits, and what goes with them", "[command]") {
  const ShellCommand shell;
  Polygons floor = shapes::box(Vec3d(4, 4, 1), 2, true);
  for (Vec3d& p : floor.positions) p[2] -= 1.55;  // its upper side at -1.05
  io::write_mesh(shell.file("floor.obj"), floor.view());
  CHECK(shell("sphere.obj thin.stl --distance-xy -0.1 --distance-z -0.05").code == 0);
  CHECK(shell("check sphere.obj thin.obj -d 1").code == 2);
  CHECK(shell("sphere.obj thin.obj --distance-xy -0.1 --distance-z -0.05").code == 0);
  CHECK(shell("check sphere.obj thin.obj --distance-xy -0.1 --distance-z -0.05 --strict").code == 0);
  CHECK(shell("check sphere.obj thin.obj -d -0.1 --strict").code == 3);
  CHECK(shell("floor.obj across.obj --distance-xy -0.1 --distance-z 0").code == 0);
  CHECK(shell("check floor.obj across.obj --distance-xy -0.1 --distance-z 0 --strict").code == 0);
  const io::MeshFile across = io::read_mesh(shell.file("across.obj"));
  for (std::size_t v = 0; v < floor.positions.size(); ++v)
    for (int k = 0; k < 3; ++k) {
      const double side = k == 2 ? 0.5 : 2, by = k == 2 ? 1e-4 : 0.1, centre = k == 2 ? -1.55 : 0;
      const double from = floor.positions[v][k] - centre, to = across.polygons.positions[v][k] - centre;
      if (std::abs(std::abs(from) - side) < 1e-9) CHECK(to == Approx(std::copysign(side - by, from)).epsilon(1e-6));
    }
  CHECK(shell("sphere.obj loose.stl --fit floor.obj --clearance 0.1 --strict --report fit.json").code == 0);
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("fit.json")));
  CHECK(report["fit"]["gap"].get<double>() >= 0.1 * (1 - 1e-6));
  CHECK(report["fit"]["gap_at_start"].get<double>() < 0.06);
  CHECK(shell("sphere.obj same.obj -d 0 --obstacle floor.obj --clearance 0.1 --strict").code == 3);
  CHECK(shell("sphere.obj same.obj -d 0 --obstacle floor.obj --clearance 0.01 --strict").code == 0);
  check_failure(shell, "sphere.obj o.obj --distance-xy 1", 1, "--distance-z");
  check_failure(shell, "sphere.obj o.obj --distance-xy 0 --distance-z 0", 1, "not 0");
  check_failure(shell, "sphere.obj o.obj --distance-xy 1 --distance-z -1", 1, "the sign of --distance-xy");
  check_failure(shell, "sphere.obj o.obj --distance-xy 1 --distance-z 1 -d 1", 1, "--distance");
  check_failure(shell, "sphere.obj o.obj --fit floor.obj", 1, "--clearance");
  check_failure(shell, "sphere.obj o.obj --fit floor.obj --clearance 0", 1, "above 0");
  check_failure(shell, "sphere.obj o.obj --fit floor.obj --clearance 1 --mode iso", 1, "--mode iso");
  check_failure(shell, "sphere.obj o.obj --fit none.obj --clearance 1", 2, "none.obj");
}

TEST_CASE("command: an iso-surface whose corners would be rounded by more than voxels are large is refused",
          "[command][iso]") {
  const ShellCommand run;
  Polygons sphere = shapes::icosphere(1, 3);
  for (Vec3d& p : sphere.positions) p[0] += 104;  // where two digits leave next to nothing of x
  io::write_mesh(run.file("far.obj"), sphere.view());
  const Run made = run("far.obj out.obj --mode iso -d 0.3 --voxel-size 0.8 --precision 2 --report out.json");
  CHECK(made.code == 2);
  CHECK_THAT(made.err, Catch::Contains("rounded by less than 2 voxels of 0.8, got 5.2"));
  CHECK(!run.has("out.obj"));
  CHECK(!run.has("out.json"));
}

TEST_CASE("command: the command line's corners count, and not the scene's", "[command][scene]") {
  const ShellCommand run;
  const std::string scene = "'" + test::scenes_path() + "/miter_gear.json'";
  CHECK_THAT(run(scene + " mitered.obj -v").out, Catch::Contains("(miters), 0 of them cut"));
  const Run round = run(scene + " round.obj -v --corners round");
  CHECK(round.code == 3);  // what the scene expects of faces
  CHECK_THAT(round.out, !Catch::Contains("(miters)"));
  CHECK_THAT(run(scene + " cut.obj -d 1% --miter-limit 1").out, Catch::Contains("whose miters are cut"));
  CHECK(run("'" + test::scenes_path() + "/gear.json' none.obj --corners round --miter-limit 2").code == 1);
}

TEST_CASE("command: a scene brings what its shape is to fit, unless a distance is given", "[command][scene]") {
  const ShellCommand run;
  const std::string scene = test::scenes_path() + "/peg_in_socket.json";
  CHECK(run("'" + scene + "' peg.obj --strict --report peg.json").code == 0);
  CHECK_THAT(run.slurp(run.file("peg.json")), Catch::Contains("\"triangles_too_near\": 0"));
  CHECK(run("'" + scene + "' as_it_is.obj --distance 0").code == 0);
  for (const std::string option : {"--shell", "--mode iso", "--collision merge", "--corners miter"}) {
    const Run refused = run("'" + scene + "' no.obj " + option);
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::Contains("without a fit"));
  }
  CHECK(!run.has("no.obj"));
}

TEST_CASE("command: triangles of polygons with corners on straight sides are told from each other", "[command]") {
  const ShellCommand run;
  std::ofstream(run.file("box.obj"))
      << "v 0 0 0\nv 1 0 0\nv 1 1.3 0\nv 0 1.3 0\nv 0 0 0.7\nv 1 0 0.7\nv 1 1.3 0.7\nv 0 1.3 0.7\n"
         "v 0.614602089 1.3 0\nv 1 1.3 0.00372784028\nv 1 1.3 0.473696659\nv 1 1.3 0.559246629\n"
         "v 0.991383328 1.3 0.7\nv 0 0 0.295524067\nv 0.0665995215 0 0.7\nv 0.267023636 0 0.7\n"
         "v 0.580481092 0 0.7\nf 3 2 1 4 9\nf 10 11 12 7 6 2 3\nf 12 11 10 3 9 4 8 13 7\nf 5 8 4 1 14\n"
         "f 13 8 5 15 16 17 6 7\nf 16 15 5 14 1 2 6 17\n";
  for (const std::string distance : {" -d 0.05", " --distance=-0.05"}) {
    CHECK(run("box.obj box.stl" + distance).code == 0);
    CHECK_THAT(run("check box.obj box.stl" + distance).out, Catch::EndsWith("\nvalid\n"));
  }
}

TEST_CASE("command: what is judged of a polygon is what is written in formats of triangles", "[command]") {
  const ShellCommand run;
  const auto crossings_in = [&](const std::string& name) {
    const Polygons written = io::read_mesh(run.file(name)).polygons;
    const Surface surface = build_surface(written.view(), {});
    return CrossingFinder(surface, surface.vertices).all().size();
  };
  for (const std::uint32_t arcs : {4u, 8u, 20u}) {
    io::write_mesh(run.file("letter.off"), test::letter_c(arcs).view());
    for (const std::string distance : {" -d 0.5% ", " --distance=-1% ", " --distance-xy 0.02 --distance-z 0.05 "})
      for (const std::string name : {"out.stl", "out.3mf", "out.glb", "out.ply"}) {
        CAPTURE(arcs, distance, name);
        CHECK(run("letter.off " + name + distance).code == 0);
        CHECK(run("check letter.off " + name + distance).code == 0);
        if (!name.ends_with("ply")) CHECK(crossings_in(name) == 0);
      }
    CHECK(run("letter.off shell.stl -d 0.5% --shell").code == 0);
    CHECK(crossings_in("shell.stl") == 0);
  }
  // The ends in fans, which cover them several times over.
  const Polygons letter = test::letter_c(8);
  CHECK(run("letter.off out.obj -d 0.5%").code == 0);
  Polygons fans;
  fans.positions = io::read_mesh(run.file("out.obj")).polygons.positions;
  for (std::size_t f = 0; f < letter.face_count(); ++f) {
    const auto face = letter.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k) fans.add_face({face[0], face[k - 1], face[k]});
  }
  io::write_mesh(run.file("letter.off"), letter.view());
  io::write_mesh(run.file("fans.stl"), fans.view());
  CHECK(crossings_in("fans.stl") > 0);
  CHECK(run("check letter.off fans.stl -d 0.5%").code == 3);
}

TEST_CASE("command: a distance that no vertex reaches is refused, with one that most reach", "[command]") {
  const ShellCommand run;
  // A box of 2 by 2 by 0.4: nothing inside is farther than 0.2 from it.
  io::write_mesh(run.file("box.obj"), shapes::box(Vec3d(2, 2, 0.4), 8, true).view());
  const Run none = run("box.obj out.obj --distance=-0.5");
  CHECK(none.code == 3);
  CHECK_THAT(none.err,
             Catch::Contains("out.obj: no vertex reached the distance of -0.5: the part is thinner than 2 × 0.5. "
                             "Try a smaller distance, as --distance -0."));
  const auto at = none.err.find("--distance ") + 11;
  const Run most = run("box.obj out.obj --distance=" + none.err.substr(at, none.err.find('\n', at) - at));
  CHECK(most.code == 0);
  const Run some = run("box.obj out.obj --distance=-0.1");
  CHECK(some.code == 0);
  CHECK(some.err.empty());
  CHECK(run("box.obj out.obj --distance 0").code == 0);
}

TEST_CASE("command: a mesh without any area is refused", "[command]") {
  const ShellCommand run;
  std::ofstream(run.file("line.obj")) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
  for (const std::string how : {" -d 0.1", " -d 0.1 --mode iso", " -d 0.1 --shell", " --layers 2 --first-height 0.1"}) {
    const std::string out = how.find("layers") == std::string::npos ? "out.obj" : "out.vtu";
    const Run refused = run("line.obj " + out + how);
    CAPTURE(how, refused.err);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Catch::Contains("expected a face with an area"));
    CHECK_FALSE(run.has(out));
  }
}

TEST_CASE("command: planes that borders are kept in, or leave, are reported", "[command]") {
  const ShellCommand run;
  // Cones' sides, whose rims lie in z = 0 and z = 1 and meet these at 45 and at 8 degrees.
  const auto cone = [](double rise) {
    Polygons mesh;
    for (const bool top : {false, true})
      for (int i = 0; i < 48; ++i) {
        const double angle = 2 * std::numbers::pi * i / 48, r = top ? 1 : 2;
        mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), top ? rise : 0);
      }
    for (std::uint32_t i = 0; i < 48; ++i) mesh.add_face({i, (i + 1) % 48, 48 + (i + 1) % 48, 48 + i});
    return mesh;
  };
  io::write_mesh(run.file("steep.obj"), cone(1).view());
  io::write_mesh(run.file("flat.obj"), cone(std::tan(8 * std::numbers::pi / 180)).view());
  const auto kKept = Catch::Contains("borders stay in the plane they lie in: z = 0, z = 1 (--symmetry none: do not)");
  CHECK_THAT(run("steep.obj out.obj -d 0.05 -v").out, kKept);
  CHECK_THAT(run("steep.obj out.obj -d 0.05 -v --symmetry none").out, !Catch::Contains("borders stay"));
  const Run flat = run("flat.obj out.obj -d 0.05 -v");
  CHECK_THAT(flat.out, !Catch::Contains("borders stay") &&
                           Catch::Contains("borders in z = 0, z = 0.140541 leave that plane by up to 0.0") &&
                           Catch::Contains("To keep them there: --symmetry z=0\n"));
  CHECK_THAT(run("flat.obj out.obj -d 0.05 --symmetry z=0").out, !Catch::Contains("borders in z = 0,"));
}

TEST_CASE("command: what becomes of a scene in STL is judged as it is written", "[command][scene]") {
  const ShellCommand run;
  const std::string scene = "'" + test::scenes_path() + "/naca_wing.json'";
  CHECK(run(scene + " wing.obj -d 0").code == 0);
  CHECK(run(scene + " thin.stl -d -1%").code == 0);
  // Judged in double precision, the trailing edge had 12 crossings there.
  CHECK_THAT(run("check wing.obj thin.stl -d -1%").out, Catch::EndsWith("\nvalid\n"));
}
