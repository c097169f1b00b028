// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/check.h"

#include <catch2/catch.hpp>

#include "support/oracles.h"
#include "vdb_offset/error.h"
#include "vdb_offset/scene.h"

using namespace vdb_offset;

namespace {

CheckResult check_of(const Polygons& source, const std::vector<Vec3d>& positions, std::optional<double> distance = {}) {
  CheckOptions options;
  options.distance = distance;
  return check_offset(source.view(), positions, options);
}

}  // namespace

TEST_CASE("check: an exact offset is valid, and its distance is found", "[check]") {
  const Polygons box = scene::box(Vec3d(1), 6, true);
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
  const Polygons box = scene::box(Vec3d(1), 6, true);
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

TEST_CASE("check: flat faces over a round source are off between their vertices", "[check]") {
  const Polygons sphere = scene::icosphere(1, 3);
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

TEST_CASE("check: what cannot be compared is refused", "[check]") {
  const Polygons box = scene::box(Vec3d(1), 2, true);
  CHECK_THROWS_AS(check_of(box, {}), InvalidInput);
  CHECK_THROWS_AS(check_offset({}, {}), InvalidInput);
  std::vector<Vec3d> positions = box.positions;
  positions[3][1] = std::nan("");
  CHECK_THROWS_AS(check_of(box, positions), InvalidInput);
  CHECK(check_of(box, box.positions).valid());
  CHECK(check_of(box, box.positions).distance == 0);
}
