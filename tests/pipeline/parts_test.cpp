// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <tuple>

#include "support/folder.h"
#include "support/oracles.h"
#include "vdb_offset/check.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/scene.h"
#include "vdb_offset/validity/clearance.h"

using namespace vdb_offset;

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

/// A round plate, 9 high, with a hole of radius 3 through it that a cone widens from a height of 6 on, and the marks of
/// the hole's wall.
struct Countersink {
  Polygons mesh;
  std::vector<std::uint8_t> wall;
  std::uint32_t sides;
  double slope;  // by how much the cone's radius grows with the height

  Countersink(std::uint32_t count, double angle) : sides(count), slope(std::tan(angle / 2 * std::numbers::pi / 180)) {
    const std::pair<double, double> outline[] = {{3, 0}, {3, 2}, {3, 6}, {3 + 3 * slope, 9}, {20, 9}, {20, 0}};
    for (const auto& [radius, z] : outline)
      for (std::uint32_t i = 0; i < count; ++i) mesh.positions.push_back(at(i, radius, z));
    for (std::uint32_t ring = 0; ring < 6; ++ring)
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count, low = ring * count, high = (ring + 1) % 6 * count;
        mesh.add_face({low + next, low + i, high + i});  // triangles, of which some vertices have more than others
        mesh.add_face({low + next, high + i, high + next});
        wall.insert(wall.end(), 2, ring < 2);
      }
  }

  Vec3d at(std::uint32_t i, double radius, double z) const {
    const double angle = 2 * std::numbers::pi * i / sides;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
  }
};

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
  const Polygons mesh = scene::bumpy_sphere(1, 0.1, 2, 3, 4);
  OffsetOptions options;
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
  const Polygons mesh = scene::bumpy_sphere(1, 0.2, 3, 5, 4);
  OffsetOptions one;
  one.distance = per_vertex(mesh, [](const Vec3d& p) { return 0.1 * (1 + 0.5 * std::sin(5 * p[2])); });
  one.threads = 1;
  OffsetOptions all = one;
  all.threads = 0;
  CHECK(offset(mesh.view(), one).positions == offset(mesh.view(), all).positions);
}

TEST_CASE("uneven: copies of a vertex go the mean of what is asked of them", "[uneven]") {
  const Polygons mesh = test::torn(scene::icosphere(1, 2));
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
  const Polygons mesh = scene::icosphere(1, 1);
  OffsetOptions options;
  options.distance = Distances(std::vector<double>(3, 0.1));
  CHECK_THROWS_WITH(offset(mesh.view(), options), Catch::Contains("a distance for each of 42"));
  std::vector<double> each(42, 0.1);
  each[17] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(Distances(each), Catch::Contains("vertex 17"));
}

TEST_CASE("several: one march serves all distances", "[several][oracle]") {
  const Polygons mesh = scene::bumpy_sphere(1, 0.15, 2, 9, 4);
  const std::vector<Distances> distances = {0.05, -0.03, 0.1, 0.0};
  OffsetOptions options;
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
  const Polygons sphere = scene::icosphere(1, 3);
  const std::vector<OffsetResult> of_sphere = offset_several(sphere.view(), distances, options);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    INFO(i);
    OffsetOptions alone;
    alone.distance = distances[i];
    CHECK(of_sphere[i].positions == offset(sphere.view(), alone).positions);
    if (i < 3) CHECK(of_sphere[i].statistics.straight_vertices == sphere.positions.size());
  }
}

TEST_CASE("several: the same bits for any number of threads, told as one run, cancelled as one",
          "[several][invariant]") {
  const Polygons mesh = scene::bumpy_sphere(1, 0.5, 2.5, 11, 4);
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
  const Polygons box = scene::box(Vec3d(1, 1, 1), 8, true);
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
  const Polygons sphere = scene::icosphere(1, 4);
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
        const bool mitred = distance > 0 || (corners == Corners::Miter && sides <= 16);
        const double radius = 3 - distance * (mitred ? 1 / std::cos(std::numbers::pi / sides) : 1);
        double worst = 0;
        for (std::uint32_t v = 0; v < plate.mesh.positions.size(); ++v) {
          const std::uint32_t ring = v / sides;
          const double z = ring == 2 ? 6 + (radius - 3) / plate.slope : plate.mesh.positions[v][2];
          const Vec3d expected = ring < 3 ? plate.at(v % sides, radius, z) : plate.mesh.positions[v];
          worst = std::max(worst, (result.positions[v] - expected).length());
        }
        CHECK(worst < 1e-8);
        CHECK(test::share(result, VertexState::Reached) + test::share(result, VertexState::Mitred) == 1);
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
        CHECK(test::share(result, VertexState::Reached) + test::share(result, VertexState::Mitred) == 1);
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
  const OffsetResult result = offset(halved.view(), options);
  for (std::uint32_t i = 0; i <= 8; ++i)
    CHECK((result.positions[2 * 16 + i] - whole.at(i, 3.25, 6.25)).length() < 1e-8);
  CHECK(is_confirmed(halved, result, options));
}

TEST_CASE("part: a border that is fixed stays, one that is free goes with the part", "[part]") {
  const Polygons box = scene::box(Vec3d(1, 1, 1), 8, false);
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
  const Polygons plates = scene::plates(1, 0.1, 0.2, 12);
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
  const Polygons box = scene::box(Vec3d(1, 1, 1), 20, true);
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
  const Polygons sphere = scene::icosphere(1, 1);
  OffsetOptions options;
  options.distance = 0.1;
  options.only.assign(3, 1);
  CHECK_THROWS_WITH(offset(sphere.view(), options), Catch::Contains("a mark for each of 80 faces"));
  options.only.assign(80, 0);
  CHECK_THROWS_WITH(offset(sphere.view(), options), Catch::Contains("at least one face"));
}

TEST_CASE("obstacle: nothing comes nearer than the clearance, faces neither", "[obstacle][oracle]") {
  const Polygons sphere = scene::icosphere(0.5, 3);
  Polygons spike = scene::icosphere(0.1, 2);  // between vertices of the sphere's offset
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
  const Polygons sphere = scene::icosphere(0.5, 3);
  Polygons far = scene::icosphere(0.1, 1);
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

namespace {

io::MeshFile as_file(const Polygons& mesh) {
  std::string text;
  for (const Vec3d& p : mesh.positions) text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += 'f';
    for (const auto v : mesh.view().face(f)) text += fmt::format(" {}", v + 1);
    text += '\n';
  }
  return io::parse_mesh("mesh.obj", io::Format::Obj, text);
}

std::vector<std::uint8_t> selected(const Polygons& mesh, const std::vector<std::string>& names) {
  std::vector<io::Selector> selectors;
  selectors.reserve(names.size());
  for (const std::string& name : names) selectors.push_back(io::parse_selector(name));
  return io::select_faces(as_file(mesh), selectors);
}

std::vector<std::uint8_t> negated(std::vector<std::uint8_t> marks) {
  for (auto& mark : marks) mark = mark == 0;
  return marks;
}

}  // namespace

TEST_CASE("selection: round holes by their faces and diameters, wherever they stand", "[selection]") {
  for (const std::uint32_t sides : {8u, 16u, 24u, 32u, 64u}) {
    CAPTURE(sides);
    const Countersink plate(sides, 90);
    Polygons turned = plate.mesh;  // about an axis, and moved away
    for (Vec3d& p : turned.positions) p = Vec3d(p[0] * 0.6 + p[2] * 0.8 + 100, p[1] - 40, p[2] * 0.6 - p[0] * 0.8);
    const auto of_rings = [&](std::initializer_list<std::uint32_t> rings) {
      std::vector<std::uint8_t> marks;
      for (std::uint32_t ring = 0; ring < 6; ++ring)
        marks.insert(marks.end(), 2 * sides, std::find(rings.begin(), rings.end(), ring) != rings.end());
      return marks;
    };
    for (const Polygons& mesh : {plate.mesh, turned, test::torn(turned)}) {
      CHECK(selected(mesh, {"holes"}) == of_rings({0, 1, 2}));  // the cone, whose smaller end is as wide, among them
      CHECK(selected(mesh, {"holes<6.001"}) == of_rings({0, 1, 2}));
      CHECK(selected(mesh, {"holes>5.999"}) == of_rings({0, 1, 2}));
      CHECK_THROWS_WITH(selected(mesh, {"holes<5.999"}), Catch::Contains("below 5.999, found 2 from 6 to 6"));
      CHECK_THROWS_WITH(selected(mesh, {"holes>6.001"}), Catch::Contains("above 6.001"));
      CHECK(selected(mesh, {"concave"}) == of_rings({0, 1, 2}));
      CHECK(selected(mesh, {"convex"}) == of_rings({4}));
      CHECK(selected(mesh, {"not:holes"}) == of_rings({3, 4, 5}));
    }
    CHECK(selected(plate.mesh, {"down"}) == of_rings({5}));
    CHECK(selected(plate.mesh, {"up"}) == of_rings({3}));  // not the cone, at 45 degrees
  }
}

TEST_CASE("selection: what is round and no hole, or has too few sides", "[selection]") {
  CHECK_THROWS_WITH(selected(scene::cylinder(1, 2, 32, 2, 2), {"holes"}), Catch::Contains("found none"));
  CHECK_THROWS_WITH(selected(Countersink(6, 90).mesh, {"holes"}), Catch::Contains("found none"));
  CHECK_THROWS_WITH(selected(scene::box(Vec3d(1, 1, 1), 2, true), {"concave"}), Catch::Contains("'concave'"));
  CHECK_THROWS_WITH(selected(scene::icosphere(1, 3), {"holes"}), Catch::Contains("found none"));
  const auto all = selected(scene::icosphere(1, 3), {"convex"});
  CHECK(std::count(all.begin(), all.end(), 1) == static_cast<std::ptrdiff_t>(all.size()));
}

TEST_CASE("selection: what is behind not: is taken from all else that is named", "[selection]") {
  const Polygons box = scene::box(Vec3d(1, 1, 1), 2, false);
  const auto up = selected(box, {"up"}), down = selected(box, {"down"});
  CHECK(std::count(up.begin(), up.end(), 1) == static_cast<std::ptrdiff_t>(up.size() / 6));
  CHECK(selected(box, {"not:up"}) == negated(up));
  CHECK(selected(box, {"up", "not:down"}) == up);
  auto neither = negated(up);
  for (std::size_t f = 0; f < neither.size(); ++f) neither[f] &= down[f] == 0;
  CHECK(selected(box, {"not:up", "not:down"}) == neither);
  CHECK_THROWS_WITH(selected(box, {"up", "not:up"}), Catch::Contains("'not:'"));
  for (const char* const wrong : {"not:", "not:not:up", "not:roof", "holes<", "holes<0", "holes<x", "holes=3", "hole"})
    CHECK_THROWS_AS(io::parse_selector(wrong), InvalidOption);
}

TEST_CASE("selection: groups, objects, materials and files of faces", "[selection]") {
  const Folder folder;
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no thing\ng left shared\nusemtl red\nf 1 2 3\ng right shared\nf 1 2 4\n"
      "usemtl blue paint\nf 2 3 4\ng\nf 1 3 4\n";
  const io::MeshFile mesh = io::parse_mesh("m.obj", io::Format::Obj, text);
  const auto marks = [&](const std::vector<std::string>& names) {
    std::vector<io::Selector> selectors;
    selectors.reserve(names.size());
    for (const std::string& name : names) selectors.push_back(io::parse_selector(name));
    return io::select_faces(mesh, selectors);
  };
  using Marks = std::vector<std::uint8_t>;
  CHECK(marks({"group=left"}) == Marks{1, 0, 0, 0});
  CHECK(marks({"group=shared"}) == Marks{1, 1, 1, 0});
  CHECK(marks({"group=thing"}) == Marks{1, 1, 1, 1});
  CHECK(marks({"material=red"}) == Marks{1, 1, 0, 0});
  CHECK(marks({"material=blue paint"}) == Marks{0, 0, 1, 1});
  CHECK(marks({"group=left", "material=blue paint"}) == Marks{1, 0, 1, 1});
  CHECK_THROWS_WITH(marks({"group=wheel"}), Catch::Contains("left, right, shared, thing"));
  CHECK_THROWS_AS(marks({"material=green"}), InvalidOption);
  CHECK_THROWS_AS(io::parse_selector("roof"), InvalidOption);
  CHECK_THROWS_AS(io::parse_selector("group="), InvalidOption);

  const auto from = [&](const std::string& content) {
    std::ofstream(folder.file("faces.txt")) << content;
    return marks({"faces=" + folder.file("faces.txt")});
  };
  CHECK(from("2\n3 # the last\n") == Marks{0, 0, 1, 1});
  CHECK(from("0 1 0 1") == Marks{0, 1, 0, 1});
  CHECK(from("3 1 0 1") == Marks{1, 1, 0, 1});  // indices, as a mark of 3 there is none
  CHECK_THROWS_WITH(from("1\n4\n"), Catch::Contains("line 2"));
  CHECK_THROWS_AS(from("-1"), InvalidInput);
  CHECK_THROWS_AS(from("a"), InvalidInput);
  CHECK_THROWS_AS(marks({"faces=" + folder.file("none.txt")}), ReadError);
}
