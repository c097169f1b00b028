// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/offset.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "support/oracles.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

CheckResult check_of(const Polygons& source, const std::vector<Vec3d>& positions, std::optional<double> distance = {}) {
  CheckOptions options;
  options.distance = distance;
  return check_offset(source.view(), positions, options);
}

}  // namespace

TEST_CASE("check: an exact offset is valid, and its distance is found", "[check]") {
  const Polygons box = shapes::box(Vec3d(1), 6, true);
  OffsetOptions options;
  for (const double distance : {0.1, -0.1}) {
    options.distance = distance;
    const OffsetResult result = offset(box.view(), options);
    const CheckResult found = check_of(box, result.positions);
    CHECK(found.valid());
    CHECK(found.distance == Approx(distance).epsilon(1e-9));
    CHECK(found.beyond == 0);
    for (std::size_t v = 0; v < found.states.size(); ++v) {
      CHECK((found.states[v] == VertexState::Reached) == (result.states[v] == VertexState::Reached));
      CHECK(found.achieved[v] == Approx(result.achieved[v]).margin(1e-9));
    }
  }
}

TEST_CASE("check: what is wrong with an offset is told", "[check]") {
  const Polygons box = shapes::box(Vec3d(1), 6, true);
  OffsetOptions options;
  options.distance = 0.1;
  const std::vector<Vec3d> good = offset(box.view(), options).positions;
  std::vector<Vec3d> bad = good;
  bad[20] = Vec3d(0.05);
  CHECK(check_of(box, bad, 0.1).wrong_side == 1);
  bad = good;
  bad[20] *= 1.5;
  CHECK(check_of(box, bad, 0.1).beyond == 1);
  CHECK(check_of(box, good, 0.2).beyond == 0);
  for (const VertexState state : check_of(box, good, 0.2).states) CHECK(state == VertexState::Limited);
  bad = good;
  for (const auto v : box.view().face(17)) bad[v] = good[box.view().face(17)[0]];
  CHECK(check_of(box, bad, 0.1).faults.collapsed > 0);
  bad = good;
  std::swap(bad[box.view().face(17)[0]], bad[box.view().face(17)[1]]);
  const CheckResult swapped = check_of(box, bad, 0.1);
  CHECK(swapped.faults.inverted > 0);
  CHECK(swapped.faults.crossings > 0);
  CHECK_FALSE(swapped.valid());
  const Polygons torn = test::torn(box);
  bad = torn.positions;
  bad[0] += Vec3d(0.01);
  CHECK(check_of(torn, bad, 0.1).torn > 0);
}

TEST_CASE("check: miters at a border are found in its plane", "[check][symmetry][miter]") {
  const Polygons loft = test::open_loft(16);
  for (const bool finds : {true, false}) {
    CAPTURE(finds);
    OffsetOptions options;
    options.distance = 0.5;
    options.corners = Corners::Miter;
    options.symmetry.find = finds;
    const OffsetResult result = offset(loft.view(), options);
    CheckOptions check;
    check.distance = options.distance;
    check.corners = Corners::Miter;
    check.symmetry.find = finds;
    CHECK(check_offset(loft.view(), result.positions, check).states == result.states);
    check.symmetry.find = !finds;
    CHECK(check_offset(loft.view(), result.positions, check).states != result.states);
  }
}

TEST_CASE("check: what has passed a plane that is named is on the wrong side", "[check][symmetry]") {
  const Polygons tube = test::oblique_tube();
  OffsetOptions options;
  options.distance = 0.05;
  std::vector<Vec3d> sunk = offset(tube.view(), options).positions;
  for (Vec3d& x : sunk) x[2] -= 0.01;
  CheckOptions check;
  check.distance = options.distance;
  CHECK(check_offset(tube.view(), sunk, check).wrong_side == 0);
  check.symmetry.planes = {{Vec3d(0, 0, 1), 0}};
  CHECK(check_offset(tube.view(), sunk, check).wrong_side == 4);
}

TEST_CASE("check: a corner on some of its planes alone is not mitered if all meet in a point", "[check][miter]") {
  const Polygons cube = shapes::box(Vec3d(1), 1, false);
  std::vector<Vec3d> moved = cube.positions;
  for (Vec3d& x : moved)
    for (int k = 0; k < 2; ++k) x[k] += x[k] < 0 ? -0.1 : 0.1;
  CheckOptions check;
  check.distance = 0.1;
  check.corners = Corners::Miter;
  CHECK(check_offset(cube.view(), moved, check).beyond == 8);
  for (Vec3d& x : moved) x[2] += x[2] < 0 ? -0.1 : 0.1;
  CHECK(check_offset(cube.view(), moved, check).beyond == 0);
}

TEST_CASE("check: flat faces over a round source are off between their vertices", "[check]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  std::vector<Vec3d> positions = sphere.positions;
  for (Vec3d& p : positions) p *= 1.1;
  const FaceError error = check_of(sphere, positions, 0.1).faces;
  CHECK(error.samples == 40000);
  CHECK(error.mean < 0.02);
  CHECK(error.mean > 0.001);
  CHECK(error.quantile_99 <= error.worst);
  for (Vec3d& p : positions) p *= 3 / 1.1;
  CHECK(check_of(sphere, positions, 0.1).faces.mean == Approx(19).epsilon(1e-2));  // all at about distance 2
}

TEST_CASE("check: faces are proven to be within a tolerance, and no others are", "[check]") {
  const Polygons box = shapes::box(Vec3d(1), 6, true);
  OffsetOptions options;
  options.distance = 0.1;
  CheckOptions check;
  check.distance = 0.1;
  check.tolerance_share = 0.01;
  CHECK(check_offset(box.view(), offset(box.view(), options).positions, check).certified->certified == 1);
  options.corners = check.corners = Corners::Round;
  check.tolerance_share = {};
  const std::vector<Vec3d> positions = offset(box.view(), options).positions;
  CHECK_FALSE(check_offset(box.view(), positions, check).certified);
  // Of the 6 by 6 quads on each side, 4 by 4 do not touch an edge of the box, where faces are nearer.
  check.tolerance_share = 0.01;
  const auto by_share = check_offset(box.view(), positions, check).certified;
  REQUIRE(by_share);
  CHECK(by_share->share == 0.01);
  CHECK(by_share->certified == Approx(16 / 36.0).epsilon(1e-9));
  CHECK(by_share->there == 1);
  CHECK(by_share->worst_left > 0.1);
  CHECK(by_share->worst_left < 1);
  check = {.distance = Distances(0.1), .corners = Corners::Round, .tolerance_length = 0.09};
  const auto by_length = check_offset(box.view(), positions, check).certified;
  REQUIRE(by_length);
  CHECK(by_length->length == 0.09);
  CHECK(by_length->certified == 1);
  CHECK(by_length->worst_left == 0);
  // A vertex inside a side that is farther: what is around it is not there, however large the tolerance is.
  std::vector<Vec3d> moved = positions;
  const auto inside = std::find_if(box.positions.begin(), box.positions.end(), [](const Vec3d& p) {
    return p[2] == 0.5 && std::abs(p[0]) < 0.1 && std::abs(p[1]) < 0.1;
  });
  REQUIRE(inside != box.positions.end());
  moved[static_cast<std::size_t>(inside - box.positions.begin())][2] += 0.01;
  const auto with_moved = check_offset(box.view(), moved, check).certified;
  CHECK(with_moved->there < 1);
  CHECK(with_moved->certified == with_moved->there);
  // A part alone: nothing is said of faces that stay, which are at no distance.
  check.only.assign(box.face_count(), 0);
  for (std::size_t f = 0; f < box.face_count() / 6; ++f) check.only[f] = 1;
  options.only = check.only;
  options.border = check.border = Border::Free;
  const auto of_part = check_offset(box.view(), offset(box.view(), options).positions, check).certified;
  CHECK(of_part->certified == 1);
}

TEST_CASE("check: what cannot be compared is refused", "[check]") {
  const Polygons box = shapes::box(Vec3d(1), 2, true);
  CHECK_THROWS_AS(check_of(box, {}), InvalidInput);
  CHECK_THROWS_AS(check_offset({}, {}), InvalidInput);
  std::vector<Vec3d> positions = box.positions;
  positions[3][1] = std::nan("");
  CHECK_THROWS_AS(check_of(box, positions), InvalidInput);
  CHECK_THROWS_AS(check_offset(box.view(), box.positions, {.tolerance_share = 0.1, .tolerance_length = 1}),
                  InvalidInput);
  CHECK_THROWS_AS(check_offset(box.view(), box.positions, {.tolerance_share = -0.1}), InvalidInput);
  CHECK_THROWS_AS(check_offset(box.view(), box.positions, {.metric = {{1, 1, 2}}, .tolerance_share = 0.1}),
                  InvalidInput);
  CHECK(check_of(box, box.positions).valid());
  CHECK(check_of(box, box.positions).distance == 0);
}

TEST_CASE("check: progress rises to its end, changes nothing, and cancels at each step", "[check]") {
  const Polygons sphere = shapes::icosphere(1, 4);
  OffsetOptions making;
  making.distance = 0.1;
  const std::vector<Vec3d> positions = offset(sphere.view(), making).positions;
  CheckOptions options;
  options.distance = 0.1;
  options.threads = 1;  // so that no share is told late
  options.tolerance_share = 0.02;
  const CheckResult silent = check_offset(sphere.view(), positions, options);
  std::vector<double> shares;
  options.progress = [&](Stage stage, double share) {
    CHECK(stage == Stage::Measure);
    shares.push_back(share);
    return true;
  };
  const CheckResult told = check_offset(sphere.view(), positions, options);
  CHECK(told.achieved == silent.achieved);
  CHECK(told.states == silent.states);
  CHECK(told.certified->certified == silent.certified->certified);
  CHECK(told.faces.mean == silent.faces.mean);
  CHECK(std::is_sorted(shares.begin(), shares.end()));
  CHECK(shares.front() == 0);
  CHECK(shares.back() == Approx(1));
  CHECK(shares.size() > 10);
  for (const std::size_t last : {std::size_t{1}, shares.size() / 2, shares.size()}) {
    std::size_t calls = 0;
    options.progress = [&](Stage, double) { return ++calls < last; };
    CHECK_THROWS_AS(check_offset(sphere.view(), positions, options), Cancelled);
    CHECK(calls == last);
  }
}

TEST_CASE("check: a distance that is not said is that of most of the faces' area, with miters", "[check]") {
  CheckOptions miters, round;
  round.corners = Corners::Round;
  const auto found = [](const Polygons& mesh, double distance, const CheckOptions& how) {
    OffsetOptions options;
    options.distance = distance;
    options.corners = how.corners;
    return check_offset(mesh.view(), offset(mesh.view(), options).positions, how).distance;
  };
  const Polygons box = shapes::box(Vec3d(20, 20, 20), 1, true);
  for (const double d : {0.2, -0.3}) {
    CHECK(found(box, d, miters) == Approx(d));  // every vertex is sqrt(3) times as far
    CHECK(found(box, d, round) == Approx(d));
  }
  // The middles of faces are a little nearer, and vertices are where they were sent.
  const Polygons sphere = shapes::icosphere(1, 3);
  for (const CheckOptions& how : {miters, round}) CHECK(found(sphere, 0.1, how) == Approx(0.1).epsilon(1e-9));
}
