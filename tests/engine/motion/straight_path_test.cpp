// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/straight_path.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "space/query/closest_query.h"
#include "support/oracles.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

struct StraightFixture {
  Surface surface;
  ClosestQuery query;

  explicit StraightFixture(const Polygons& mesh) : surface(framed(mesh)), query(surface) {}

  static Surface framed(const Polygons& mesh) {
    Surface made = build_surface(mesh.view(), {});
    to_local_frame(made, 0.05);
    return made;
  }
  /// A try of each vertex.
  std::vector<StraightTry> all(int side, double distance) const {
    std::vector<StraightTry> tries;
    for (std::uint32_t v = 0; v < surface.vertices.size(); ++v) tries.push_back({v, side, distance});
    return tries;
  }
  std::vector<std::optional<KnownEnd>> ends(int side, double distance) const {
    const std::vector<StraightTry> tries = all(side, distance);
    return StraightPaths<ClosestQuery>(query, tries)();
  }
  bool may_all_end(int side, double distance) const {
    const std::vector<StraightTry> tries = all(side, distance);
    return StraightPaths<ClosestQuery>(query, tries).may_all_end();
  }
  Vec3d in_world(const Vec3d& x) const { return x + surface.origin; }
};

}  // namespace

TEST_CASE("straight paths: off a plane they end straight above, on either side", "[straight_path][oracle]") {
  const StraightFixture plane(shapes::patch(1, 0, 6));
  for (const int side : {1, -1})
    for (const double distance : {0.01, 0.3, 5.0}) {
      CHECK(plane.may_all_end(side, distance));
      const auto ends = plane.ends(side, distance);
      for (std::uint32_t v = 0; v < ends.size(); ++v) {
        REQUIRE(ends[v]);
        CHECK((ends[v]->position - plane.surface.vertices[v] - Vec3d(0, 0, side * distance)).length() <
              1e-9 * distance);
        CHECK(ends[v]->distance == Approx(distance).epsilon(kStopTolerance));
      }
    }
}

TEST_CASE("straight paths: out of a convex solid they are as long as the distance", "[straight_path][oracle]") {
  const Polygons mesh = shapes::icosphere(0.5, 2);
  const StraightFixture sphere(mesh);
  const auto ends = sphere.ends(1, 0.2);
  for (std::uint32_t v = 0; v < ends.size(); ++v) {
    REQUIRE(ends[v]);
    // The vertex itself is what is closest to all points of the line.
    CHECK((ends[v]->position - sphere.surface.vertices[v]).length() == Approx(0.2).epsilon(1e-9));
    CHECK(test::brute_force_distance(mesh.view(), sphere.in_world(ends[v]->position)) == Approx(0.2).epsilon(1e-9));
  }
  // Inward, all lines get beyond the centre, where what is closest lies on the other side.
  CHECK_FALSE(sphere.may_all_end(-1, 0.7));
  for (const auto& end : sphere.ends(-1, 0.7)) CHECK_FALSE(end);
}

TEST_CASE("straight paths: in a cube they end on the smaller cube, but for those that another face decides",
          "[straight_path][oracle]") {
  constexpr double kHalf = 0.5, kRow = 0.125;
  const StraightFixture cube(shapes::box(Vec3d(2 * kHalf), 8, true));
  for (const double distance : {0.1, 0.2, 0.3}) {
    const auto ends = cube.ends(-1, distance);
    int found = 0;
    for (std::uint32_t v = 0; v < ends.size(); ++v) {
      const Vec3d x = cube.in_world(cube.surface.vertices[v]);
      bool decided_by_others = false;
      Vec3d inside;
      for (int k = 0; k < 3; ++k) {
        const double room = kHalf - std::abs(x[k]);
        decided_by_others = decided_by_others || (room > kRow / 2 && room < distance);
        inside[k] = std::clamp(x[k], distance - kHalf, kHalf - distance);
      }
      REQUIRE(ends[v].has_value() == !decided_by_others);
      if (!ends[v]) continue;
      ++found;
      CHECK((cube.in_world(ends[v]->position) - inside).length() < 1e-9);
      CHECK(ends[v]->distance == Approx(distance).epsilon(kStopTolerance));
    }
    CHECK(found >= 8);  // the corners at least
  }
  CHECK(cube.may_all_end(-1, 0.1));
}

TEST_CASE("straight paths: one that something lies on has no end, although the end is at the distance",
          "[straight_path]") {
  constexpr double kDistance = 0.1;
  const Polygons cube = shapes::box(Vec3d(1), 1, true);
  const auto end_of_corner = [&](const Polygons& mesh) {
    const StraightFixture of(mesh);
    for (std::uint32_t v = 0; v < of.surface.vertices.size(); ++v)
      if ((of.in_world(of.surface.vertices[v]) - Vec3d(0.5)).length() < 1e-12) {
        const std::vector<StraightTry> tries{{v, -1, kDistance}};
        return StraightPaths<ClosestQuery>(of.query, tries)().front();
      }
    FAIL("no corner");
    return std::optional<KnownEnd>();
  };
  REQUIRE(end_of_corner(cube));
  // A speck on the diagonal, nearer to the corner than the ball around the end reaches.
  const Vec3d speck = Vec3d(0.5) - Vec3d(1).unit() * (0.35 * kDistance);
  CHECK((Vec3d(0.5 - kDistance) - speck).length() > 1.3 * kDistance);
  Polygons both = cube;
  const Polygons small = shapes::box(Vec3d(0.02 * kDistance), 1, true);
  for (const Vec3d& p : small.positions) both.positions.push_back(p + speck);
  for (std::size_t f = 0; f < small.face_count(); ++f) {
    for (const auto v : small.view().face(f))
      both.corners.push_back(v + static_cast<std::uint32_t>(cube.positions.size()));
    both.close_face();
  }
  CHECK_FALSE(end_of_corner(both));
}
