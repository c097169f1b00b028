// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "space/curve/curve_query.h"
#include "space/curve/segment_crossings.h"

using namespace vdb_offset;

namespace {

/// One curve through points, in the polyline's frame.
Polyline line_through(const std::vector<Vec3d>& points) {
  std::vector<Segment> segments;
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i) segments.push_back({i, i + 1});
  CurveChains chains;
  chains.ends = 2;
  return make_polyline(points, segments, chains);
}

void require_closest(const Polyline& line, std::mt19937& numbers) {
  const CurveQuery query(line);
  std::uniform_real_distribution<double> coordinate(-0.2, 1.2);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3d x = i % 3 == 0 ? line.vertices[i] : Vec3d(coordinate(numbers), coordinate(numbers), 0);
    double least = 1e300;
    for (std::uint32_t s = 0; s < line.segments.size(); ++s)
      least = std::min(least, line.closest_on(s, x).squared_distance);
    const auto hint = static_cast<std::uint32_t>(numbers() % line.segments.size());
    const Closest closest = query(x, hint);
    CHECK(closest.distance == Approx(std::sqrt(least)).epsilon(1e-13).margin(1e-14));
    CHECK(std::sqrt(line.closest_on(closest.triangle, x).squared_distance) == closest.distance);
  }
}

/// Spokes from a point to those of a grid, of which many run the same way, and a segment across.
struct Hub {
  std::vector<Vec2d> positions{{0, 0}};
  std::vector<Segment> segments{{1, 2}};
  Hub() {
    for (int i = -5; i <= 5; ++i)
      for (int j = -5; j <= 5; ++j)
        if (i != 0 || j != 0) positions.emplace_back(i, j);
    for (std::uint32_t p = 1; p < positions.size(); ++p) segments.push_back(p % 2 != 0 ? Segment{0, p} : Segment{p, 0});
  }
  bool along(std::size_t s, std::size_t t) const {
    const Vec2d a = positions[s] - positions[0], b = positions[t] - positions[0];
    return a[0] * b[1] == a[1] * b[0] && a.dot(b) > 0;
  }
};

}  // namespace

TEST_CASE("crowded curves: the closest point is the one that all segments tell", "[curve]") {
  std::mt19937 numbers(1);
  std::uniform_real_distribution<double> coordinate(0, 1);
  std::vector<Vec3d> level, tilted, anywhere;
  for (int i = 0; i < 700; ++i) {
    const double x = coordinate(numbers);
    level.emplace_back(x, 0.25, 0);
    tilted.emplace_back(x, 0.37 * x, 0);
    anywhere.emplace_back(x, coordinate(numbers), 0);
  }
  for (const auto& points : {level, tilted, anywhere}) require_closest(line_through(points), numbers);
}

TEST_CASE("crossings: segments out of one point meet if they run the same way, wherever that goes", "[curve]") {
  Hub hub;
  REQUIRE(hub.segments.size() > SegmentFans::kLeast);
  SegmentCrossings finder(hub.segments, hub.positions);
  const auto require_pairs = [&](std::span<const std::uint32_t> asked) {
    std::vector<SegmentPair> all, some;
    for (std::uint32_t s = 1; s < hub.segments.size(); ++s)
      for (std::uint32_t t = s + 1; t < hub.segments.size(); ++t)
        if (hub.along(s, t)) all.emplace_back(s, t);
    for (const auto& pair : all)
      if (std::any_of(asked.begin(), asked.end(), [&](auto s) { return s == pair.first || s == pair.second; }))
        some.push_back(pair);
    const auto of_hub = [](const SegmentPair& pair) { return pair.first > 0; };
    std::vector<SegmentPair> found = *finder.all(100000);
    std::erase_if(found, [&](const SegmentPair& pair) { return !of_hub(pair); });
    CHECK(found == all);
    CHECK(finder.of(asked, of_hub) == some);
    const std::vector<std::uint8_t> crossed = finder.crossed();
    for (const auto& [s, t] : all) CHECK((crossed[s] && crossed[t]));
    CHECK_FALSE(finder.all(all.size() - 1));
  };
  require_pairs(std::vector<std::uint32_t>{3, 40, 41});
  // A spoke is turned onto others, one loses its length, and then the point that all share goes off.
  hub.positions[3] = {20, 20}, hub.positions[50] = {0, 0};
  const std::vector<std::uint32_t> turned{0, 3, 50};
  finder.update(turned);
  require_pairs(turned);
  hub.positions[0] = {-30, 7};
  std::vector<std::uint32_t> rest;
  for (std::uint32_t s = 1; s < hub.segments.size(); ++s) rest.push_back(s);
  finder.update(rest);
  require_pairs(turned);
}
