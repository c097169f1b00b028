// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/miter_point.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace vdb_offset;

namespace {

Vec3d turned(double degrees_up, double degrees_round) {
  const double up = degrees_up * std::numbers::pi / 180, round = degrees_round * std::numbers::pi / 180;
  return {std::cos(up) * std::cos(round), std::cos(up) * std::sin(round), std::sin(up)};
}

/// The smallest x with n . x >= 1 for all normals, by trying every set of up to three planes on which it may lie.
Vec3d smallest_beyond(const std::vector<Vec3d>& normals) {
  Vec3d best(1e30);
  const auto offer = [&](const Vec3d& x) {
    if (!x.isFinite() || !(x.lengthSqr() < best.lengthSqr())) return;
    for (const Vec3d& n : normals)
      if (n.dot(x) < 1 - 1e-9) return;
    best = x;
  };
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3d& a = normals[i];
    offer(a);
    for (std::size_t k = i + 1; k < normals.size(); ++k) {
      const Vec3d& b = normals[k];
      offer((a + b) / (1 + a.dot(b)));
      for (std::size_t l = k + 1; l < normals.size(); ++l) {
        const Vec3d& c = normals[l];
        offer((b.cross(c) + c.cross(a) + a.cross(b)) / a.dot(b.cross(c)));
      }
    }
  }
  return best;
}

}  // namespace

TEST_CASE("miter point: one, two and three planes are met exactly", "[miter]") {
  const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::vector<std::pair<std::vector<Vec3d>, Vec3d>> kCases = {
      {{z}, z}, {{x, y}, {1, 1, 0}}, {{x, y, z}, {1, 1, 1}}, {{x, x, y}, {1, 1, 0}}};
  for (const auto& [normals, expected] : kCases) {
    const auto found = miter_point(normals);
    REQUIRE(found);
    CHECK((found->position - expected).length() < 1e-14);
    CHECK(found->excess == 0);
  }
}

TEST_CASE("miter point: planes that touch a cone meet in its tip, however many they are", "[miter]") {
  for (const int sides : {4, 5, 8, 200}) {
    std::vector<Vec3d> normals;
    for (int i = 0; i < sides; ++i) normals.push_back(turned(30, 360.0 * i / sides));
    const auto found = miter_point(normals);
    REQUIRE(found);
    CHECK((found->position - Vec3d(0, 0, 2)).length() < 1e-11);
    CHECK(found->excess == 0);
  }
  // Of a third of a cone as well: the tip is farther than the point beyond all of the planes.
  const std::vector<Vec3d> third = {turned(30, 0), turned(30, 30), turned(30, 60), turned(30, 90), turned(30, 120)};
  const auto found = miter_point(third);
  REQUIRE(found);
  CHECK((found->position - Vec3d(0, 0, 2)).length() < 1e-9);
}

TEST_CASE("miter point: more planes than have a common point get the smallest one beyond all", "[miter]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> up(20, 80), round(0, 360);
  int with_excess = 0;
  for (int i = 0; i < 500; ++i) {
    std::vector<Vec3d> normals;
    for (int k = 0; k < 4 + i % 5; ++k) normals.push_back(turned(up(random), round(random)));
    const Vec3d expected = smallest_beyond(normals);
    const auto found = miter_point(normals);
    REQUIRE(found);
    CHECK((found->position - expected).length() < 1e-9 * expected.length());
    double most = 0;
    for (const Vec3d& n : normals) most = std::max(most, n.dot(found->position) - 1);
    CHECK(found->excess == Approx(most).margin(1e-12));
    with_excess += found->excess > 0.01;
  }
  CHECK(with_excess > 250);
}

TEST_CASE("miter point: two planes that are almost one do not send it along their crease", "[miter]") {
  const double tiny = 1e-5;
  const std::vector<Vec3d> normals = {Vec3d(tiny, tiny, 1).unit(), Vec3d(-tiny, -tiny, 1).unit(), Vec3d(1, 0, 0)};
  const auto found = miter_point(normals);
  REQUIRE(found);
  CHECK((found->position - Vec3d(1, 0, 1)).length() < 10 * tiny);
}

TEST_CASE("miter point: planes that no direction leaves on their outer side have none", "[miter]") {
  CHECK_FALSE(miter_point({}));
  const std::vector<Vec3d> opposite = {{0, 0, 1}, {0, 0, -1}};
  CHECK_FALSE(miter_point(opposite));
  const std::vector<Vec3d> around = {turned(0, 0), turned(0, 120), turned(0, 240)};
  CHECK_FALSE(miter_point(around));
  const std::vector<Vec3d> tetrahedron = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  CHECK_FALSE(miter_point(tetrahedron));
}
