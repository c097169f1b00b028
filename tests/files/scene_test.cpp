// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/scene.h"
#include "vdb_offset/shapes.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "space/surface/surface.h"
#include "support/oracles.h"
#include "support/places.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

/// A file of that content that is gone when the test is over.
struct TemporaryFile {
  std::string path = (std::filesystem::temp_directory_path() / "vdb_offset_scene_test.json").string();
  explicit TemporaryFile(const std::string& text) { std::ofstream(path) << text; }
  ~TemporaryFile() { std::filesystem::remove(path); }
};

scene::Scene read(const std::string& text) { return scene::read_scene(TemporaryFile(text).path); }

}  // namespace

TEST_CASE("scenes: every one runs as it expects", "[scene][no_races]") {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::scenes_path())) {
    if (!scene::is_scene(entry.path().string())) continue;  // a model to try things with
    INFO(entry.path().string());
    const scene::Scene scene = scene::read_scene(entry.path().string());
    REQUIRE(scene.mesh_path.empty());
    OffsetOptions options;
    options.distance =
        distances_of(scene.distance, scene.shape.view(), {[&] { return vertex_normals(scene.shape.view()); }, {}, {}});
    scene.set(options);
    const bool fits = scene.to_fit.face_count() > 0;
    CHECK(fits == scene.expect.min_gap.has_value());
    const OffsetResult result = fits ? fit(scene.shape.view(), scene.to_fit.view(), scene.clearance, options)
                                     : offset(scene.shape.view(), options);
    CHECK(scene::unmet(scene.expect, scene.shape.view(), result) == std::vector<std::string>{});
    CHECK(scene.shell == scene.expect.volume.has_value());
    if (scene.shell)
      CHECK(scene::unmet(scene.expect, shell_of(scene.shape.view(), result, options).facts) ==
            std::vector<std::string>{});
    CHECK(scene.expect.min_reached);
    ++count;
  }
  CHECK(count >= 28);
}

TEST_CASE("scenes: corners are mitered up to a limit, and faces expected at the distance", "[scene]") {
  const std::string cube = R"({"shape": {"type": "cube", "side": 1, "divisions": 2}, "offset": {"distance": 0.1)",
                    expected = R"(}, "expect": {"max_face_error": 0.01}})";
  const auto run = [&](const std::string& more) {
    const scene::Scene scene = read(cube + more + expected);
    OffsetOptions options;
    options.distance = scene.distance.value;
    scene.set(options);
    return scene::unmet(scene.expect, scene.shape.view(), offset(scene.shape.view(), options));
  };
  for (const char* const more :
       {"", R"(, "corners": "miter")", R"(, "corners": "miter", "miter_limit": 1.8)", R"(, "miter_limit": 1.8)"})
    CHECK(run(more).empty());
  for (const char* const more :
       {R"(, "corners": "miter", "miter_limit": 1.6)", R"(, "miter_limit": 1.6)", R"(, "corners": "round")"}) {
    const std::vector<std::string> unmet = run(more);
    REQUIRE(unmet.size() == 1);
    CHECK_THAT(unmet[0], Catch::StartsWith("expected 99 % of the faces' area within a share of 0.01"));
  }
  CHECK_THROWS_WITH(run(R"(, "corners": "sharp")"), Catch::Contains("corners among round, miter"));
  CHECK_THROWS_WITH(run(R"(, "corners": "round", "miter_limit": 2)"), Catch::Contains("no 'miter_limit'"));
  CHECK_THROWS_WITH(run(R"(, "corners": "miter", "miter_limit": 0.5)"), Catch::Contains("of 1 or more"));
}

TEST_CASE("scenes: an expectation that does not hold is told", "[scene][oracle]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  OffsetOptions options;
  options.distance = 0.1;
  const OffsetResult result = offset(sphere.view(), options);
  scene::Expectations expect;
  expect.max_reached = 0.5;
  expect.max_position_error = 1e-3;
  expect.answer = scene::Answer{};
  expect.answer->radius = 1.2;
  CHECK(scene::unmet(expect, sphere.view(), result).size() == 2);
  expect.max_reached = 1;
  expect.answer->radius = 1.1;
  CHECK(scene::unmet(expect, sphere.view(), result).empty());

  ShellFacts shell = shell_of(sphere.view(), result, options).facts;
  expect.volume = shell.volume * 1.02;
  expect.max_volume_error = 0.01;
  CHECK(scene::unmet(expect, shell).size() == 1);
  expect.max_volume_error = 0.03;
  CHECK(scene::unmet(expect, shell).empty());
  shell.closed = shell.oriented = false;
  shell.non_manifold_edges = shell.crossings = 1;
  CHECK(scene::unmet(expect, shell).size() == 4);
}

TEST_CASE("shapes: closed ones are closed, oriented outwards and of the right volume", "[scene]") {
  const double pi = 3.14159265358979;
  struct Case {
    const char* name;
    Polygons mesh;
    double volume, tolerance;
  };
  const Case cases[] = {{"icosphere", shapes::icosphere(1, 5), 4 * pi / 3, 0.01},
                        {"uv_sphere", shapes::uv_sphere(1, 96, 48), 4 * pi / 3, 0.01},
                        {"box", shapes::box(Vec3d(1, 2, 3), 4, false), 6, 1e-12},
                        {"torus", shapes::torus(1, 0.4, 160, 80), 2 * pi * pi * 0.16, 0.01},
                        {"cylinder", shapes::cylinder(0.5, 2, 96, 3, 4), pi / 2, 0.01},
                        {"socket", shapes::socket(1, 2, 0.5, 96, 3), pi * (2.25 * 2.5 - 2), 0.03},
                        {"plates", shapes::plates(1, 0.1, 0.1, 4), 0.2, 1e-12},
                        {"naca_wing", shapes::naca_wing("0012", 1, 2, 100, 4), 2 * 0.0817, 0.003},
                        {"naca_wing, cambered", shapes::naca_wing("4415", 1, 1, 100, 4), 0.102, 0.004},
                        {"gear", shapes::gear(12, 0.8, 1, 0.3, 0.5, 2), 0.5 * pi * 0.73, 0.06},
                        {"bumpy_sphere", shapes::bumpy_sphere(1, 0.1, 1, 1, 4), 4 * pi / 3, 0.5},
                        {"hollow_box", shapes::hollow_box(1, 0.1, 5), 1 - 0.512, 1e-12}};
  for (const Case& c : cases) {
    INFO(c.name);
    const MeshFacts facts = build_surface(c.mesh.view(), {}).facts;
    CHECK(facts.closed());
    CHECK(facts.oriented());
    CHECK(facts.degenerate_faces == 0);
    CHECK(facts.unused_vertices == 0);
    CHECK(std::abs(test::enclosed_volume(c.mesh) - c.volume) < c.tolerance);
  }
}

TEST_CASE("shapes: open ones face the way they say", "[scene]") {
  const auto faces_towards = [](const Polygons& mesh, const Vec3d& inside) {
    Surface surface = build_surface(mesh.view(), {});
    to_local_frame(surface, surface.facts.diagonal / 64);
    std::size_t away = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      away += surface.triangle_normals[t].dot(inside - surface.origin - surface.vertices[surface.triangles[t][0]]) <= 0;
    return away == 0 && surface.facts.oriented() && !surface.facts.closed();
  };
  CHECK(faces_towards(shapes::wedge(60, 1, 1, 4), {0, 0, 0.8}));
  CHECK(faces_towards(shapes::room_corner(1, 4), {0.5, 0.5, 0.5}));
  CHECK(faces_towards(shapes::diffuser(0.4, 0.8, 2, 4), {1, 0, 0}));
  CHECK(faces_towards(shapes::patch(1, 0.01, 8), {0, 0, 1}));
}

TEST_CASE("shapes: the same seed makes the same shape, another seed another", "[scene]") {
  CHECK(shapes::bumpy_sphere(1, 0.2, 1, 7, 2).positions == shapes::bumpy_sphere(1, 0.2, 1, 7, 2).positions);
  CHECK_FALSE(shapes::bumpy_sphere(1, 0.2, 1, 7, 2).positions == shapes::bumpy_sphere(1, 0.2, 1, 8, 2).positions);
}

TEST_CASE("shapes: sizes out of range are refused", "[scene]") {
  CHECK_THROWS_AS(shapes::icosphere(-1, 2), InvalidInput);
  CHECK_THROWS_AS(shapes::icosphere(1, 40), InvalidInput);
  CHECK_THROWS_AS(shapes::box(Vec3d(1, 0, 1), 2, true), InvalidInput);
  CHECK_THROWS_AS(shapes::torus(1, 2, 8, 8), InvalidInput);
  CHECK_THROWS_AS(shapes::naca_wing("24x2", 1, 1, 20, 2), InvalidInput);
  CHECK_THROWS_AS(shapes::naca_wing("2400", 1, 1, 20, 2), InvalidInput);
  CHECK_THROWS_AS(shapes::gear(2, 1, 2, 0.5, 1, 1), InvalidInput);
  CHECK_THROWS_AS(shapes::hollow_box(1, 0.6, 2), InvalidInput);
  CHECK_THROWS_AS(shapes::wedge(200, 1, 1, 2), InvalidInput);
}

TEST_CASE("scenes: distances are numbers or percentages", "[scene]") {
  CHECK(parse_distance("0.25").in_world_units(10) == 0.25);
  CHECK(parse_distance("-1.5%").in_world_units(10) == Approx(-0.15));
  CHECK(parse_distance("+1e-3").in_world_units(10) == 1e-3);
  for (const char* text : {"", "%", "abc", "1 %", "1%%", "nan", "inf", "0x10", "1e999", "1,5", "--1"})
    CHECK_THROWS_AS(parse_distance(text), InvalidInput);
}

TEST_CASE("scenes: what is no scene is told with its key", "[scene]") {
  const std::string shape = R"("shape": {"type": "icosphere", "radius": 1, "subdivisions": 1})";
  CHECK(read("{" + shape + R"(, "offset": {"distance": "1%"}})").distance.percent);
  CHECK_THROWS_WITH(read("{"), Catch::Contains("expected JSON"));
  CHECK_THROWS_WITH(read("[]"), Catch::Contains("an object"));
  CHECK_THROWS_WITH(read(R"({"offset": {"distance": 1}})"), Catch::Contains("'shape'"));
  CHECK_THROWS_WITH(read("{" + shape + "}"), Catch::Contains("'offset'"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": "foo"}})"), Catch::Contains("unknown name"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": 1, "extra": 2}})"),
                    Catch::Contains("'offset.extra'"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": 1}, "typo": 1})"), Catch::Contains("'typo'"));
  CHECK_THROWS_WITH(read(R"({"shape": {"type": "blob"}, "offset": {"distance": 1}})"), Catch::Contains("icosphere"));
  CHECK_THROWS_WITH(
      read(R"({"shape": {"type": "icosphere", "radius": "a", "subdivisions": 1}, "offset": {"distance": 1}})"),
      Catch::Contains("'shape.radius'"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": 1}, "expect": {"max_position_error": 1}})"),
                    Catch::Contains("an answer"));
  CHECK_THROWS_WITH(
      read("{" + shape + R"(, "offset": {"distance": 1}, "expect": {"volume": 1, "max_volume_error": 0.1}})"),
      Catch::Contains("offset.shell"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": 1, "shell": true}, "expect": {"volume": 1}})"),
                    Catch::Contains("max_volume_error"));
  CHECK_THROWS_WITH(read("{" + shape + R"(, "offset": {"distance": 1}, "grid": {"solver": "magic"}})"),
                    Catch::Contains("eikonal"));
  CHECK_THROWS_AS(scene::read_scene("/nonexistent.json"), ReadError);
}
