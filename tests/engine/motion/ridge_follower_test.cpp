// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/paths/ridge_path.h"
#include "space/query/closest_query.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

using Rise = detail::Ridge::Rise;

constexpr double kPlaneTolerance = 1e-12;

/// The path from a point inside a mesh, in the mesh's coordinates.
RidgePath ridge_from(const Polygons& mesh, const Vec3d& x, double target) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.05);
  const ClosestQuery query(surface);
  const Vec3d from = x - surface.origin;
  RidgePath path = RidgeFollower<ClosestQuery>(query, target, kPlaneTolerance, kPlaneTolerance)(from, query(from, 0));
  for (std::size_t i = 0; i < path.count; ++i) path.corners[i] += surface.origin;
  return path;
}

void check_corners(const RidgePath& path, std::initializer_list<Vec3d> expected) {
  REQUIRE(path.found);
  REQUIRE(path.count == expected.size());
  std::size_t i = 0;
  for (const Vec3d& corner : expected) {
    CAPTURE(i);
    CHECK((path.corners[i++] - corner).length() < 1e-11);
  }
}

}  // namespace

TEST_CASE("ridge: the distance rises fastest between the directions away from what is closest", "[ridges][oracle]") {
  const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  detail::Ridge ridge(x);
  CHECK(ridge.direction() == x);
  CHECK(ridge.slope() == 1);
  CHECK(ridge.add(y) == Rise::Onward);
  CHECK((ridge.direction() - Vec3d(1, 1, 0).unit()).length() < 1e-15);
  CHECK(ridge.slope() == Approx(std::sqrt(1.0 / 2)).epsilon(1e-15));
  CHECK(ridge.add(z) == Rise::Onward);
  CHECK((ridge.direction() - Vec3d(1, 1, 1).unit()).length() < 1e-15);
  CHECK(ridge.slope() == Approx(std::sqrt(1.0 / 3)).epsilon(1e-15));
  CHECK(ridge.add(-(x + y + z).unit()) == Rise::Top);
}

TEST_CASE("ridge: opposite fronts meet; one plane is one; almost one plane is unclear", "[ridges][oracle]") {
  const Vec3d x(1, 0, 0);
  CHECK(detail::Ridge(x).add(-x) == Rise::Top);
  CHECK(detail::Ridge(x).add(Vec3d(1, 1e-6, 0).unit()) == Rise::Same);
  CHECK(detail::Ridge(x).add(Vec3d(1, 0.1, 0).unit()) == Rise::Unclear);
  CHECK(detail::Ridge(x).is_risen_by(x));
  CHECK_FALSE(detail::Ridge(x).is_risen_by(-x));
}

TEST_CASE("ridge: a third front that falls behind two others does not turn it", "[ridges][oracle]") {
  // Of b and c, whose middle is along z, a is farther from that than they are.
  const Vec3d b = Vec3d(std::sqrt(0.75), 0, 0.5), c = Vec3d(-std::sqrt(0.75), 0, 0.5),
              a = Vec3d(0, std::sqrt(1 - 0.49), 0.7);
  detail::Ridge ridge(a);
  REQUIRE(ridge.add(b) == Rise::Onward);
  CHECK(ridge.add(c) == Rise::Onward);
  CHECK((ridge.direction() - Vec3d(0, 0, 1)).length() < 1e-14);
  CHECK(ridge.slope() == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("ridge path: in a block, down from a face, along the ridge with another, to the middle plane",
          "[ridges][oracle]") {
  // Half sides 0.5, 0.4 and 0.2.
  const Polygons block = shapes::box(Vec3d(1, 0.8, 0.4), 6, true);
  const Vec3d below_top(0.1, 0.05, 0.19), beside_x(0.49, 0.05, 0.1);
  check_corners(ridge_from(block, below_top, 0.1), {Vec3d(0.1, 0.05, 0.1)});
  check_corners(ridge_from(block, below_top, 0.3), {Vec3d(0.1, 0.05, 0)});
  CHECK(ridge_from(block, below_top, 0.3).end.distance == Approx(0.2).epsilon(1e-12));
  check_corners(ridge_from(block, beside_x, 0.05), {Vec3d(0.45, 0.05, 0.1)});
  check_corners(ridge_from(block, beside_x, 0.15), {Vec3d(0.4, 0.05, 0.1), Vec3d(0.35, 0.05, 0.05)});
  check_corners(ridge_from(block, beside_x, 0.3), {Vec3d(0.4, 0.05, 0.1), Vec3d(0.3, 0.05, 0)});
  CHECK(ridge_from(block, beside_x, 0.3).end.distance == Approx(0.2).epsilon(1e-12));
}

TEST_CASE("ridge path: none where faces stand for a curved surface", "[ridges]") {
  CHECK_FALSE(ridge_from(shapes::icosphere(0.5, 3), Vec3d(0.31, 0.2, 0.1), 0.4).found);
}
