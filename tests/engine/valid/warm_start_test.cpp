// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "support/oracles.h"
#include "valid/untangle/warm_start.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

std::size_t short_vertices(const OffsetResult& result) {
  std::size_t count = 0;
  for (const VertexState state : result.states) count += state != VertexState::Reached;
  return count;
}

/// With round corners, as other results are no start for mitered ones.
OffsetOptions round_corners() {
  OffsetOptions options;
  options.corners = Corners::Round;
  return options;
}

Distances each(std::vector<double> numbers) { return Distances(std::move(numbers)); }

}  // namespace

TEST_CASE("warm start: the farthest on one's own side, within four times, that follows none", "[warm_start]") {
  using Numbers = std::vector<std::size_t>;
  CHECK(find_warm_starts(std::vector<Distances>{}) == Numbers{});
  CHECK(find_warm_starts(std::vector<Distances>{0.5}) == Numbers{0});
  CHECK(find_warm_starts(std::vector<Distances>{0.25, 0.5, 0.375}) == Numbers{1, 1, 1});
  CHECK(find_warm_starts(std::vector<Distances>{0.3, -0.1, 0.2, -0.2}) == Numbers{0, 3, 0, 3});
  CHECK(find_warm_starts(std::vector<Distances>{0.25, 1, 0.249}) == Numbers{1, 1, 2});  // 1 is too far for the last
  CHECK(find_warm_starts(std::vector<Distances>{0.1, 1, 0.2}) == Numbers{2, 1, 2});
  CHECK(find_warm_starts(std::vector<Distances>{0.5, 0.5}) == Numbers{0, 0});
  CHECK(find_warm_starts(std::vector<Distances>{0, 0.5}) == Numbers{0, 1});
}

TEST_CASE("warm start: uneven distances follow what is nowhere nearer or on another side", "[warm_start]") {
  using Numbers = std::vector<std::size_t>;
  const Distances far = each({0.4, -0.4, 0.2}), nearer = each({0.2, -0.1, 0.2}), crosses = each({0.2, -0.1, 0.3}),
                  turned = each({0.2, 0.1, 0.2}), still = each({0.2, 0, 0.1});
  CHECK(find_warm_starts(std::vector<Distances>{nearer, far}) == Numbers{1, 1});
  CHECK(find_warm_starts(std::vector<Distances>{still, far}) == Numbers{1, 1});
  CHECK(find_warm_starts(std::vector<Distances>{crosses, far}) == Numbers{0, 1});
  CHECK(find_warm_starts(std::vector<Distances>{turned, far}) == Numbers{0, 1});
  CHECK(find_warm_starts(std::vector<Distances>{0.4, far}) == Numbers{0, 1});
  CHECK(find_warm_starts(std::vector<Distances>{each({0.2, 0.1, 0.1}), 0.3}) == Numbers{1, 1});
}

TEST_CASE("warm start: a way to a distance ends there exactly, on the straight way", "[warm_start][oracle]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 2, 5, 3);
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.05);
  const ClosestQuery query(surface);
  const ConstrainedSurface constrained{query, surface, {}, {}, {}};
  double worst = 0;
  for (std::uint32_t v = 0; v < surface.vertices.size(); v += 7) {
    // Not along the normal, so that other parts than those around the vertex decide in the hollows.
    const Vec3d way = (surface.vertex_normals[v].unit() + Vec3d(0.4, -0.3, 0.2)).unit() * 0.4;
    const Vec3d from = mesh.positions[surface.representative[v]];
    const double far = test::brute_force_distance(mesh.view(), from + way);
    for (const double distance : {0.02, 0.1, 0.2}) {
      const Vec3d part = displacement_to_distance(constrained, v, way, distance);
      if (part == way) {
        CHECK(far <= distance);
        continue;
      }
      worst = std::max(worst, std::abs(test::brute_force_distance(mesh.view(), from + part) - distance) / distance);
      CHECK(part.length() <= way.length());
      CHECK(part.cross(way).length() < 1e-8 * way.lengthSqr());
    }
  }
  CHECK(worst < 2e-9);
}

TEST_CASE("warm start: what was freed at a distance is free at less", "[warm_start][several]") {
  // Each of them folds on its own.
  const Polygons mesh = shapes::bumpy_sphere(1, 0.6, 2.5, 5, 4);
  const std::vector<Distances> distances = {-0.2, -0.4, -0.3};
  const std::vector<OffsetResult> results = offset_several(mesh.view(), distances, round_corners());
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    const LimitStatistics& limit = results[i].statistics.limit;
    CHECK(limit.before.total() > 0);
    CHECK((limit.followed_vertices > 0) == (i != 1));  // the farthest has none to follow
    CHECK(test::share(results[i], VertexState::Reached) == 1);
    CHECK(check_offset(mesh.view(), results[i].positions, {.distance = distances[i][0]}).faults.total() == 0);
    const test::DistanceErrors errors = test::judge(mesh.view(), results[i], distances[i][0], 11, true);
    CHECK(errors.worst_reached < 2e-6);
    CHECK(errors.worst_told < 2e-6);
    CHECK(errors.wrong_side == 0);
  }
}

TEST_CASE("warm start: what could not be freed is held back at less, too, and told", "[warm_start][several]") {
  const Polygons mesh = shapes::naca_wing("2412", 1, 1, 40, 10);
  const std::vector<Distances> distances = {-0.005, -0.01, -0.02};
  const std::vector<OffsetResult> results = offset_several(mesh.view(), distances, round_corners());
  CHECK(short_vertices(results[2]) > 0);
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    CHECK(results[i].statistics.limit.left.total() == 0);
    CHECK(check_offset(mesh.view(), results[i].positions, {.distance = distances[i][0]}).faults.total() == 0);
    const test::DistanceErrors errors = test::judge(mesh.view(), results[i], distances[i][0], 1, true);
    CHECK(errors.worst_reached < 2e-6);
    CHECK(errors.worst_beyond < 2e-6);
    CHECK(errors.worst_told < 2e-6);
    CHECK(errors.wrong_side == 0);
    if (i == 2) continue;
    const LimitStatistics& limit = results[i].statistics.limit;
    CHECK(limit.followed_vertices > 0);
    OffsetOptions alone = round_corners();
    alone.distance = distances[i];
    CHECK(short_vertices(results[i]) < 1.2 * static_cast<double>(short_vertices(offset(mesh.view(), alone))));
  }
}

TEST_CASE("warm start: states are honest where much is held back and fades", "[warm_start][several][long]") {
  const Polygons mesh = shapes::gear(18, 0.8, 1, 0.3, 0.3, 6);
  const std::vector<Distances> distances = {-0.06, -0.08, -0.125, -0.125};  // the last two are equal
  const std::vector<OffsetResult> results = offset_several(mesh.view(), distances, round_corners());
  CHECK(short_vertices(results[2]) > 0);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    INFO(i);
    CHECK(check_offset(mesh.view(), results[i].positions, {.distance = distances[i][0]}).faults.total() == 0);
    const test::DistanceErrors errors = test::judge(mesh.view(), results[i], distances[i][0], 1, true);
    CHECK(errors.worst_reached < 2e-6);
    CHECK(errors.worst_beyond < 2e-6);
    CHECK(errors.worst_told < 2e-6);
  }
  CHECK(short_vertices(results[3]) <= short_vertices(results[2]));
}

TEST_CASE("warm start: uneven offsets, parts in front of others, and skins off their source follow",
          "[warm_start][several][long]") {
  std::vector<double> farther, nearer;
  const Polygons bumpy = shapes::bumpy_sphere(1, 0.6, 2.5, 5, 4);
  for (const Vec3d& p : bumpy.positions) {
    farther.push_back(-0.3 - 0.1 * p[2]);
    nearer.push_back(farther.back() * (0.7 + 0.2 * p[0]));
  }
  const std::vector<Distances> uneven = {each(nearer), each(farther)};
  const std::vector<OffsetResult> skins = offset_several(bumpy.view(), uneven, round_corners());
  CHECK(skins[0].statistics.limit.followed_vertices > 0);
  for (std::size_t i = 0; i < 2; ++i) {
    INFO(i);
    CHECK(skins[i].statistics.limit.left.total() == 0);
    for (std::size_t v = 0; v < bumpy.positions.size(); v += 17) {
      const double distance = test::brute_force_distance(bumpy.view(), skins[i].positions[v]),
                   asked = std::abs(uneven[i][v]);
      CHECK(distance == Approx(skins[i].achieved[v]).epsilon(1e-6));
      if (skins[i].states[v] == VertexState::Reached) CHECK(distance == Approx(asked).epsilon(2e-6));
    }
  }

  const Polygons plates = shapes::plates(1, 0.1, 0.2, 12);
  OffsetOptions options = round_corners();
  for (std::size_t f = 0; f < plates.face_count(); ++f) {
    const auto face = plates.view().face(f);
    options.only.push_back(
        std::all_of(face.begin(), face.end(), [&](auto v) { return plates.positions[v][2] == -0.1; }));
  }
  const std::vector<Distances> distances = {0.25, 0.5, 0.4};
  for (const OffsetResult& result : offset_several(plates.view(), distances, options)) {
    CHECK(result.statistics.limit.left.total() == 0);
    for (const Vec3d& p : result.positions) CHECK(p[2] <= 0.2 + 1e-12);
  }

  options = round_corners();
  options.off_source = true;
  const Polygons wing = shapes::naca_wing("2412", 1, 1, 40, 10);
  const std::vector<Distances> inward = {-0.005, -0.02};
  for (const OffsetResult& result : offset_several(wing.view(), inward, options))
    CHECK(result.statistics.limit.left.total() == 0);
}
