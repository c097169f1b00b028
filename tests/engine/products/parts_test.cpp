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
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test::countersink;

namespace {

/// Marks of the faces all of whose corners satisfy a predicate.
template <class Holds>
std::vector<std::uint8_t> faces_where(const Polygons& mesh, Holds&& holds) {
  std::vector<std::uint8_t> marks(mesh.face_count());
  for (std::size_t f = 0; f < marks.size(); ++f) {
    const auto face = mesh.view().face(f);
    marks[f] = std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return holds(mesh.positions[v]); });
  }
  return marks;
}

std::vector<std::uint8_t> vertices_of(const Polygons& mesh, const std::vector<std::uint8_t>& faces, std::uint8_t kept) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f] == kept)
      for (const auto v : mesh.view().face(f)) used[v] = 1;
  return used;
}

Distances per_vertex(const Polygons& mesh, const std::function<double(const Vec3d&)>& distance) {
  std::vector<double> each;
  for (const Vec3d& p : mesh.positions) each.push_back(distance(p));
  return Distances(std::move(each));
}

/// What crosses or is folded over in a result, of all its faces.
FaultCounts faults_of(const Polygons& mesh, const OffsetResult& result) {
  return check_offset(mesh.view(), result.positions, {.distance = result.distances.farthest()}).faults;
}

/// A box, 20 wide and 8 high, on which a chamfer leads to a lid that is 2 from its sides: the bottom, four sides, four
/// faces of the chamfer, and the lid.
Polygons chamfered_box(double slope) {
  Polygons mesh;
  for (const auto& [low, high, z] : {std::tuple(0.0, 20.0, 0.0), {0.0, 20.0, 8.0}, {2.0, 18.0, 8 + 2 * slope}})
    for (const auto& [x, y] : {std::pair(low, low), {high, low}, {high, high}, {low, high}})
      mesh.positions.emplace_back(x, y, z);
  mesh.add_face({3, 2, 1, 0});
  for (const std::uint32_t low : {0u, 4u})
    for (std::uint32_t i = 0; i < 4; ++i)
      mesh.add_face({low + i, low + (i + 1) % 4, low + (i + 1) % 4 + 4, low + i + 4});
  mesh.add_face({8, 9, 10, 11});
  return mesh;
}

/// Whether check_offset() finds every vertex of a part's offset in the state that it was given, and no fault.
bool is_confirmed(const Polygons& mesh, const OffsetResult& result, const OffsetOptions& options) {
  const CheckResult check = check_offset(mesh.view(), result.positions,
                                         {.distance = options.distance,
                                          .only = options.only,
                                          .border = options.border,
                                          .symmetry = options.symmetry,
                                          .corners = options.corners});
  return check.states == result.states && check.faults.total() == 0 && check.beyond == 0;
}

}  // namespace

TEST_CASE("uneven: every vertex is at its own distance, on its own side", "[uneven][oracle]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.1, 2, 3, 4);
  OffsetOptions options;
  options.corners = Corners::Round;
  options.distance = per_vertex(mesh, [](const Vec3d& p) {
    return p[0] > 0.2 ? 0.05 * p[0] : p[0] < -0.2 ? -0.04 : 0;
  });
  const OffsetResult result = offset(mesh.view(), options);
  std::size_t reached = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double asked = options.distance[v];
    if (asked == 0) {
      CHECK(result.positions[v] == mesh.positions[v]);
      CHECK(result.states[v] == VertexState::Reached);
      continue;
    }
    if (result.states[v] != VertexState::Reached) continue;
    ++reached;
    if (v % 7 != 0) continue;
    const double distance = test::brute_force_distance(mesh.view(), result.positions[v]);
    CHECK(std::abs(distance - std::abs(asked)) <= 2e-6 * std::abs(asked));
    CHECK(test::is_inside(mesh.view(), result.positions[v]) == (asked < 0));
  }
  CHECK(reached > mesh.positions.size() / 2);
  CHECK(faults_of(mesh, result).crossings == 0);
}

TEST_CASE("uneven: the same for any number of threads", "[uneven]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.2, 3, 5, 4);
  OffsetOptions one;
  one.distance = per_vertex(mesh, [](const Vec3d& p) { return 0.1 * (1 + 0.5 * std::sin(5 * p[2])); });
  one.threads = 1;
  OffsetOptions all = one;
  all.threads = 0;
  CHECK(offset(mesh.view(), one).positions == offset(mesh.view(), all).positions);
}

TEST_CASE("uneven: copies of a vertex go the mean of what is asked of them", "[uneven]") {
  const Polygons mesh = test::torn(shapes::icosphere(1, 2));
  OffsetOptions options;
  std::vector<double> each(mesh.positions.size(), 0.1);
  const Vec3d shared = mesh.positions[0];
  double sum = 0, copies = 0;
  for (std::size_t v = 0; v < each.size(); ++v) {
    if (mesh.positions[v] != shared) continue;
    each[v] = 0.1 + 0.01 * copies;
    sum += each[v];
    ++copies;
  }
  REQUIRE(copies > 2);
  options.distance = Distances(each);
  const OffsetResult result = offset(mesh.view(), options);
  CHECK(result.statistics.disagreeing_distances == copies - 1);
  CHECK(result.distances[0] == Approx(sum / copies));
  for (std::size_t v = 0; v < each.size(); ++v)
    if (mesh.positions[v] == shared) CHECK(result.positions[v] == result.positions[0]);
  CHECK(result.achieved[0] == Approx(sum / copies));
}

TEST_CASE("uneven: distances that cannot be used are refused", "[uneven]") {
  const Polygons mesh = shapes::icosphere(1, 1);
  OffsetOptions options;
  options.distance = Distances(std::vector<double>(3, 0.1));
  CHECK_THROWS_WITH(offset(mesh.view(), options), Catch::Contains("a distance for each of 42"));
  std::vector<double> each(42, 0.1);
  each[17] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(Distances(each), Catch::Contains("vertex 17"));
}

TEST_CASE("several: one march serves all distances", "[several][oracle]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.15, 2, 9, 4);
  const std::vector<Distances> distances = {0.05, -0.03, 0.1, 0.0};
  OffsetOptions options;
  options.corners = Corners::Round;
  const std::vector<OffsetResult> results = offset_several(mesh.view(), distances, options);
  REQUIRE(results.size() == 4);
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    CHECK(test::share(results[i], VertexState::Reached) > 0.98);
    const test::DistanceErrors errors = test::judge(mesh.view(), results[i], distances[i][0], 13, true);
    CHECK(errors.worst_reached < 2e-6);
    CHECK(errors.worst_beyond < 2e-6);
    CHECK(errors.wrong_side == 0);
    CHECK(faults_of(mesh, results[i]).total() == 0);
  }
  CHECK(results[3].positions == mesh.positions);
  // Where paths are straight, the field's voxel size does not matter.
  const Polygons sphere = shapes::icosphere(1, 3);
  const std::vector<OffsetResult> of_sphere = offset_several(sphere.view(), distances, options);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    INFO(i);
    OffsetOptions alone = options;
    alone.distance = distances[i];
    CHECK(of_sphere[i].positions == offset(sphere.view(), alone).positions);
    if (i < 3) CHECK(of_sphere[i].statistics.straight_vertices == sphere.positions.size());
  }
}

TEST_CASE("several: the same bits for any number of threads, told as one run, cancelled as one",
          "[several][invariant]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.5, 2.5, 11, 4);
  const std::vector<Distances> distances = {0.3, 0.2, -0.1, 0.25, 0.1, 0.28};  // more than are made together
  OffsetOptions one;
  one.threads = 1;
  const std::vector<OffsetResult> alone = offset_several(mesh.view(), distances, one);
  OffsetOptions all;
  bool ordered = true;
  double last = 0;
  all.progress = [&](Stage stage, double share) {
    if (stage != Stage::Limit) return true;
    ordered &= share >= last && share <= 1;
    last = share;
    return true;
  };
  const std::vector<OffsetResult> together = offset_several(mesh.view(), distances, all);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    CHECK(alone[i].positions == together[i].positions);
    CHECK(alone[i].states == together[i].states);
  }
  CHECK(ordered);
  CHECK(last > 0);
  all.progress = [&](Stage stage, double share) { return stage != Stage::Limit || share < last / 2; };
  CHECK_THROWS_AS(offset_several(mesh.view(), distances, all), Cancelled);
}

TEST_CASE("part: the lid of a box slides along its sides", "[part]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 8, true);
  OffsetOptions options;
  options.only = faces_where(box, [](const Vec3d& p) { return p[2] == 0.5; });
  const std::vector<std::uint8_t> lid = vertices_of(box, options.only, 1);
  for (const double d : {0.2, -0.1}) {
    INFO(d);
    options.distance = d;
    const OffsetResult result = offset(box.view(), options);
    double worst = 0;
    for (std::size_t v = 0; v < box.positions.size(); ++v) {
      const Vec3d expected = box.positions[v] + Vec3d(0, 0, lid[v] ? d : 0);
      if (lid[v]) worst = std::max(worst, (result.positions[v] - expected).length());
      else CHECK(result.positions[v] == box.positions[v]);
    }
    CHECK(worst < 1e-9);
    CHECK(test::share(result, VertexState::Reached) == 1);
  }
}

TEST_CASE("part: a border that slides stays on a bent surface", "[part][oracle]") {
  const Polygons sphere = shapes::icosphere(1, 4);
  OffsetOptions options;
  options.only = faces_where(sphere, [](const Vec3d& p) { return p[2] > 0.6; });
  options.distance = 0.02;
  const OffsetResult result = offset(sphere.view(), options);
  const std::vector<std::uint8_t> on = vertices_of(sphere, options.only, 1), off = vertices_of(sphere, options.only, 0);
  std::size_t border = 0;
  for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
    if (!on[v]) CHECK(result.positions[v] == sphere.positions[v]);
    if (!on[v] || !off[v] || result.states[v] != VertexState::Reached) continue;
    ++border;
    CHECK(test::brute_force_distance(sphere.view(), result.positions[v]) < 1e-9);
    CHECK(result.achieved[v] == Approx(0.02));
  }
  CHECK(border > 20);
}

TEST_CASE("part: a hole's wall slides on the cone above it to where its moved faces meet that", "[part][oracle]") {
  for (const auto& [sides, angle] : {std::pair(8u, 90.0), {8u, 120.0}, {16u, 82.0}, {24u, 90.0}, {32u, 120.0}})
    for (const double distance : {-0.1, -0.5, 0.1})
      for (const Corners corners : {Corners::Round, Corners::Miter}) {
        CAPTURE(sides, angle, distance, corners == Corners::Miter);
        const Countersink plate(sides, angle);
        OffsetOptions options;
        options.distance = distance;
        options.only = plate.wall;
        options.corners = corners;
        const OffsetResult result = offset(plate.mesh.view(), options);
        // Edges that bend by less than 20 degrees are no creases, and stay as with round corners.
        const bool mitered = distance > 0 || (corners == Corners::Miter && sides <= 16);
        const double radius = 3 - distance * (mitered ? 1 / std::cos(std::numbers::pi / sides) : 1);
        double worst = 0;
        for (std::uint32_t v = 0; v < plate.mesh.positions.size(); ++v) {
          const std::uint32_t ring = v / sides;
          const double z = ring == 2 ? 6 + (radius - 3) / plate.slope : plate.mesh.positions[v][2];
          const Vec3d expected = ring < 3 ? plate.at(v % sides, radius, z) : plate.mesh.positions[v];
          worst = std::max(worst, (result.positions[v] - expected).length());
        }
        CHECK(worst < 1e-8);
        CHECK(test::share(result, VertexState::Reached) + test::share(result, VertexState::Mitered) == 1);
        CHECK(is_confirmed(plate.mesh, result, options));
      }
}

TEST_CASE("part: a chamfer moves to where its planes meet the faces beside it, at any angle", "[part][oracle]") {
  for (const double angle : {30.0, 45.0, 60.0})
    for (const double distance : {0.1, -0.1})
      for (const Corners corners : {Corners::Round, Corners::Miter}) {
        CAPTURE(angle, distance, corners == Corners::Miter);
        const double t = std::tan(angle * std::numbers::pi / 180);
        const Polygons box = chamfered_box(t);
        OffsetOptions options;
        options.distance = distance;
        options.corners = corners;
        options.only = faces_where(box, [](const Vec3d& p) { return p[2] >= 8; });
        options.only.back() = 0;
        const OffsetResult result = offset(box.view(), options);
        // Round: at the distance from the edge between two faces of the chamfer, which leads along (1, 1, t).
        const bool at_planes = corners == Corners::Miter || distance < 0;
        const double rise = distance * (at_planes ? std::sqrt(1 + t * t) : std::sqrt((2 + t * t) / 2));
        CHECK((result.positions[4] - Vec3d(0, 0, 8 + rise)).length() < 1e-9);
        CHECK((result.positions[8] - Vec3d(2 - rise / t, 2 - rise / t, 8 + 2 * t)).length() < 1e-9);
        CHECK(test::share(result, VertexState::Reached) + test::share(result, VertexState::Mitered) == 1);
        CHECK(is_confirmed(box, result, options));

        options.only = {0, 1, 1, 1, 1, 0, 0, 0, 0, 0};  // the sides, whose upper edge is the chamfer's lower one
        const OffsetResult sides = offset(box.view(), options);
        const double out = distance * (at_planes ? 1 : std::sqrt(0.5));
        CHECK((sides.positions[4] - Vec3d(-out, -out, 8 - out * t)).length() < 1e-9);
        CHECK((sides.positions[0] - Vec3d(-out, -out, 0)).length() < 1e-9);
        CHECK(is_confirmed(box, sides, options));
      }
}

TEST_CASE("part: its edge meets the faces that stay in a plane of symmetry, too", "[part][symmetry]") {
  // Half a hole under half a cone, open where the other half would be.
  const Countersink whole(16, 90);
  Polygons halved;
  halved.positions = whole.mesh.positions;
  OffsetOptions options;
  options.distance = -0.25;
  // Of the part alone, a straight border of facets does not tell it.
  options.symmetry.planes = {{Vec3d(0, 1, 0), 0}};
  for (std::size_t f = 0; f < whole.mesh.face_count(); ++f) {
    const auto face = whole.mesh.view().face(f);
    if (std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return whole.mesh.positions[v][1] < -1e-9; }))
      continue;
    halved.corners.insert(halved.corners.end(), face.begin(), face.end());
    halved.close_face();
    options.only.push_back(whole.wall[f]);
  }
  for (const Corners corners : {Corners::Round, Corners::Miter}) {
    options.corners = corners;
    const OffsetResult result = offset(halved.view(), options);
    const bool mitered = corners == Corners::Miter;
    const double wider = mitered ? 0.25 / std::cos(std::numbers::pi / 16) : 0.25;
    // In the plane itself there is no edge that could be mitered.
    for (std::uint32_t i = mitered ? 1 : 0; i <= (mitered ? 7 : 8); ++i)
      CHECK((result.positions[2 * 16 + i] - whole.at(i, 3 + wider, 6 + wider)).length() < 1e-8);
    CHECK(is_confirmed(halved, result, options));
  }
}

TEST_CASE("part: a border that is fixed stays, one that is free goes with the part", "[part]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 8, false);
  OffsetOptions options;
  options.only = faces_where(box, [](const Vec3d& p) { return p[2] == 0.5; });
  options.distance = 0.05;
  const std::vector<std::uint8_t> on = vertices_of(box, options.only, 1), off = vertices_of(box, options.only, 0);
  for (const Border border : {Border::Fixed, Border::Free}) {
    options.border = border;
    const OffsetResult result = offset(box.view(), options);
    for (std::size_t v = 0; v < box.positions.size(); ++v) {
      const bool moves = on[v] && (border == Border::Free || !off[v]);
      CHECK((result.positions[v] - box.positions[v] - Vec3d(0, 0, moves ? 0.05 : 0)).length() < 1e-9);
    }
  }
}

TEST_CASE("part: what stays is in the way", "[part][no_races]") {
  // The lower of two plates' upper side, farther than to the other plate.
  const Polygons plates = shapes::plates(1, 0.1, 0.2, 12);
  OffsetOptions options;
  options.only = faces_where(plates, [](const Vec3d& p) { return p[2] == -0.1; });
  options.distance = 0.3;
  const OffsetResult result = offset(plates.view(), options);
  CHECK(result.statistics.limit.before.crossings > 0);
  CHECK(result.statistics.limit.left.total() == 0);
  for (const Vec3d& p : result.positions) CHECK(p[2] <= 0.2 + 1e-12);
  Surface surface = build_surface(Polygons{result.positions, plates.corners, plates.face_begin}.view(), {});
  to_local_frame(surface, 0.01);
  CHECK(CrossingFinder(surface, surface.vertices).all().empty());
}

TEST_CASE("part: a lid that goes farther than the faces beside it are high", "[part][no_races]") {
  const Polygons box = shapes::box(Vec3d(1, 1, 1), 20, true);
  OffsetOptions options;
  options.only = faces_where(box, [](const Vec3d& p) { return p[2] == 0.5; });
  const std::vector<std::uint8_t> lid = vertices_of(box, options.only, 1);
  for (const Border border : {Border::Slide, Border::Free}) {
    options.border = border;
    options.distance = -0.6;  // twelve times as far
    const OffsetResult result = offset(box.view(), options);
    CHECK(result.statistics.limit.left.total() == 0);
    CHECK(faults_of(box, result).crossings == 0);
    for (std::size_t v = 0; v < box.positions.size(); ++v)
      if (!lid[v]) CHECK(result.positions[v] == box.positions[v]);
  }
}

TEST_CASE("part: marks that cannot be used are refused", "[part]") {
  const Polygons sphere = shapes::icosphere(1, 1);
  OffsetOptions options;
  options.distance = 0.1;
  options.only.assign(3, 1);
  CHECK_THROWS_WITH(offset(sphere.view(), options), Catch::Contains("a mark for each of 80 faces"));
  options.only.assign(80, 0);
  CHECK_THROWS_WITH(offset(sphere.view(), options), Catch::Contains("at least one face"));
}

TEST_CASE("obstacle: nothing comes nearer than the clearance, faces neither", "[obstacle][oracle]") {
  const Polygons sphere = shapes::icosphere(0.5, 3);
  Polygons spike = shapes::icosphere(0.1, 2);  // between vertices of the sphere's offset
  for (Vec3d& p : spike.positions) p += Vec3d(0.1, 0.2, 0.65);
  OffsetOptions options;
  options.distance = 0.15;
  options.obstacles = spike.view();
  for (const double clearance : {0.0, 0.02}) {
    options.clearance = clearance;
    const OffsetResult result = offset(sphere.view(), options);
    CHECK(result.statistics.limit.left.total() == 0);
    CHECK(test::share(result, VertexState::Reached) > 0.5);
    CHECK(test::share(result, VertexState::Reached) < 1);
    double least = 1;
    for (std::size_t f = 0; f < sphere.face_count(); ++f)
      for (std::size_t g = 0; g < spike.face_count(); ++g) {
        const auto a = sphere.view().face(f), b = spike.view().face(g);
        least =
            std::min(least, distance_between({result.positions[a[0]], result.positions[a[1]], result.positions[a[2]]},
                                             {spike.positions[b[0]], spike.positions[b[1]], spike.positions[b[2]]}));
      }
    CHECK(least >= clearance * (1 - 2e-6));
    CHECK(least > 0);
    CHECK(least < clearance + 0.05);
  }
}

TEST_CASE("obstacle: it does not count for the distance", "[obstacle]") {
  const Polygons sphere = shapes::icosphere(0.5, 3);
  Polygons far = shapes::icosphere(0.1, 1);
  for (Vec3d& p : far.positions) p += Vec3d(0, 0, 2);
  OffsetOptions options;
  options.distance = 0.1;
  const OffsetResult alone = offset(sphere.view(), options);
  options.obstacles = far.view();
  options.clearance = 0.1;
  CHECK(offset(sphere.view(), options).positions == alone.positions);
  options.clearance = -1;
  CHECK_THROWS_WITH(offset(sphere.view(), options), Catch::Contains("clearance"));
}

TEST_CASE("obstacle: distance between triangles", "[obstacle][oracle]") {
  const TriangleCorners flat = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)};
  CHECK(distance_between(flat, {Vec3d(0.2, 0.2, -1), Vec3d(0.2, 0.2, 1), Vec3d(0.3, 0.2, 1)}) == 0);
  CHECK(distance_between(flat, {Vec3d(0.2, 0.2, 2), Vec3d(0.2, 0.2, 0.5), Vec3d(0.3, 0.2, 3)}) == Approx(0.5));
  CHECK(distance_between(flat, {Vec3d(-1, -1, 0.5), Vec3d(-1, 2, 1.5), Vec3d(-5, 0, 1)}) ==
        Approx(std::sqrt(1 + 0.64)).epsilon(0.2));
  // Edge against edge: crossing at right angles, 0.25 apart.
  CHECK(distance_between(flat, {Vec3d(0.5, -1, 0.25), Vec3d(0.5, 1, 0.25), Vec3d(0.5, 0, 5)}) == Approx(0.25));
}
