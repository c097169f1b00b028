// SPDX-License-Identifier: Apache-2.0
#include "ground/plane/plane_mesh.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "ground/mesh/exact_predicates.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

/// Adds a closed polygon whose points are radius(angle) away from a centre; the region is inside of it, or around it.
template <class Radius>
void add_loop(PlaneRegion& region, int count, const Vec2d& centre, bool is_inside, Radius&& radius) {
  const auto first = static_cast<std::uint32_t>(region.points.size()), n = static_cast<std::uint32_t>(count);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = (is_inside ? 2 : -2) * std::numbers::pi * i / count;
    region.points.push_back(centre + Vec2d(std::cos(angle), std::sin(angle)) * radius(angle));
    region.segments.push_back({first + i, first + (i + 1) % n});
  }
}

void add_circle(PlaneRegion& region, int count, double radius, bool is_inside, const Vec2d& centre = Vec2d(0.0)) {
  add_loop(region, count, centre, is_inside, [=](double) { return radius; });
}

double twice_area(const PlaneRegion& region) {
  double sum = 0;
  for (const auto& [a, b] : region.segments)
    sum += region.points[a][0] * region.points[b][1] - region.points[a][1] * region.points[b][0];
  return sum;
}

struct Judged {
  std::vector<double> roundness;  // rising
  double largest_step = 1;        // of areas across an edge
  std::size_t triangles = 0;

  double quantile(double share) const {
    return roundness[static_cast<std::size_t>(share * static_cast<double>(roundness.size() - 1))];
  }
};

/// Requires a mesh to be one of its region: by its edges, exact orientations, and its area.
Judged judge(const PlaneRegion& region, const PlaneMesh& mesh) {
  std::vector<Vec2d> points = region.points;
  points.insert(points.end(), mesh.added.begin(), mesh.added.end());
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> sides;
  Judged judged;
  judged.triangles = mesh.triangles.size();
  double area = 0;
  bool are_all_ccw = true, are_all_once = true;
  for (const auto& t : mesh.triangles) {
    const Vec2d &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    are_all_ccw &= side_of(a, b, c) > 0;
    const double own = ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2;
    area += own;
    judged.roundness.push_back(4 * std::numbers::sqrt3 * own /
                               ((a - b).lengthSqr() + (b - c).lengthSqr() + (c - a).lengthSqr()));
    for (std::size_t k = 0; k < 3; ++k) are_all_once &= sides.try_emplace({t[k], t[(k + 1) % 3]}, own).second;
  }
  CHECK(are_all_ccw);
  CHECK(are_all_once);
  std::size_t alone = 0, missing = 0;
  for (const auto& [ends, own] : sides) {
    const auto twin = sides.find({ends.second, ends.first});
    if (twin == sides.end()) ++alone;
    else judged.largest_step = std::max(judged.largest_step, own / twin->second);
  }
  for (const auto& [a, b] : region.segments) missing += !sides.contains({a, b});
  CHECK(missing == 0);
  CHECK(alone == region.segments.size());
  CHECK(area == Approx(twice_area(region) / 2).epsilon(1e-12));
  std::sort(judged.roundness.begin(), judged.roundness.end());
  return judged;
}

Judged meshed(const PlaneRegion& region) { return judge(region, mesh_plane(region)); }

}  // namespace

TEST_CASE("a region of the plane is filled with round triangles that keep its segments") {
  PlaneRegion region;
  double of_most = 0.75;
  SECTION("a disc") { add_circle(region, 48, 1, true); }
  SECTION("a ring whose width is that of a few segments on one side, and of many on the other") {
    add_circle(region, 100, 1.2, true);
    add_circle(region, 100, 1, false, {0.1, 0});
  }
  SECTION("two discs side by side, and one in a ring") {
    add_circle(region, 40, 1, true);
    add_circle(region, 40, 1, true, {5, 0});
    add_circle(region, 60, 2, true, {0, 9});
    add_circle(region, 60, 1.5, false, {0, 9});
    add_circle(region, 30, 0.5, true, {0, 9});
    of_most = 0.7;  // three rows fit into the ring
  }
  SECTION("around two circles of other segments that nearly touch") {
    add_circle(region, 60, 10, true);
    add_circle(region, 80, 1, false, {-1.05, 0});
    add_circle(region, 300, 1, false, {1.05, 0});
    of_most = 0.7;  // one segment fits between them
  }
  SECTION("a square whose sides have points in a row, and those of another in a row with them") {
    for (const double shift : {0.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(region.points.size());
      for (int i = 0; i < 32; ++i) {
        const double along = (i % 8) / 8.0;
        const Vec2d at[] = {{along, 0}, {1, along}, {1 - along, 1}, {0, 1 - along}};
        region.points.push_back(at[i / 8] + Vec2d(2 * shift, 0));
        region.segments.push_back(
            {first + static_cast<std::uint32_t>(i), first + static_cast<std::uint32_t>((i + 1) % 32)});
      }
    }
  }
  const Judged judged = meshed(region);
  CHECK(judged.roundness.front() >= 0.6);
  // Of few triangles, most are at segments.
  CHECK(judged.quantile(judged.triangles > 500 ? 0.01 : 0.05) >= of_most);
}

TEST_CASE("sizes grow from the segments as far as is asked for") {
  PlaneRegion region;
  add_circle(region, 24, 20, true);
  add_circle(region, 200, 0.5, false);
  const Judged coarse = meshed(region);
  region.growth = 1.1;
  const Judged fine = meshed(region);
  CHECK(fine.triangles > 2 * coarse.triangles);
  // Areas go by the square; neighbours are as different as growth and roundness make them.
  CHECK(coarse.largest_step < 4);
  CHECK(fine.largest_step < 4);
  region.growth = 1.3;
  region.longest = 1;
  const PlaneMesh bounded = mesh_plane(region);
  const Judged judged = judge(region, bounded);
  double longest = 0;
  std::vector<Vec2d> points = region.points;
  points.insert(points.end(), bounded.added.begin(), bounded.added.end());
  for (const auto& t : bounded.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (points[t[k]].length() < 12 && points[t[(k + 1) % 3]].length() < 12)
        longest = std::max(longest, (points[t[k]] - points[t[(k + 1) % 3]]).length());
  CHECK(longest < 1.8);
  CHECK(judged.triangles > coarse.triangles);
}

TEST_CASE("any simple polygon is filled") {
  const int seed = GENERATE(range(0, 40));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.05, 1);
  PlaneRegion region;
  const int count = 3 + static_cast<int>(random() % 60);
  // Shares change from point to point, so that segments are long and short, and corners sharp.
  add_loop(region, count, Vec2d(0.0), true, [&](double) { return share(random); });
  if (seed % 2 == 1) add_loop(region, 12, Vec2d(0.0), false, [&](double) { return 0.04 * share(random); });
  meshed(region);
}

TEST_CASE("the same region gives the same triangles, wherever it is by powers of two") {
  PlaneRegion region;
  add_loop(region, 50, Vec2d(0.0), true, [](double angle) { return 1 + 0.3 * std::sin(5 * angle); });
  const PlaneMesh mesh = mesh_plane(region);
  PlaneRegion larger = region;
  for (Vec2d& x : larger.points) x *= 1024;
  const PlaneMesh other = mesh_plane(larger);
  CHECK(mesh.triangles == other.triangles);
  REQUIRE(mesh.added.size() == other.added.size());
  CHECK(mesh.added.back() * 1024 == other.added.back());
}

TEST_CASE("what is no region of the plane is refused") {
  PlaneRegion region;
  region.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  SECTION("segments that cross") { region.segments = {{0, 1}, {1, 3}, {3, 2}, {2, 0}}; }
  SECTION("segments that do not close") { region.segments = {{0, 1}, {1, 2}, {2, 3}}; }
  SECTION("a segment through a point") {
    region.points.emplace_back(0.5, 0);
    region.segments = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  }
  SECTION("two points at one place") {
    region.points.emplace_back(1, 1);
    region.segments = {{0, 1}, {1, 2}, {4, 3}, {3, 0}};
  }
  SECTION("a region on the right of its segments") { region.segments = {{0, 3}, {3, 2}, {2, 1}, {1, 0}}; }
  CHECK_THROWS_AS(mesh_plane(region), InvalidInput);
}
