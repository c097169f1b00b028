// SPDX-License-Identifier: Apache-2.0
#include "products/layers/rail_stacks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "space/query/closest_query.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

// The relative error of distances to which points on rails are solved.
constexpr double kRailTolerance = 1e-7;

/// A plane, its vertices with paths of one displacement.
struct PlaneRails {
  Polygons mesh = shapes::patch(1, 0, 4);
  Surface surface;
  ClosestQuery query;
  std::vector<Vec3d> source;
  std::vector<Distances> heights;
  Paths paths;
  AskedLayers asked;

  PlaneRails(const Vec3d& displacement, std::vector<Distances> of_layers)
      : surface(framed(mesh)), query(surface), heights(std::move(of_layers)), asked(begin(displacement)) {}

  static Surface framed(const Polygons& mesh) {
    Surface made = build_surface(mesh.view(), {});
    to_local_frame(made, 0.1);
    return made;
  }
  AskedLayers begin(const Vec3d& displacement) {
    for (const Vec3d& p : surface.vertices) source.push_back(p + surface.origin);
    paths.displacement.assign(source.size(), displacement);
    paths.achieved.assign(source.size(), std::abs(displacement[2]));
    return {source, surface.origin, heights};
  }
  bool put(RailStacks& stacks, std::uint32_t v, double top = 1) const {
    stacks.flatten(v);
    return stacks.put_down(v, top, QueryDistance<ClosestQuery>(query, surface.triangles_around(v).front()),
                           [](std::size_t, double) { return true; });
  }
};

std::vector<double> heights_of(const RailStacks& stacks, std::uint32_t v) {
  std::vector<double> heights;
  for (const Vec3d& p : stacks.of(v)) heights.push_back(p[2]);
  return heights;
}

}  // namespace

TEST_CASE("rails: layers stand at the share of their heights, straight above", "[layers][rails][oracle]") {
  for (const int side : {1, -1}) {
    PlaneRails plane(Vec3d(0, 0, side * 0.4), {side * 0.1, side * 0.25, side * 0.4});
    CHECK(plane.asked.side == side);
    CHECK(plane.asked.thickness(0) == 0.4);
    RailStacks stacks(plane.asked, plane.paths);
    std::uint32_t v = 0;
    for (const double share : {1.0, 0.5, 0.01}) {
      stacks.start(v, Vec3d(0.0), 1);
      stacks.set_share(v, share);
      CHECK(stacks.is_at_end(v) == (share == 1));
      CHECK(stacks.thickness(v) == Approx(0.4 * share).epsilon(1e-15));
      stacks.flatten(v);
      CHECK(stacks.positions().is_flat(v));
      REQUIRE(plane.put(stacks, v));
      CHECK(stacks.of(v)[0] == plane.source[v]);
      const double expected[] = {0, 0.1, 0.25, 0.4};
      for (std::size_t k = 1; k < 4; ++k)
        CHECK((stacks.of(v)[k] - plane.source[v] - Vec3d(0, 0, side * share * expected[k])).length() <=
              kRailTolerance * share * expected[k]);
      ++v;
    }
    const auto finished = std::move(stacks).finish();
    CHECK(finished.share[1] == 0.5);
    CHECK(finished.first_achieved[1] == Approx(0.05).epsilon(kRailTolerance));
    CHECK(finished.positions.layers() == 3);
  }
}

TEST_CASE("rails: layers on a bent rail are where it crosses their heights; straightened, on a line",
          "[layers][rails][oracle]") {
  // The path leads sideways; the rail leaves the wall straight up.
  const Vec3d whole(0.3, 0, 0.4), bend = Vec3d(0, 0, 0.5) - whole;
  PlaneRails plane(whole, {0.05, 0.2, 0.4});
  RailStacks stacks(plane.asked, plane.paths);
  constexpr std::uint32_t kVertex = 3;
  stacks.start(kVertex, bend, 1);
  REQUIRE(plane.put(stacks, kVertex));
  const Rail rail{whole, bend};
  for (std::size_t k = 1; k <= 3; ++k) {
    const double height = plane.heights[k - 1][kVertex];
    double low = 0, high = 1;  // where the rail is at the height: z rises along all of it
    for (int i = 0; i < 60; ++i) (rail((low + high) / 2)[2] < height ? low : high) = (low + high) / 2;
    const Vec3d up = stacks.of(kVertex)[k] - plane.source[kVertex];
    CHECK(up[2] == Approx(height).epsilon(kRailTolerance));
    CHECK((up - rail(low)).length() < 10 * kRailTolerance * height);
  }
  // The outermost layer is the end of the path, whatever the rail.
  CHECK(stacks.outermost(kVertex) == plane.source[kVertex] + whole);

  const std::vector<double> before = heights_of(stacks, kVertex);
  stacks.straighten(kVertex);
  CHECK(heights_of(stacks, kVertex) == before);  // until they are put again
  REQUIRE(plane.put(stacks, kVertex));
  for (std::size_t k = 1; k <= 3; ++k) {
    const Vec3d up = stacks.of(kVertex)[k] - plane.source[kVertex];
    CHECK((up - whole * (up[2] / 0.4)).length() < 1e-9);
    CHECK(up[2] == Approx(plane.heights[k - 1][kVertex]).epsilon(kRailTolerance));
  }
}

TEST_CASE("rails: a descent that begins below the outermost layer, or is ended, says so", "[layers][rails]") {
  PlaneRails plane(Vec3d(0, 0, 0.4), {0.1, 0.4});
  RailStacks stacks(plane.asked, plane.paths);
  stacks.start(0, Vec3d(0.0), 1);
  CHECK(stacks.top_of(0) == 1);
  stacks.set_share(0, 0.5);
  CHECK_FALSE(plane.put(stacks, 0, 0.3));
  CHECK(plane.put(stacks, 0, 0.6));
  // The next descent begins above a share that is a little less, but below the whole rail.
  stacks.set_share(0, 0.45);
  CHECK(stacks.top_of(0) > 0.45);
  CHECK(stacks.top_of(0) < 1);
  CHECK(plane.put(stacks, 0, stacks.top_of(0)));
  std::vector<std::size_t> placed;
  CHECK_FALSE(stacks.put_down(0, 1, QueryDistance<ClosestQuery>(plane.query, 0), [&](std::size_t k, double distance) {
    placed.push_back(k);
    CHECK(distance == Approx(0.45 * 0.4).epsilon(kRailTolerance));
    return false;
  }));
  CHECK(placed == std::vector<std::size_t>{1});
}

TEST_CASE("rails: a snapshot restores the vertices it has, and no others", "[layers][rails]") {
  PlaneRails plane(Vec3d(0, 0, 0.4), {0.1, 0.4});
  RailStacks stacks(plane.asked, plane.paths);
  for (const std::uint32_t v : {1u, 2u, 5u}) {
    stacks.start(v, Vec3d(0.0), 1);
    stacks.set_share(v, 0.8);
    REQUIRE(plane.put(stacks, v));
  }
  const std::vector<double> before = heights_of(stacks, 2);
  const RailStacks::Snapshot snapshot(stacks, {1, 2});
  for (const std::uint32_t v : {1u, 2u, 5u}) {
    stacks.set_share(v, 0.2);
    REQUIRE(plane.put(stacks, v));
  }
  const std::vector<double> lowered = heights_of(stacks, 5);
  REQUIRE(lowered != before);
  CHECK(snapshot.restore(2, stacks));
  CHECK_FALSE(snapshot.restore(5, stacks));
  CHECK(heights_of(stacks, 2) == before);
  CHECK(heights_of(stacks, 1) == lowered);
  CHECK(heights_of(stacks, 5) == lowered);
  CHECK(std::move(stacks).finish().first_achieved[2] == Approx(0.08).epsilon(kRailTolerance));
}
