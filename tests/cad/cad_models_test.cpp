// SPDX-License-Identifier: Apache-2.0
// CAD files as they come out of the worker, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "cad/cad_files.h"
#include "vdb_offset/io/mesh_file.h"

using namespace vdb_offset;
using io::CadEdge;
using io::CadMesh;
using test::open_cad;

namespace {

constexpr double kPi = std::numbers::pi;

/// How many edges have one triangle, and how many have other than two that go along it in two directions.
struct EdgeFaults {
  std::size_t open = 0, others = 0;
};

EdgeFaults edge_faults(const CadMesh& mesh) {
  std::map<std::array<std::uint32_t, 2>, std::array<int, 2>> ways;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      ++ways[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
    }
  EdgeFaults faults;
  for (const auto& [edge, count] : ways) {
    if (count[0] + count[1] == 1) ++faults.open;
    else if (count != std::array<int, 2>{1, 1}) ++faults.others;
  }
  return faults;
}

void check_closed(const CadMesh& mesh) {
  const EdgeFaults faults = edge_faults(mesh);
  CHECK(faults.open == 0);
  CHECK(faults.others == 0);
}

double volume(const CadMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]]));
  return six / 6;
}

Vec3d corner(const CadMesh& mesh, std::size_t c) { return mesh.positions[mesh.triangles[c / 3][c % 3]]; }

/// The most that corners, or their normals, are off what `expected(corner)` says.
template <class Expected>
double most_off(const CadMesh& mesh, const std::vector<Vec3d>& found, Expected&& expected) {
  double most = 0;
  for (std::size_t c = 0; c < found.size(); ++c) most = std::max(most, (found[c] - expected(c)).length());
  return mesh.triangles.empty() ? 1e300 : most;
}

std::size_t count(const CadMesh& mesh, CadEdge kind) {
  return static_cast<std::size_t>(std::count(mesh.edge_kinds.begin(), mesh.edge_kinds.end(), kind));
}

/// Errors of points at a distance along the normals of all corners.
std::vector<double> errors_at(io::CadWorker& worker, double distance, double told) {
  const CadMesh& mesh = worker.mesh();
  std::vector<io::CadPoint> points;
  for (std::size_t c = 0; c < mesh.corner_normals.size(); ++c) {
    const Vec3d at = corner(mesh, c) + distance * mesh.corner_normals[c];
    const auto& uv = mesh.corner_parameters[c];
    points.push_back({at.x(), at.y(), at.z(), uv[0], uv[1], told, mesh.face_of[c / 3]});
  }
  return worker.distance_errors(points);
}

}  // namespace

TEST_CASE("cad: a block with a hole and a fillet is closed, with its edges as modelled", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh mesh = open_cad("block.step").take_mesh();
  check_closed(mesh);
  CHECK(mesh.faces.size() == 8);
  CHECK(mesh.remarks.empty());
  CHECK(mesh.has_unit);
  CHECK(mesh.unit_micrometres == 1000);
  // The mesh's volume: the hole's polygon is inside of it, the fillet's as well; both by the deflection at most.
  const double exact = 40 * 30 * 20 - kPi * 25 * 20 - (4 * 4 - kPi * 4) * 20;
  CHECK(std::abs(volume(mesh) - exact) < 0.01 * 20 * (2 * kPi * 5 + 2 * kPi));
  // Tangent are the two lines where the fillet ends, and the hole's seam; sharp is all else.
  std::set<std::pair<double, double>> lines;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const Vec3d &a = mesh.positions[mesh.edges[e][0]], &b = mesh.positions[mesh.edges[e][1]];
    if (mesh.edge_kinds[e] != CadEdge::Tangent) continue;
    CHECK(std::hypot(a.x() - b.x(), a.y() - b.y()) < 1e-9);
    lines.insert({std::round(a.x()), std::round(a.y())});
  }
  CHECK(lines == std::set<std::pair<double, double>>{{0, 4}, {4, 0}, {25, 15}});
  CHECK(count(mesh, CadEdge::Tangent) == 3);
  CHECK(std::is_sorted(mesh.edges.begin(), mesh.edges.end()));
  const auto upright = std::count_if(mesh.faces.begin(), mesh.faces.end(),
                                     [](const io::CadFaceFacts& face) { return face.kind == "cylinder"; });
  CHECK(upright == 2);
}

TEST_CASE("cad: a sphere's vertices, normals and parameters are those of the formula", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh mesh = open_cad("sphere.brep").take_mesh();
  check_closed(mesh);
  CHECK_FALSE(mesh.has_unit);
  const Vec3d centre(1, 2, 3);
  std::vector<Vec3d> corners;
  for (std::size_t c = 0; c < 3 * mesh.triangles.size(); ++c) corners.push_back(corner(mesh, c));
  CHECK(most_off(mesh, mesh.corner_normals, [&](std::size_t c) { return (corners[c] - centre) / 10; }) < 1e-14);
  CHECK(most_off(mesh, corners, [&](std::size_t c) {
          const auto [u, v] = mesh.corner_parameters[c];
          return centre + 10 * Vec3d(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
        }) < 1e-13);
  // The seam's two sides are one row of vertices, with the parameters 0 and 2 pi; each pole is one vertex.
  std::set<std::uint32_t> poles, left, right;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t vertex = mesh.triangles[c / 3][c % 3];
    if (std::abs(std::abs(corners[c].z() - 3) - 10) < 1e-9) poles.insert(vertex);
    else if (std::abs(mesh.corner_parameters[c][0]) < 1e-9) left.insert(vertex);
    else if (std::abs(mesh.corner_parameters[c][0] - 2 * kPi) < 1e-9) right.insert(vertex);
  }
  CHECK(poles.size() == 2);
  CHECK(left == right);
  CHECK(left.size() > 5);
  CHECK(count(mesh, CadEdge::Tangent) == mesh.edges.size());
  CHECK(volume(mesh) < 4 * kPi * 1000 / 3);
  CHECK(volume(mesh) > 4 * kPi * 1000 / 3 - 0.01 * 4 * kPi * 100);
}

TEST_CASE("cad: no edge or triangle is farther from its face than the deflection", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  // OpenCASCADE's own triangles of this one are: it is a sphere of a B-spline.
  for (const double deflection : {0.1, 0.03}) {
    const CadMesh mesh = open_cad("spline.brep", deflection).take_mesh();
    check_closed(mesh);
    double most = 0;
    const auto note = [&](const Vec3d& at) { most = std::max(most, 10 - (at - Vec3d(1, 2, 3)).length()); };
    for (const auto& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) note((mesh.positions[t[k]] + mesh.positions[t[(k + 1) % 3]]) / 2);
      note((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3);
    }
    CHECK(most < 1.02 * deflection);  // across the face's normal, which is not quite the triangle's
    CHECK(mesh.remarks.empty());
  }
}

TEST_CASE("cad: at the apex of a cone each triangle has the normal of its own side", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh mesh = open_cad("cone.brep").take_mesh();
  check_closed(mesh);
  std::set<std::uint32_t> apex;
  double least = 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.faces[mesh.face_of[t]].kind != "cone") continue;
    const Vec3d a = mesh.positions[mesh.triangles[t][0]];
    Vec3d flat = (mesh.positions[mesh.triangles[t][1]] - a).cross(mesh.positions[mesh.triangles[t][2]] - a);
    flat.normalize();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& normal = mesh.corner_normals[3 * t + k];
      CHECK(normal.z() == Approx(0.6));  // of a cone of height 8 on a radius of 6
      if (mesh.positions[mesh.triangles[t][k]].z() < 8 - 1e-9) continue;
      apex.insert(mesh.triangles[t][k]);
      least = std::min(least, normal.dot(flat));
    }
  }
  CHECK(apex.size() == 1);
  CHECK(least > 0.999);
}

TEST_CASE("cad: distances to surfaces are exact, and tell of points that are off", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  for (const char* name : {"block.step", "sphere.brep", "cone.brep", "torus.brep"})
    for (const double distance : {0.01, -0.5}) {
      if (distance < 0 && name == std::string("cone.brep")) continue;  // inward, the apex is past the axis at once
      INFO(name << ' ' << distance);
      io::CadWorker worker = open_cad(name, 0.1);
      const std::vector<double> exact = errors_at(worker, distance, distance), off = errors_at(worker, distance, 0.25);
      CHECK(*std::max_element(exact.begin(), exact.end()) < 1e-9 * std::abs(distance));
      for (const double error : off) REQUIRE(error == Approx(std::abs(0.25 - std::abs(distance))));
    }
  io::CadWorker worker = open_cad("spline.brep", 0.1);
  const std::vector<double> errors = errors_at(worker, 0.3, 0.3);
  CHECK(*std::max_element(errors.begin(), errors.end()) < 1e-9 * 0.3);
  const io::CadPoint of_no_face{0, 0, 0, 0, 0, 1, 99};
  CHECK_THROWS_WITH(worker.distance_errors({&of_no_face, 1}),
                    "spline.brep: expected points of 1 faces, got one of face 100");
}

TEST_CASE("cad: an assembly has its parts where they are placed, with names, colours and layers", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh mesh = open_cad("assembly.step").take_mesh();
  check_closed(mesh);
  CHECK(mesh.positions.size() == 16);
  REQUIRE(mesh.faces.size() == 12);
  Vec3d low(1e9), high(-1e9);
  for (const Vec3d& at : mesh.positions)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
  CHECK((low - Vec3d(-20, 0, 0)).length() < 1e-9);
  CHECK((high - Vec3d(110, 20, 30)).length() < 1e-9);
  for (const std::size_t first : {0, 6}) {
    const io::CadFaceFacts &front = mesh.faces[first], &other = mesh.faces[first + 1];
    CHECK(front.name == "front");
    CHECK(front.layer == "painted");
    CHECK(front.solid == "peg");
    REQUIRE(front.colour);
    CHECK((*front.colour)[0] == Approx(1));
    CHECK(std::abs((*front.colour)[1]) < 1e-6);
    CHECK(other.name.empty());
    CHECK(other.layer.empty());
    REQUIRE(other.colour);
    CHECK((*other.colour)[1] == Approx(0.5).margin(1e-3));
    CHECK(other.kind == "plane");
  }
}

TEST_CASE("cad: what is placed has the name and colour of its place, be it meant in one of its assembly's alone",
          "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh mesh = open_cad("robot.step").take_mesh();
  REQUIRE(mesh.faces.size() == 8 * 6);
  const std::array<double, 3> red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1};
  struct Pin {
    const char *instance, *arm;
    std::array<double, 3> colour;
  };
  const Pin pins[] = {{"upper pin", "left arm", red},      {"blue pin", "left arm", blue},
                      {"lower pin", "left arm", red},      {"left arm", "left arm", red},
                      {"upper pin", "right arm", red},     {"blue pin", "right arm", blue},
                      {"the cut pin", "right arm", green}, {"right arm", "right arm", red}};
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    INFO(f);
    const io::CadFaceFacts& face = mesh.faces[f];
    const Pin& pin = pins[f / 6];
    CHECK(face.name == (f % 6 == 0 ? "front" : ""));
    CHECK(face.solid == "pin");
    CHECK(face.instance == pin.instance);
    std::set<std::string> within{"robot", "arm", "pin", pin.arm, pin.instance};
    if (f / 6 == 6) within.insert("lower pin");
    CHECK(std::set<std::string>(face.within.begin(), face.within.end()) == within);
    REQUIRE(face.colour);
    for (std::size_t k = 0; k < 3; ++k) CHECK((*face.colour)[k] == Approx(pin.colour[k]).margin(1e-6));
  }
}

TEST_CASE("cad: the name of a place chooses its faces, and is in their groups", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const io::MeshFile robot = io::read_mesh((test::cad_files().folder() / "robot.step").string());
  const auto chosen = [&](const std::string& name) {
    std::set<std::size_t> pins;
    const std::vector<std::uint8_t> marks = io::select_faces(robot, std::vector{io::parse_selector("name=" + name)});
    for (std::size_t t = 0; t < marks.size(); ++t)
      if (marks[t]) pins.insert(t / 12);  // two triangles to each side
    return pins;
  };
  using Pins = std::set<std::size_t>;
  CHECK(chosen("left arm") == Pins{0, 1, 2, 3});
  CHECK(chosen("upper pin") == Pins{0, 4});
  CHECK(chosen("lower pin") == Pins{2, 6});
  CHECK(chosen("the cut pin") == Pins{6});
  CHECK(chosen("robot").size() == 8);
  CHECK_THROWS_WITH(chosen("third arm"), Catch::Contains("expected a name among ") && Catch::Contains("left arm"));
  const std::vector<std::uint8_t> of_group =
      io::select_faces(robot, std::vector{io::parse_selector("group=face_37_the_cut_pin_front")});
  CHECK(std::count(of_group.begin(), of_group.end(), 1) == 2);
}

TEST_CASE("cad: coordinates are those of the file, in its own unit", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  struct Case {
    const char* name;
    double micrometres;
    Vec3d size;
  };
  for (const Case& expected : {Case{"inch.stp", 25400, Vec3d(2, 3, 4)}, Case{"metre.step", 1e6, Vec3d(2, 3, 4)},
                               Case{"faces.igs", 25400, Vec3d(1, 2, 3)}}) {
    INFO(expected.name);
    const CadMesh mesh = open_cad(expected.name).take_mesh();
    CHECK(mesh.has_unit);
    CHECK(mesh.unit_micrometres == Approx(expected.micrometres));
    CHECK(mesh.positions.size() == 8);
    CHECK(mesh.triangles.size() == 12);
    Vec3d high(-1e9);
    for (const Vec3d& at : mesh.positions)
      for (int k = 0; k < 3; ++k) high[k] = std::max(high[k], at[k]);
    CHECK((high - expected.size).length() < 1e-12);
    CHECK(volume(mesh) == Approx(expected.size.x() * expected.size.y() * expected.size.z()));
    check_closed(mesh);
  }
}

TEST_CASE("cad: a face that OpenCASCADE finds no triangles for has those of a grid", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh cone = open_cad("missed_seam.brep").take_mesh();
  check_closed(cone);
  CHECK(cone.remarks.empty());
  CHECK(cone.faces.size() == 3);
  // Triangles lie inside of the cone, by the deflection at most.
  const double exact = kPi * 6 / 3 * (144 + 72 + 36);
  CHECK(volume(cone) <= exact * (1 + 1e-9));
  CHECK(volume(cone) > exact - 0.01 * kPi * (12 + 6) * std::hypot(6, 6));
}

TEST_CASE("cad: what is open is sewn and told, and no more", "[cad]") {
  REQUIRE(test::cad_files().is_made());
  const CadMesh faces = open_cad("faces.igs").take_mesh();
  REQUIRE(faces.remarks.size() >= 1);
  CHECK_THAT(faces.remarks[0], Catch::Contains("24 of 24 open edges of faces are closed by sewing them"));
  CHECK(count(faces, CadEdge::Sharp) == 12);
  // Solids that touch are closed, each.
  const CadMesh touching = open_cad("touching.step").take_mesh();
  check_closed(touching);
  CHECK(touching.positions.size() == 16);
  CHECK(touching.remarks.empty());
  const CadMesh open = open_cad("open.brep").take_mesh();
  CHECK(edge_faults(open).open == 4);
  CHECK(open.faces.size() == 5);
  REQUIRE(open.remarks.size() == 1);
  CHECK_THAT(open.remarks[0], Catch::Contains("faces that the file has twice in one place are taken once"));
  const CadMesh turned = open_cad("inside_out.brep").take_mesh();
  CHECK(volume(turned) == Approx(8));
  for (std::size_t c = 0; c < turned.corner_normals.size(); ++c)
    CHECK((corner(turned, c) - Vec3d(1, 1, 1)).dot(turned.corner_normals[c]) > 0.99);
  CHECK(turned.remarks == std::vector<std::string>{"6 faces are turned round"});
}
