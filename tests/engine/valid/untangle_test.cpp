// SPDX-License-Identifier: Apache-2.0
#include "valid/untangle/untangle.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "space/query/closest_query.h"
#include "valid/untangle/schedule.h"
#include "valid/untangle/vertex_patches.h"
#include "vdb_offset/polygons.h"

using namespace vdb_offset;

namespace {

constexpr double kDistance = 3;
constexpr int kGridCells = 8;

/// A square of kGridCells by kGridCells cells of size 1, in the plane z = 0, each cut into two triangles.
Polygons plane_grid() {
  Polygons mesh;
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(i * (kGridCells + 1) + j); };
  for (int i = 0; i <= kGridCells; ++i)
    for (int j = 0; j <= kGridCells; ++j) mesh.positions.emplace_back(i, j, 0);
  for (int i = 0; i < kGridCells; ++i)
    for (int j = 0; j < kGridCells; ++j) {
      mesh.add_face({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.add_face({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

struct PlaneOffset {
  Surface surface;
  std::vector<Vec3d> displacement;

  PlaneOffset() : surface(build_surface(plane_grid().view(), {})) {
    to_local_frame(surface, 1);
    displacement.assign(surface.vertices.size(), Vec3d(0, 0, kDistance));
  }
  std::uint32_t vertex_at(double x, double y) const {
    for (std::uint32_t v = 0; v < surface.vertices.size(); ++v)
      if ((surface.vertices[v] + surface.origin - Vec3d(x, y, 0)).length() < 1e-9) return v;
    return kNone;
  }
  int folded() const {
    int count = 0;
    for (const auto& [a, b, c] : surface.triangles) {
      const auto at = [&](std::uint32_t v) { return surface.vertices[v] + displacement[v]; };
      count += !((at(b) - at(a)).cross(at(c) - at(a))[2] > 0);
    }
    return count;
  }
  double off_distance() const {
    double worst = 0;
    for (const Vec3d& d : displacement) worst = std::max(worst, std::abs(d[2] - kDistance));
    return worst;
  }
};

}  // namespace

TEST_CASE("untangle: a vertex that has slid over its neighbours comes back", "[untangle][oracle]") {
  for (const Vec3d slid : {Vec3d(1.6, 0.2, 0), Vec3d(-2.1, -1.3, 0), Vec3d(0.1, 1.2, 0)}) {
    PlaneOffset offset;
    const ClosestQuery query(offset.surface);
    const ConstrainedSurface constrained{query, offset.surface, {}, {}, {}};
    const Distances distances(kDistance);
    const std::uint32_t middle = offset.vertex_at(4, 4);
    REQUIRE(middle != kNone);
    offset.displacement[middle] += slid;
    REQUIRE(offset.folded() > 0);
    const std::vector<Vec3d> before = offset.displacement;
    const Untangler untangler(constrained, distances, kSchedule[0].energy);
    untangler(std::vector{middle}, offset.displacement);
    CHECK(offset.folded() == 0);
    CHECK(offset.off_distance() < 1e-8 * kDistance);
    for (std::uint32_t v = 0; v < before.size(); ++v)
      if (v != middle) CHECK(offset.displacement[v] == before[v]);
    // All faces are as in the source where the energy is least: straight above. A thorough run gets near to that.
    CHECK((offset.displacement[middle] - Vec3d(0, 0, kDistance)).length() < 0.05);
  }
}

TEST_CASE("untangle: one folded triangle, its corners a patch", "[untangle]") {
  PlaneOffset offset;
  const ClosestQuery query(offset.surface);
  const Distances distances(kDistance);
  // The triangle's corners, and no others, turned round its centre.
  Indices corners{offset.vertex_at(4, 4), offset.vertex_at(5, 4), offset.vertex_at(5, 5)};
  const Vec3d centre(14.0 / 3, 13.0 / 3, 0);
  for (const auto v : corners)
    offset.displacement[v] += 2.0 * (centre - offset.surface.vertices[v] - offset.surface.origin);
  sort_unique(corners);
  const int before = offset.folded();
  REQUIRE(before > 0);
  for (const UntangleSetting& setting : kSchedule) {
    PlaneOffset each = offset;
    const ConstrainedSurface of_each{query, each.surface, {}, {}, {}};
    Untangler(of_each, distances, setting.energy)(corners, each.displacement);
    CHECK(each.folded() == 0);
    CHECK(each.off_distance() < 1e-8 * kDistance);
  }
}

TEST_CASE("untangle: what is not folded stays where it is best", "[untangle]") {
  PlaneOffset offset;
  const ClosestQuery query(offset.surface);
  const ConstrainedSurface constrained{query, offset.surface, {}, {}, {}};
  const Distances distances(kDistance);
  const std::uint32_t middle = offset.vertex_at(4, 4);
  Untangler(constrained, distances, kSchedule[0].energy)(std::vector{middle}, offset.displacement);
  CHECK((offset.displacement[middle] - Vec3d(0, 0, kDistance)).length() < 1e-8);
}

TEST_CASE("untangle: patches share no face, and all of a patch is connected", "[untangle][patches]") {
  const PlaneOffset offset;
  Patches patches(offset.surface);
  Indices chosen;
  for (const auto& [x, y] : {std::pair(1, 1), {1, 2}, {2, 1}, {6, 6}, {4, 1}, {4, 7}})
    chosen.push_back(offset.vertex_at(x, y));
  sort_unique(chosen);
  patches.split(chosen);
  REQUIRE(patches.count() == 4);
  CHECK(patches.vertices() == chosen);
  CHECK(patches.of(offset.vertex_at(1, 1)) == patches.of(offset.vertex_at(1, 2)));
  CHECK(patches.of(offset.vertex_at(1, 1)) == patches.of(offset.vertex_at(2, 1)));
  CHECK(patches.of(offset.vertex_at(0, 0)) == kNone);
  patches.drop_if([](const Indices& patch, std::uint32_t) { return patch.size() == 1; });
  REQUIRE(patches.count() == 1);
  CHECK(patches[0].size() == 3);
  CHECK(patches.vertices() == patches[0]);
  CHECK(patches.of(offset.vertex_at(6, 6)) == kNone);
  patches.clear();
  CHECK(patches.count() == 0);
  CHECK(patches.of(offset.vertex_at(1, 1)) == kNone);
}
