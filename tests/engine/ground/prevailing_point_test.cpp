// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/prevailing_point.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using namespace vdb_offset;

namespace {

double cost_of(const std::vector<Vec3d>& normals, const std::vector<double>& areas, const Vec3d& x) {
  double cost = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) cost += areas[i] * std::abs(normals[i].dot(x) - 1);
  return cost;
}

}  // namespace

TEST_CASE("prevailing point: small planes do not keep large ones from where they ought to be", "[miter]") {
  const std::vector<Vec3d> corner = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK((*prevailing_point(corner, std::vector<double>{1, 1, 1}, 4) - Vec3d(1)).length() < 1e-15);
  std::vector<Vec3d> with_fin = corner;
  with_fin.insert(with_fin.end(), {Vec3d(0, 0, -1), Vec3d(-0.6, 0.8, 0)});
  const std::vector<double> areas = {1, 2, 3, 0.01, 0.02};
  CHECK((*prevailing_point(with_fin, areas, 4) - Vec3d(1)).length() < 1e-15);
  // Of two planes the point is the smallest on both; of one, straight above it.
  const std::vector<Vec3d> edge = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  CHECK((*prevailing_point(edge, std::vector<double>{1, 1, 0.1}, 4) - Vec3d(1, 1, 0)).length() < 1e-15);
  const std::vector<Vec3d> flat = {{0, 0, 1}, {0, 0, -1}};
  CHECK((*prevailing_point(flat, std::vector<double>{1, 0.1}, 4) - Vec3d(0, 0, 1)).length() < 1e-15);
}

TEST_CASE("prevailing point: no point costs less", "[miter]") {
  std::mt19937 random(11);
  std::normal_distribution<double> coordinate;
  std::uniform_real_distribution<double> area(0.1, 1);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Vec3d> normals;
    std::vector<double> areas;
    for (int k = 0; k < 2 + i % 7; ++k) {
      normals.push_back(Vec3d(coordinate(random), coordinate(random), coordinate(random) + 1).unit());
      areas.push_back(area(random));
    }
    const auto best = prevailing_point(normals, areas, 10);
    if (!best) continue;
    ++found;
    const double least = cost_of(normals, areas, *best);
    // The sum is convex: what no small step makes less is the least of all that are no longer.
    if (best->length() > 9) continue;
    for (int step = 0; step < 200; ++step) {
      const Vec3d beside = *best + Vec3d(coordinate(random), coordinate(random), coordinate(random)) * 0.01;
      CHECK(cost_of(normals, areas, beside) >= least - 1e-12);
    }
  }
  CHECK(found > 100);
}

TEST_CASE("prevailing point: there is none where no half of the area agrees, or farther than it may be", "[miter]") {
  CHECK_FALSE(prevailing_point({}, {}, 4));
  const std::vector<Vec3d> around = {{1, 0, 0}, {-0.5, 0.8660254037844386, 0}, {-0.5, -0.8660254037844386, 0}};
  CHECK_FALSE(prevailing_point(around, std::vector<double>{1, 1, 1}, 1.5));
  // A blade of 2 degrees meets 57 distances away.
  const std::vector<Vec3d> blade = {Vec3d(0.0175, 1, 0).unit(), Vec3d(0.0175, -1, 0).unit()};
  CHECK((*prevailing_point(blade, std::vector<double>{1, 1}, 100)).length() > 50);
  const auto shorter = prevailing_point(blade, std::vector<double>{1, 1}, 4);
  CHECK((!shorter || shorter->length() <= 4));
}
