// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/offset.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/oracles.h"
#include "vdb_offset/openmesh.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using test::judge;
using test::position_errors;
using test::share;

namespace {

/// With every vertex at the distance.
OffsetOptions by(double distance) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = Corners::Round;
  return options;
}

OffsetOptions merged(OffsetOptions options) {
  options.collision = Collision::Merge;
  return options;
}

OffsetOptions by(double distance, double voxel_size) {
  OffsetOptions options = by(distance);
  options.grid.voxel_size = voxel_size;
  return options;
}

Vec3d clamp_to_cube(const Vec3d& x, double half) {
  return {std::clamp(x[0], -half, half), std::clamp(x[1], -half, half), std::clamp(x[2], -half, half)};
}

/// The guarantee of every run, judged by brute force on some of the vertices.
void check_guarantee(PolygonView mesh, const OffsetResult& result, double distance, std::size_t stride,
                     bool closed = true) {
  const auto errors = judge(mesh, result, distance, stride, closed);
  CHECK(errors.worst_reached <= 1e-6);
  CHECK(errors.worst_beyond <= 1e-6);
  CHECK(errors.worst_told <= 1e-9);
  CHECK(errors.wrong_side == 0);
}

Polygons transformed(Polygons mesh, auto&& map) {
  for (Vec3d& p : mesh.positions) p = map(p);
  return mesh;
}

/// Coordinates on a lattice of 2^-20, so that moving and doubling them rounds nothing.
Polygons dyadic(Polygons mesh) {
  return transformed(std::move(mesh), [](const Vec3d& p) {
    return Vec3d(std::round(p[0] * 0x1p20), std::round(p[1] * 0x1p20), std::round(p[2] * 0x1p20)) * 0x1p-20;
  });
}

}  // namespace

TEST_CASE("offset: sphere of the paper's size, both ways, three voxel sizes", "[offset][long]") {
  const Polygons sphere = shapes::icosphere(0.5, 6);
  REQUIRE(sphere.positions.size() == 40962);
  for (const double distance : {0.1, -0.1})
    for (const double h : {0.05, 0.025, 0.0125}) {
      const OffsetResult result = offset(sphere.view(), by(distance, h));
      CHECK(share(result, VertexState::Reached) == 1);
      // The facets of this sphere deviate from it by 3e-5; the bar is 1e-3.
      CHECK(position_errors(sphere.view(), result, [&](const Vec3d& x) { return x.unit() * (0.5 + distance); }).worst <
            1e-4);
      check_guarantee(sphere.view(), result, distance, 4001);
    }
}

TEST_CASE("offset: the paper's cube, inward", "[offset][no_races]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 83, true);
  for (const double h : {0.05, 0.025, 0.0125}) {
    const OffsetResult result = offset(cube.view(), merged(by(-0.1, h)));
    CHECK(share(result, VertexState::Reached) == 1);
    CHECK(position_errors(cube.view(), result, [](const Vec3d& x) { return clamp_to_cube(x, 0.15); }).worst <= 1e-9);
    check_guarantee(cube.view(), result, -0.1, 2003);
  }
}

TEST_CASE("offset: paths lead from where vertices stood to where they are, and rise all the way", "[offset]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 21, true);
  for (const bool merge : {false, true}) {
    OffsetOptions options = by(-0.1, 0.025);
    if (merge) options = merged(options);
    CHECK(offset(cube.view(), options).paths.empty());
    options.keep_paths = true;
    options.threads = 1;
    const OffsetResult result = offset(cube.view(), options);
    options.threads = 4;
    CHECK(offset(cube.view(), options).paths == result.paths);
    const auto depth = [](const Vec3d& x) { return 0.25 - std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}); };
    REQUIRE(result.paths.size() == cube.positions.size());
    std::size_t long_ones = 0;
    for (std::size_t v = 0; v < result.paths.size(); ++v) {
      const auto& path = result.paths[v];
      REQUIRE(path.size() >= 2);
      CHECK(path.front() == cube.positions[v]);
      CHECK(path.back() == result.positions[v]);
      long_ones += path.size() > 4;
      for (std::size_t i = 1; merge && i < path.size(); ++i) CHECK(depth(path[i]) > depth(path[i - 1]));
    }
    // Along ridges between planes corners alone are kept.
    CHECK(long_ones > result.paths.size() / (merge ? 10 : 2));
  }
}

TEST_CASE("offset: several distances have a path each, and who stays has none", "[offset]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 11, true);
  std::vector<double> some(cube.positions.size(), -0.05);
  some.front() = 0;
  const Distances distances[] = {Distances(-0.03), Distances(some), Distances(0.0)};
  OffsetOptions options;
  options.keep_paths = true;
  const std::vector<OffsetResult> results = offset_several(cube.view(), distances, options);
  for (const OffsetResult& result : results)
    for (std::size_t v = 0; v < cube.positions.size(); ++v) {
      CHECK(result.paths[v].front() == cube.positions[v]);
      CHECK(result.paths[v].back() == result.positions[v]);
    }
  CHECK(results[1].paths.front().size() == 1);
  CHECK(results[2].paths.back().size() == 1);
}

TEST_CASE("offset: cube, outward, keeps corners and edges in place", "[offset][no_races]") {
  const Polygons cube = shapes::box(Vec3d(0.5), 20, true);
  for (const double h : {0.05, 0.025, 0.0125}) {
    const OffsetResult same = offset(cube.view(), by(0.1, h));
    CHECK(share(same, VertexState::Reached) == 1);
    CHECK(same.statistics.straight_vertices == cube.positions.size());
    CHECK(same.positions == offset(cube.view(), by(0.1, 0.05)).positions);  // no grid's guess in it
  }
  const OffsetResult result = offset(cube.view(), by(0.1));
  for (std::size_t v = 0; v < cube.positions.size(); ++v) {
    const Vec3d way = result.positions[v] - cube.positions[v];
    CHECK(way.length() == Approx(0.1).epsilon(1e-6));
    for (int k = 0; k < 3; ++k)
      if (std::abs(cube.positions[v][k]) < 0.25 - 1e-9) CHECK(std::abs(way[k]) < 1e-12);  // no drift along a face
  }
  check_guarantee(cube.view(), result, 0.1, 37);
}

TEST_CASE("offset: a cube is a larger or smaller cube by default", "[offset][miter]") {
  for (const int divisions : {1, 5})
    for (const double distance : {0.1, -0.1}) {
      const Polygons cube = shapes::box(Vec3d(1), divisions, true);
      const OffsetResult result = offset(cube.view(), {.distance = distance});
      double worst = 0;
      for (std::size_t v = 0; v < cube.positions.size(); ++v)
        for (int k = 0; k < 3; ++k) {
          const double from = cube.positions[v][k], side = std::copysign(0.5 + distance, from);
          if (std::abs(from) == 0.5) worst = std::max(worst, std::abs(result.positions[v][k] - side));
        }
      CHECK(worst <= 1e-12);
      CHECK(result.statistics.faces.worst <= 1e-9);
    }
}

TEST_CASE("offset: torus, both ways", "[offset][no_races]") {
  const Polygons torus = shapes::torus(1, 0.4, 160, 64);
  for (const double distance : {0.15, -0.15}) {
    const OffsetResult result = offset(torus.view(), by(distance));
    CHECK(share(result, VertexState::Reached) == 1);
    const auto answer = [&](const Vec3d& x) {
      const Vec3d centre = Vec3d(x[0], x[1], 0).unit();
      return centre + (x - centre).unit() * (0.4 + distance);
    };
    CHECK(position_errors(torus.view(), result, answer).worst < 2e-3);
    check_guarantee(torus.view(), result, distance, 499);
  }
}

TEST_CASE("offset: plates that close on each other stop in the middle of their gap", "[offset][no_races]") {
  const double gap = 0.1;
  const Polygons plates = shapes::plates(1, 0.1, gap, 40);
  const OffsetResult result = offset(plates.view(), by(0.08));
  std::size_t between = 0;
  for (std::size_t v = 0; v < plates.positions.size(); ++v) {
    const Vec3d &from = plates.positions[v], &to = result.positions[v];
    if (std::abs(std::abs(from[2]) - gap / 2) > 1e-9 || std::max(std::abs(from[0]), std::abs(from[1])) > 0.4) continue;
    ++between;
    CHECK(result.states[v] == VertexState::Collision);
    CHECK(std::abs(to[2]) < 0.01 * gap);
    CHECK(result.achieved[v] == Approx(gap / 2).epsilon(0.01));
  }
  CHECK(between > 1000);
  check_guarantee(plates.view(), result, 0.08, 401);
  CHECK(share(offset(plates.view(), by(0.045)), VertexState::Reached) == 1);
}

TEST_CASE("offset: a wedge's crease moves along its bisector", "[offset]") {
  const Polygons wedge = shapes::wedge(60, 1, 1, 40);
  const OffsetResult result = offset(wedge.view(), by(0.05));
  for (std::size_t v = 0; v < wedge.positions.size(); ++v) {
    const Vec3d &from = wedge.positions[v], &to = result.positions[v];
    if (std::abs(from[0]) > 1e-12 || std::abs(from[1]) > 0.4) continue;
    CHECK(result.states[v] == VertexState::Reached);
    // Where both planes are at distance d: d / sin(30 degrees) up the bisector.
    CHECK((to - Vec3d(0, from[1], 0.1)).length() < 1e-2 * 0.05);
  }
  check_guarantee(wedge.view(), result, 0.05, 101, false);
}

TEST_CASE("offset: a room's corner moves along its diagonal", "[offset]") {
  const Polygons room = shapes::room_corner(1, 40);
  const OffsetResult result = offset(room.view(), by(0.05));
  for (std::size_t v = 0; v < room.positions.size(); ++v)
    if (room.positions[v].length() < 1e-12) CHECK((result.positions[v] - Vec3d(0.05)).length() < 1e-2 * 0.05);
  CHECK(share(result, VertexState::Reached) > 0.99);
  check_guarantee(room.view(), result, 0.05, 101, false);
}

TEST_CASE("offset: an open patch is lifted, and its borders with it", "[offset]") {
  const Polygons patch = shapes::patch(1, 0, 20);
  for (const double distance : {0.1, -0.1}) {
    const OffsetResult result = offset(patch.view(), by(distance));
    CHECK(position_errors(patch.view(), result, [&](const Vec3d& x) { return x + Vec3d(0, 0, distance); }).worst <
          1e-8);
  }
  const Polygons wavy = shapes::patch(1, 0.1, 40);
  const OffsetResult result = offset(wavy.view(), by(0.03));
  CHECK(share(result, VertexState::Reached) > 0.99);
  check_guarantee(wavy.view(), result, 0.03, 53, false);
}

TEST_CASE("offset: cavities move into their hole when the solid grows", "[offset]") {
  const Polygons box = shapes::hollow_box(1, 0.02, 24);
  const OffsetResult result = offset(box.view(), by(0.05));
  CHECK(share(result, VertexState::Reached) == 1);
  check_guarantee(box.view(), result, 0.05, 211);
}

TEST_CASE("offset: faces turned the wrong way change nothing but themselves", "[offset]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 6, 3);
  Polygons muddled = mesh;
  for (std::size_t f = 0; f < mesh.face_count(); f += 7) std::swap(muddled.corners[3 * f], muddled.corners[3 * f + 1]);
  const OffsetResult clean = offset(mesh.view(), by(0.1)), mended = offset(muddled.view(), by(0.1));
  CHECK(share(mended, VertexState::Reached) == share(clean, VertexState::Reached));
  check_guarantee(mesh.view(), mended, 0.1, 17);
}

TEST_CASE("offset: two sheets back to back do not stop the run", "[offset]") {
  Polygons sheet = shapes::patch(1, 0, 10);
  const std::size_t faces = sheet.face_count();
  for (std::size_t f = 0; f < faces; ++f) {
    const auto face = sheet.view().face(f);
    const std::vector<std::uint32_t> reversed(face.rbegin(), face.rend());
    sheet.corners.insert(sheet.corners.end(), reversed.begin(), reversed.end());
    sheet.close_face();
  }
  // They move as the sheet does alone, to the side of the faces that come first.
  const OffsetResult result = offset(sheet.view(), by(0.05));
  CHECK(share(result, VertexState::Reached) == 1);
  CHECK(result.statistics.facts.repeated_faces == faces);
  CHECK(position_errors(sheet.view(), result, [&](const Vec3d& x) { return x + Vec3d(0, 0, 0.05); }).worst < 1e-8);
  check_guarantee(sheet.view(), result, 0.05, 7, false);
}

TEST_CASE("offset: the same bits for any number of threads", "[offset][invariant]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.35, 1.5, 9, 4);
  for (const double distance : {0.1, -0.1}) {
    OffsetOptions options = by(distance);
    options.threads = 1;
    const OffsetResult one = offset(mesh.view(), options);
    for (const int threads : {2, 5}) {
      options.threads = threads;
      const OffsetResult many = offset(mesh.view(), options);
      CHECK(one.positions == many.positions);
      CHECK(one.states == many.states);
      CHECK(one.achieved == many.achieved);
    }
  }
}

TEST_CASE("offset: the same bits after moving by whole voxels or scaling by a power of two",
          "[offset][invariant][no_races]") {
  const Polygons mesh = dyadic(shapes::bumpy_sphere(1, 0.35, 1.5, 9, 4));
  const double h = 0x1p-4;
  for (const double distance : {0x1p-4, -0x1p-4}) {
    const OffsetResult here = offset(mesh.view(), by(distance, h));
    const Vec3d shift = Vec3d(3, -17, 1024) * h;
    const Polygons moved = transformed(mesh, [&](const Vec3d& p) { return p + shift; });
    const OffsetResult there = offset(moved.view(), by(distance, h));
    std::size_t different = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      different += there.positions[v] - shift != here.positions[v];
    CHECK(different == 0);
    CHECK(here.states == there.states);

    for (const double scale : {0x1p10, 0x1p-30}) {
      const Polygons scaled = transformed(mesh, [&](const Vec3d& p) { return p * scale; });
      const OffsetResult large = offset(scaled.view(), by(distance * scale, h * scale));
      different = 0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        different += large.positions[v] != here.positions[v] * scale;
      CHECK(different == 0);
    }
  }
}

TEST_CASE("offset: nearly the same after a rotation, a scale, and far from the origin", "[offset][invariant]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.2, 1, 4, 4);
  const double distance = 0.1;
  const OffsetResult here = offset(mesh.view(), by(distance));
  const auto worst = [&](const OffsetResult& other, auto&& back) {
    double most = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      most = std::max(most, (back(other.positions[v]) - here.positions[v]).length());
    return most / distance;
  };
  const double scale = 1e-3;
  const OffsetResult small =
      offset(transformed(mesh, [&](const Vec3d& p) { return p * scale; }).view(), by(distance * scale));
  CHECK(worst(small, [&](const Vec3d& p) { return p / scale; }) < 1e-6);

  // Away from the origin and turned, the grid lies differently; directions then differ by what a grid is worth,
  // a few per cent of the distance at one voxel per distance, distances by nothing.
  const Vec3d far(1e5, -2e5, 3e5);
  const OffsetResult remote = offset(transformed(mesh, [&](const Vec3d& p) { return p + far; }).view(), by(distance));
  CHECK(worst(remote, [&](const Vec3d& p) { return p - far; }) < 0.1);
  CHECK(share(remote, VertexState::Reached) == share(here, VertexState::Reached));
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Polygons turned =
      transformed(mesh, [&](const Vec3d& p) { return Vec3d(c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]); });
  const OffsetResult rotated = offset(turned.view(), by(distance));
  CHECK(worst(rotated, [&](const Vec3d& p) { return Vec3d(c * p[0] + s * p[1], -s * p[0] + c * p[1], p[2]); }) < 0.1);
  CHECK(share(rotated, VertexState::Reached) == share(here, VertexState::Reached));
}

TEST_CASE("offset: states are honest where coordinates are too coarse for the distance", "[offset]") {
  const Polygons cube = transformed(shapes::box(Vec3d(1), 2, true), [](const Vec3d& p) { return p + Vec3d(1e10); });
  const OffsetResult result = offset(cube.view(), by(1e-3));  // a coordinate's last bit is worth 2e-6 here
  const auto errors = judge(cube.view(), result, 1e-3, 1, false);
  // What is as near as its coordinates can be has arrived, as far as rounding goes, which is handed out.
  const double rounding = std::sqrt(3.0) * 1e10 * std::numeric_limits<double>::epsilon() / 1e-3;
  CHECK(errors.worst_reached > 1e-6);
  CHECK(errors.worst_reached <= rounding);
  CHECK(errors.worst_told <= 1e-9);
  CHECK(errors.worst_beyond < 1e-2);
  CHECK(share(result, VertexState::Reached) == 1);
  CHECK(result.statistics.rounding == Approx(0x1p-53 * (1e10 + 0.5)));
}

TEST_CASE("offset: coordinates that the output cannot hold are refused", "[offset]") {
  const Polygons far = transformed(shapes::icosphere(1, 2), [](const Vec3d& p) { return p + Vec3d(1e7, 0, 0); });
  OffsetOptions options = by(0.5);
  CHECK(share(offset(far.view(), options), VertexState::Reached) == 1);
  options.precision.kind = Precision::Kind::Single;  // whose last bit is worth 1 here
  CHECK_THROWS_WITH(offset(far.view(), options), Catch::Contains("of the distance, 0.5"));
  options.distance = 1000;
  CHECK_NOTHROW(offset(far.view(), options));
  const Polygons farther = transformed(shapes::icosphere(1, 2), [](const Vec3d& p) { return p + Vec3d(1e9, 0, 0); });
  CHECK_THROWS_WITH(offset(farther.view(), options), Catch::Contains("diagonal"));
}

TEST_CASE("offset: vertices at one position stay together", "[offset]") {
  // A cube of six separate sides, as exported with hard edges.
  const Polygons cube = shapes::box(Vec3d(1), 6, false);
  const Polygons sides = test::torn(cube);
  const OffsetResult whole = offset(cube.view(), {.distance = 0.1}), split = offset(sides.view(), {.distance = 0.1});
  REQUIRE(split.positions.size() == sides.positions.size());
  for (std::size_t c = 0; c < sides.corners.size(); ++c)
    CHECK(split.positions[sides.corners[c]] == whole.positions[cube.corners[c]]);
  OffsetOptions apart = {.distance = 0.1};
  apart.weld.enabled = false;
  const OffsetResult torn = offset(sides.view(), apart);
  CHECK_FALSE(torn.positions == split.positions);  // each face then moves on its own
}

TEST_CASE("offset: vertices that no face uses stay where they are", "[offset]") {
  Polygons mesh = shapes::icosphere(1, 2);
  mesh.positions.push_back({100, 100, 100});
  const OffsetResult result = offset(mesh.view(), by(0.1));
  CHECK(result.positions.back() == Vec3d(100, 100, 100));
  CHECK(result.states.back() == VertexState::Unused);
  CHECK(result.statistics.facts.unused_vertices == 1);
  CHECK(share(result, VertexState::Reached) == 1);
}

TEST_CASE("offset: a vertex that only a line holds stays, and stops nothing else", "[offset]") {
  Polygons mesh = shapes::icosphere(1, 3);
  mesh.positions.push_back({0.5, 1.5, 0.5});
  const auto lonely = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.add_face({lonely, lonely, lonely});
  const OffsetResult result = offset(mesh.view(), by(0.1));
  CHECK(result.positions.back() == mesh.positions.back());
  CHECK(result.statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Reached)] == lonely);
}

TEST_CASE("offset: a distance of zero moves nothing", "[offset]") {
  const Polygons mesh = shapes::icosphere(1, 2);
  const OffsetResult result = offset(mesh.view(), by(0));
  CHECK(result.positions == mesh.positions);
  CHECK(share(result, VertexState::Reached) == 1);
}

TEST_CASE("offset: a half-edge mesh gets the positions that its polygons get", "[offset]") {
  const Polygons torus = shapes::torus(1, 0.3, 24, 12);
  Mesh mesh = to_mesh(torus.view());
  const OffsetResult result = offset(mesh, by(0.1));
  CHECK(to_polygons(mesh).positions == result.positions);
  CHECK(result.positions == offset(torus.view(), by(0.1)).positions);
  CHECK(to_polygons(mesh).corners == torus.corners);
}

TEST_CASE("offset: progress runs through the stages and can cancel each", "[offset]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 2, 4);
  for (const Stage stop : {Stage::Rasterise, Stage::Sweep, Stage::Propagate}) {
    OffsetOptions options = by(0.1);
    int last = 0;
    double last_share = 0;
    bool ordered = true;
    options.progress = [&](Stage stage, double share) {
      ordered &= static_cast<int>(stage) >= last && share >= last_share && share <= 1;
      last = static_cast<int>(stage);
      last_share = share;
      return stage != stop;
    };
    CHECK_THROWS_AS(offset(mesh.view(), options), Cancelled);
    CHECK(ordered);
    CHECK(last == static_cast<int>(stop));
  }
}

TEST_CASE("offset: progress is one share of the whole call, which never falls and ends at 1", "[offset][progress]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 2, 4);
  std::vector<double> shares;
  const auto listen = [&](Stage, double share) {
    shares.push_back(share);
    return true;
  };
  OffsetOptions options;
  options.progress = listen;
  const auto check_shares = [&](const char* what, double most_step) {
    INFO(what);
    REQUIRE(shares.size() > 4);
    CHECK(shares.front() == 0);
    CHECK(std::is_sorted(shares.begin(), shares.end()));
    CHECK(shares.back() == 1);
    double step = 0;
    for (std::size_t i = 1; i < shares.size(); ++i) step = std::max(step, shares[i] - shares[i - 1]);
    CHECK(step < most_step);
    shares.clear();
  };
  options.distance = 0.05;
  offset(mesh.view(), options);
  check_shares("nothing to mend", 0.6);
  options.distance = -0.3;
  CHECK(offset(mesh.view(), options).statistics.limit.rounds > 0);
  check_shares("much to mend", 0.6);
  offset_several(mesh.view(), std::vector<Distances>{0.1, 0.2, -0.1}, options);
  check_shares("several distances", 0.6);
  grow_layers(mesh.view(), std::vector<Distances>{0.05, 0.1}, options);
  check_shares("layers", 0.6);
  options.distance = 0.1;
  offset_to_tolerance(mesh.view(), options, {.share = 0.02});
  check_shares("to a tolerance", 0.4);
  IsoOptions iso;
  iso.distance = 0.1;
  iso.progress = listen;
  make_iso_surface(mesh.view(), iso);
  check_shares("iso-surface", 0.6);
  options.distance = 0;
  offset(mesh.view(), options);
  CHECK(shares.back() == 1);
}

TEST_CASE("offset: memory is asked for once, as the plan has it, before the field is made", "[offset]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 2, 4);
  OffsetOptions options = by(0.1);
  std::vector<std::size_t> asked;
  std::size_t reports = 0;
  options.progress = [&](Stage, double) {
    ++reports;
    return true;
  };
  options.reserve = [&](std::size_t bytes) {
    CHECK(reports == 2);  // sorting the mesh, to know the plan, begins and ends
    asked.push_back(bytes);
    return true;
  };
  const std::size_t planned = plan_offset(mesh.view(), options).plan.bytes;
  CHECK(asked.empty());
  offset(mesh.view(), options);
  CHECK(asked == std::vector<std::size_t>{planned});
  options.reserve = [](std::size_t) { return false; };
  CHECK_THROWS_AS(offset(mesh.view(), options), Cancelled);
}

TEST_CASE("offset: options that cannot be used are told", "[offset][no_races]") {
  const Polygons mesh = shapes::icosphere(1, 1);
  CHECK_THROWS_AS(offset(mesh.view(), by(std::nan(""))), InvalidInput);
  OffsetOptions threads = by(0.1);
  threads.threads = -1;
  CHECK_THROWS_AS(offset(mesh.view(), threads), InvalidInput);
  OffsetOptions memory = by(0.1, 1e-5);
  memory.max_memory = 1 << 28;
  CHECK_THROWS_AS(offset(mesh.view(), memory), OutOfBudget);
}

TEST_CASE("report: the summary counts what the states say", "[report]") {
  OffsetResult result;
  result.states = {VertexState::Reached, VertexState::Reached, VertexState::Collision, VertexState::Unused};
  result.achieved = {2, 2.000001, 1, 0};
  result.distances = -2;
  const AchievedSummary summary = summarise(result);
  CHECK(summary.vertices == 3);
  CHECK(summary.share_reached == Approx(2.0 / 3));
  CHECK(summary.least == 1);
  CHECK(summary.most == 2.000001);
  CHECK(summary.worst_reached_error == Approx(5e-7));
}

TEST_CASE("oracle: the judge rejects a vertex that is off, beyond or on the wrong side", "[offset][oracle]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  const OffsetResult good = offset(sphere.view(), by(0.2));
  CHECK(judge(sphere.view(), good, 0.2, 1, true).worst_reached < 1e-8);
  OffsetResult bad = good;
  bad.positions[5] *= 1.0001;
  CHECK(judge(sphere.view(), bad, 0.2, 1, true).worst_reached > 1e-4);
  CHECK(judge(sphere.view(), bad, 0.2, 1, true).worst_beyond > 1e-4);
  bad = good;
  bad.positions[7] *= 0.8 / 1.2;
  CHECK(judge(sphere.view(), bad, 0.2, 1, true).wrong_side == 1);
}
