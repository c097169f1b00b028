// SPDX-License-Identifier: Apache-2.0
// The command with --tolerance: what it writes, tells and refuses.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "command/shell_command.h"
#include "support/places.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

Polygons mesh_of(const ShellCommand& shell, const std::string& name) {
  return io::read_mesh(shell.file(name)).polygons;
}

nlohmann::json json_of(const ShellCommand& shell, const std::string& name) {
  return nlohmann::json::parse(shell.slurp(shell.file(name)));
}

/// The distance of a point outside from the box of half sizes `half` around the origin.
double distance_from_box(const Vec3d& p, const Vec3d& half) {
  Vec3d beyond;
  for (int k = 0; k < 3; ++k) beyond[k] = std::max(std::abs(p[k]) - half[k], 0.0);
  return beyond.length();
}

/// The largest error of the distance at points of all triangles, their corners and 45 more.
double worst_error(const Polygons& mesh, const Vec3d& half, double distance) {
  double worst = 0;
  constexpr int kSteps = 8;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; i + j <= kSteps; ++j) {
          const double u = double(i) / kSteps, v = double(j) / kSteps;
          const Vec3d p =
              (1 - u - v) * mesh.positions[face[0]] + u * mesh.positions[face[k]] + v * mesh.positions[face[k + 1]];
          worst = std::max(worst, std::abs(distance_from_box(p, half) - distance));
        }
  }
  return worst / distance;
}

/// A line of a map.
struct MapLine {
  std::size_t vertex, face;
  std::array<std::size_t, 3> of;
  std::array<double, 3> share;
};

std::vector<MapLine> map_of(const ShellCommand& shell, const std::string& name) {
  std::istringstream text(shell.slurp(shell.file(name)));
  std::string line;
  std::getline(text, line);
  CHECK_THAT(line, Catch::StartsWith("#"));
  std::vector<MapLine> lines;
  for (MapLine l{};
       text >> l.vertex >> l.face >> l.of[0] >> l.of[1] >> l.of[2] >> l.share[0] >> l.share[1] >> l.share[2];)
    lines.push_back(l);
  return lines;
}

const Vec3d kHalf(1, 0.6, 0.4);

}  // namespace

TEST_CASE("tolerance: faces are at the distance, and source and offset correspond, in every format",
          "[command][tolerance]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("box.obj"), shapes::box(2 * kHalf, 4, false).view());
  for (const std::string ending : {"obj", "ply", "off", "stl"}) {
    INFO(ending);
    const std::string source = "box." + ending, refined = "refined." + ending, offset = "out." + ending;
    REQUIRE(shell("box.obj " + source + " -d 0 -q").code == 0);
    const Run run = shell(source + " " + offset + " -d 0.2 --corners round --tolerance 2% --refined-source " + refined +
                          " --map map.txt --report r.json --states s.csv --strict");
    INFO(run.out << run.err);
    CHECK(run.code == 0);
    CHECK_THAT(run.out,
               Catch::Contains(": 100.00 % of the area is certified within 2 % of the distance at every point; ") &&
                   !Catch::Contains("--tolerance"));
    const Polygons before = mesh_of(shell, source), in_source = mesh_of(shell, refined), made = mesh_of(shell, offset);
    CHECK(made.corners == in_source.corners);
    CHECK(made.face_begin == in_source.face_begin);
    CHECK(made.positions.size() == in_source.positions.size());
    CHECK(worst_error(made, kHalf, 0.2) < 0.02 + 1e-6);  // single precision, of coordinates up to 1.2
    if (ending != "stl")
      CHECK(std::equal(before.positions.begin(), before.positions.end(), in_source.positions.begin()));
    const auto lines = map_of(shell, "map.txt");
    CHECK(lines.size() == (ending == "stl" ? lines.size() : made.positions.size() - before.positions.size()));
    for (const auto& [vertex, face, of, share] : lines) {
      Vec3d place(0.0);
      for (std::size_t k = 0; k < 3; ++k) {
        place += share[k] * before.positions.at(of[k]);
        const auto corners = before.view().face(face);
        CHECK(std::find(corners.begin(), corners.end(), of[k]) != corners.end());
      }
      CHECK((place - in_source.positions.at(vertex)).length() < 1e-6);
    }
    const std::string states = shell.slurp(shell.file("s.csv"));
    CHECK(static_cast<std::size_t>(std::count(states.begin(), states.end(), '\n')) == made.positions.size() + 1);
    const auto report = json_of(shell, "r.json");
    CHECK(report["certified"]["tolerance_share"] == 0.02);
    CHECK(report["certified"]["certified"] == 1.0);
    CHECK(report["certified"]["there"] == 1.0);
    CHECK(report["certified"]["worst_left"] == 0.0);
    CHECK(report["certified"]["source_faces"] == before.face_count());
    CHECK(report["certified"]["source_vertices"] == before.positions.size());
    CHECK(report["certified"]["faces"] == made.face_count());
    CHECK(report["certified"]["out_of_faces"] == false);
    CHECK(report["options"]["tolerance"] == "2%");
    CHECK(report["options"]["max-faces"] == "automatic");
    CHECK(report["options"]["refined-source"] == refined);
    CHECK(report["vertices_by_state"]["reached"] == made.positions.size());
    // The pair that was written is proven anew, and to a tolerance that it has not been made for.
    const Run check =
        shell("check " + refined + " " + offset + " -d 0.2 --corners round --tolerance 2% --strict --report c.json");
    CHECK(check.code == 0);
    CHECK_THAT(check.out,
               Catch::Contains("100.00 % of the area is certified within 2 % of the distance at every point\n"));
    CHECK(json_of(shell, "c.json")["certified"]["certified"] == 1.0);
    const Run nearer = shell("check " + refined + " " + offset + " -d 0.2 --corners round --tolerance 0.1% --strict");
    CHECK(nearer.code == 3);
    CHECK_THAT(nearer.err, Catch::StartsWith("vdb_offset: " + offset + ": ") && Catch::EndsWith(": expected 100 %\n"));
    CHECK(shell("check " + refined + " " + offset + " -d 0.2 --tolerance 0.1%").code == 0);
    CHECK_THAT(shell("check " + source + " " + offset + " -d 0.2").err, Catch::Contains("--refined-source"));
  }
}

TEST_CASE("tolerance: the refined source keeps what the file has, in any format", "[command][tolerance]") {
  const ShellCommand shell;
  std::ofstream(shell.file("roof.obj")) << "# a roof\nv 0 0 1\nv 4 0 1\nv 0 2 0\nv 4 2 0\nv 0 -2 0\nv 4 -2 0\n"
                                           "g south\nusemtl red\nf 1 5 6 2\ng north\nf 2 4 3 1\nl 1 2\n";
  const Run run = shell("roof.obj out.obj -d 0.3 --tolerance 5% --refined-source refined.obj");
  CHECK(run.code == 0);
  const std::string refined = shell.slurp(shell.file("refined.obj"));
  CHECK_THAT(refined,
             Catch::StartsWith("# a roof\nv 0 0 1\nv 4 0 1\n") && Catch::Contains("\ng south\nusemtl red\nf "));
  const auto without_places = [&](const std::string& name) {
    std::istringstream text(shell.slurp(shell.file(name)));
    std::string kept;
    for (std::string line; std::getline(text, line);)
      if (!line.starts_with("v ")) kept += line + "\n";
    return kept;
  };
  CHECK(without_places("out.obj") == without_places("refined.obj"));
  const Run to_others = shell("roof.obj out.stl -d 0.3 --tolerance 5% --refined-source refined.ply --format obj");
  CHECK(to_others.code == 0);
  CHECK_THAT(to_others.err,
             Catch::Contains("refined.ply: not carried over: ") && Catch::Contains("out.stl: not carried over: "));
  CHECK(mesh_of(shell, "refined.ply").corners == mesh_of(shell, "refined.obj").corners);
  // What the file itself loses when its faces are split is told as well.
  std::ofstream(shell.file("strips.ply"))
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float "
         "y\nproperty float z\nelement tristrips 1\nproperty list int int "
         "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n6 0 2 1 3 0 2\n";
  const Run strips = shell("strips.ply out.ply -d 0.1 --corners round --tolerance 10%");
  CHECK(strips.code == 0);
  CHECK_THAT(strips.err, Catch::Contains("out.ply: not carried over: strips of triangles"));
  CHECK(shell("strips.ply out.ply -d 0.1 --corners round --tolerance 10% -q").err.empty());
}

TEST_CASE("tolerance: a length, distances of each vertex, parts, scenes, and a distance of 0", "[command][tolerance]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("box.obj"), shapes::box(2 * kHalf, 4, false).view());
  const Run length =
      shell("box.obj out.obj -d 0.2 --corners round --tolerance 0.004 --report r.json --refined-source refined.obj");
  CHECK_THAT(length.out,
             Catch::Contains("100.00 % of the area is certified within 0.004 of the distance at every point"));
  CHECK(json_of(shell, "r.json")["certified"]["tolerance_length"] == 0.004);
  CHECK(worst_error(mesh_of(shell, "out.obj"), kHalf, 0.2) < 0.02 + 1e-9);
  CHECK(shell("check refined.obj out.obj -d 0.2 --tolerance 0.004 --strict").code == 0);
  const Run uneven = shell("box.obj out.obj -d '0.2 + 0.05*x' --tolerance 3% --strict");
  INFO(uneven.out << uneven.err);
  CHECK(uneven.code == 0);
  const Run none = shell("box.obj out.obj -d 0 --tolerance 1% --refined-source refined.obj --map map.txt --strict");
  CHECK(none.code == 0);
  CHECK_THAT(none.out, !Catch::Contains("certified"));
  CHECK(shell.slurp(shell.file("out.obj")) == shell.slurp(shell.file("box.obj")));
  CHECK(shell.slurp(shell.file("refined.obj")) == shell.slurp(shell.file("box.obj")));
  CHECK(map_of(shell, "map.txt").empty());
  // A scene is written as plain polygons; its answer is about its own vertices.
  const Run ball = shell("'" + test::scenes_path() +
                         "/cube_out.json' ball.ply --tolerance 2% --refined-source refined.ply --strict");
  INFO(ball.out << ball.err);
  CHECK(ball.code == 0);
  CHECK(mesh_of(shell, "ball.ply").corners == mesh_of(shell, "refined.ply").corners);
  CHECK(shell("check refined.ply ball.ply -d 0.1 --tolerance 2% --strict").code == 0);
  const Run obstacle = shell("box.obj out.obj -d 0.2 --tolerance 2% --obstacle sphere.obj --corners miter");
  CHECK(obstacle.code == 0);
  CHECK_THAT(obstacle.out, Catch::Contains("gap to obstacles") && Catch::Contains("certified within 2 %"));
  const Run one = shell("box.obj one.obj -d 0.2 --tolerance 2% --threads 1 -q"),
            two = shell("box.obj two.obj -d 0.2 --tolerance 2% --threads 2 -q");
  CHECK(one.out.empty());
  CHECK(shell.slurp(shell.file("one.obj")) == shell.slurp(shell.file("two.obj")));
}

TEST_CASE("tolerance: 3 where --max-faces stops it, or --strict asks for what is not there",
          "[command][tolerance][long]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("box.obj"), shapes::box(2 * kHalf, 4, false).view());
  const Run run = shell(
      "box.obj out.obj -d 0.2 --corners round --tolerance 1% --max-faces 200 --refined-source refined.obj "
      "--report r.json");
  CHECK(run.code == 3);
  CHECK_THAT(run.err,
             Catch::StartsWith("vdb_offset: --max-faces: out.obj: expected more faces") && Catch::Contains(" % off\n"));
  CHECK_THAT(
      run.out,
      Catch::Contains(" % of the area is certified within 1 % of the distance at every point") &&
          Catch::Contains(
              "the vertices of 100.00 % of the area reached the distance; what of it is not certified is up to "));
  const Polygons made = mesh_of(shell, "out.obj");
  CHECK(made.face_count() <= 200);
  CHECK(made.corners == mesh_of(shell, "refined.obj").corners);
  const auto certified = json_of(shell, "r.json")["certified"];
  CHECK(certified["out_of_faces"] == true);
  CHECK(certified["certified"].get<double>() < 1);
  CHECK(certified["worst_left"].get<double>() > 0.01);
  CHECK(worst_error(made, kHalf, 0.2) >= certified["worst_left"].get<double>() * (1 - 1e-6));
  CHECK(json_of(shell, "r.json")["options"]["max-faces"] == "200");
  // The summary makes way for a file on standard output.
  const Run map = shell("box.obj out.obj -d 0.2 --tolerance 5% --map -");
  CHECK_THAT(map.out, Catch::StartsWith("# vertex face") && !Catch::Contains("certified"));
  CHECK_THAT(map.err, Catch::Contains("certified within 5 %"));
  // Two plates that are nearer to each other than twice the distance: where vertices cannot be, no faces are wasted.
  const std::string plates = "'" + test::scenes_path() + "/plates_closing.json' out.ply --tolerance 5%";
  CHECK(shell(plates).code == 0);
  const Run strict = shell(plates + " --strict --report r.json");
  CHECK(strict.code == 3);
  CHECK_THAT(strict.err,
             Catch::Contains("fall short of the distance") && Catch::Contains("vdb_offset: out.ply: ") &&
                 Catch::Contains(" is certified within 5 % of the distance at every point: expected 100 %"));
  const auto there = json_of(shell, "r.json")["certified"];
  CHECK(there["there"].get<double>() < 0.7);
  CHECK(there["faces"].get<std::size_t>() < 2 * there["source_faces"].get<std::size_t>());
}

TEST_CASE("tolerance: options that do not go together, and files that clash", "[command][tolerance]") {
  const ShellCommand shell;
  const std::string offset = "sphere.obj out.obj --tolerance 1% ";
  for (const std::string other : {"--shell", "--paths p.obj", "--save-vdb f.vdb", "--dry-run"}) {
    const std::string name = other.substr(0, other.find(' '));
    check_failure(shell, offset + "-d 0.1 " + other, 1, name + " and --tolerance exclude each other");
  }
  check_failure(shell, offset + "--distance-xy 0.1 --distance-z 0.1", 1,
                "--distance-xy and --tolerance exclude each other");
  check_failure(shell, offset + "--fit sphere.obj --clearance 0.1", 1, "--fit and --tolerance exclude each other");
  check_failure(shell, offset + "--layers 3 --first-height 0.1", 1, "--layers and --tolerance exclude each other");
  check_failure(shell, offset + "--heights h.txt", 1, "--heights and --tolerance exclude each other");
  check_failure(shell, offset + "-d 0.1 --mode iso", 1, "--tolerance and --mode iso exclude each other");
  check_failure(shell, offset + "-d 0.1 -d 0.2", 1, "--distance: expected one with --tolerance, got 2");
  for (const std::string other : {"--max-faces 100", "--refined-source r.obj", "--map m.txt"})
    check_failure(shell, "sphere.obj out.obj -d 0.1 " + other, 1,
                  other.substr(0, other.find(' ')) + " needs --tolerance");
  for (const std::string value : {"0", "-1", "0%", "100%", "0.0009%", "-1%", "%", "one", "inf", "1%%", "nan%"})
    check_failure(shell, "sphere.obj out.obj -d 0.1 --tolerance=" + value, 1,
                  "--tolerance: expected a length above 0, or a percentage of the distance from 0.001% to below 100%, "
                  "got '" +
                      value + "'");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --tolerance 1e-9", 2, "tolerance: expected a length from");
  check_failure(shell, offset + "-d 0.1 --max-faces 0", 1, "--max-faces: expected 1 to 2147483647, got '0'");
  check_failure(shell, offset + "-d 0.1 --refined-source r.xyz", 1, "r.xyz: expected a refined source that ends in");
  check_failure(shell, offset + "-d 0.1 --refined-source sphere.obj", 1,
                "--refined-source: expected a file of its own");
  check_failure(shell, offset + "-d 0.1 --refined-source out.obj", 1, "--refined-source: expected a file of its own");
  check_failure(shell, offset + "-d 0.1 --map out.obj", 1, "--map: expected a file of its own");
  // All outputs or none.
  check_failure(shell, offset + "-d 0.1 --refined-source no/such/r.obj", 4, "no/such/r.obj");
  check_failure(shell, offset + "-d 0.1 --map no/such/m.txt", 4, "no/such/m.txt");
  check_failure(shell, offset + "-d 0.1 --refined-source r.obj --map /dev/full", 4, "/dev/full");
  for (const char* const scene : {"shell_cube", "peg_in_socket"})
    check_failure(shell, "'" + test::scenes_path() + "/" + scene + ".json' out.obj --tolerance 1%", 1,
                  "--tolerance: expected a scene without a shell or a fit");
  std::ofstream(shell.file("square.txt")) << "0 0\n1 0\n1 1\n0 1\n0 0\n";
  check_failure(shell, "square.txt out.txt -d 0.1 --tolerance 1%", 1, "--tolerance: expected a mesh");
  check_failure(shell, "check square.txt square.txt --tolerance 1%", 1, "--tolerance: expected meshes");
  check_failure(shell, "check sphere.obj sphere.obj --distance-xy 1 --distance-z 1 --tolerance 1%", 1,
                "--tolerance and --distance-xy exclude each other");
}

namespace {

/// A box of 6 by 18 by 5.5 with a hole along z, as an OBJ: walls of 0.45 in x and 1.85 in y.
void write_frame(const std::string& path) {
  std::ofstream file(path);
  for (const char* const z : {"0", "5.5"})
    file << "v 0 0 " << z << "\nv 6 0 " << z << "\nv 6 18 " << z << "\nv 0 18 " << z << "\nv 0.45 1.85 " << z
         << "\nv 5.55 1.85 " << z << "\nv 5.55 16.15 " << z << "\nv 0.45 16.15 " << z << "\n";
  for (int i = 1; i <= 4; ++i) {
    const int a = i, b = i % 4 + 1;
    file << "f " << a << " " << b << " " << b + 8 << " " << a + 8 << "\nf " << b + 4 << " " << a + 4 << " " << a + 12
         << " " << b + 12 << "\nf " << b << " " << a << " " << a + 4 << " " << b + 4 << "\nf " << a + 8 << " " << b + 8
         << " " << b + 12 << " " << a + 12 << "\n";
  }
}

}  // namespace

TEST_CASE("faces: where a wall is thinner than two distances, no other option is named", "[command][faces]") {
  const ShellCommand shell;
  write_frame(shell.file("frame.obj"));
  const Run thin = shell("frame.obj out.obj -d -0.25 --corners miter --report r.json");
  CHECK_THAT(thin.out,
             Catch::Contains("error is in walls or gaps narrower than two distances. Use a smaller distance"));
  const auto causes = json_of(shell, "r.json")["faces"]["causes"];
  // The walls of 0.45 have most of what is off; both of their sides would be off by a fifth in their planes.
  CHECK(causes["no_room"].get<double>() > 0.5);
  CHECK(causes["stuck"] == 0.0);
  double sum = 0;
  for (const auto& cause : causes) sum += cause.get<double>();
  CHECK(sum == Approx(1));
  CHECK_THAT(shell("frame.obj out.obj -d -0.22 --corners miter").out, !Catch::Contains("error is"));
  // Likewise of curves.
  std::ofstream(shell.file("frame.txt")) << "0 0\n6 0\n6 18\n0 18\n0 0\n\n0.45 1.85\n0.45 16.15\n5.55 16.15\n"
                                            "5.55 1.85\n0.45 1.85\n";
  CHECK_THAT(shell("frame.txt out.txt -d -0.25").out,
             Catch::Contains("segments' error is in walls or gaps narrower than two distances"));
}

TEST_CASE("faces: beside vertices that cannot move, no smaller distance is named", "[command][faces][obstacles]") {
  const ShellCommand shell;
  io::write_mesh(shell.file("box.obj"), shapes::box(Vec3d(1), 1, false).view());
  for (const bool touches : {true, false}) {
    Polygons above = shapes::box(Vec3d(3, 3, 0.2), 1, false);
    for (Vec3d& p : above.positions) p[2] += 0.6 + (touches ? 0 : 0.05);
    io::write_mesh(shell.file("above.obj"), above.view());
    const Run run = shell("box.obj out.obj -d 0.1 --obstacle above.obj");
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains(touches ? "is at vertices that have no room at any distance\n"
                                                : "is at vertices that fall short. Use a smaller distance") &&
                            !Catch::Contains(touches ? "a smaller distance" : "at any distance"));
  }
}

TEST_CASE("tolerance: how far off the worst of all faces is, is said beside what is certified",
          "[command][tolerance]") {
  const ShellCommand shell;
  // The sides that face each other stop halfway between.
  io::write_mesh(shell.file("plates.obj"), shapes::plates(1, 0.2, 0.06, 4).view());
  const Run run = shell("plates.obj out.obj -d 0.06 -v --tolerance 1% --refined-source refined.obj --report r.json");
  CHECK_THAT(run.out, Catch::Contains("the worst of all faces is up to "));
  const auto certified = json_of(shell, "r.json")["certified"];
  CHECK(certified["worst"].get<double>() >= 0.5);
  CHECK(certified["worst"].get<double>() >= certified["worst_left"].get<double>());
  CHECK(certified["source_crossings"] == 0);
  const Run check = shell("check refined.obj out.obj -d 0.06 --tolerance 1% --report c.json");
  CHECK_THAT(check.out, Catch::Contains("the worst of all faces is up to "));
  CHECK(json_of(shell, "c.json")["certified"]["worst"].get<double>() == Approx(certified["worst"].get<double>()));
}

TEST_CASE("tolerance: a share in the place of a percentage is refused", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj out.obj -d 0.1 --tolerance 1% --strict-certified 0.99", 1,
                "--strict-certified: expected a percentage from 1 to 100, got '0.99'");
}

TEST_CASE("check: what is on the wrong side is not there", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 -q").code == 0);
  CHECK_THAT(shell("check sphere.obj out.obj -d -0.1").out,
             Catch::StartsWith("distance    -0.1: 0.000 % of 642 vertices there, 0 beyond, 642 on the wrong side"));
}
