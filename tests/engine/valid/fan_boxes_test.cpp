// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "space/surface/surface.h"
#include "valid/faults/triangle_crossings.h"

using namespace vdb_offset;

namespace {

constexpr int kAround = 700;  // triangles: more than those of which all pairs are tested

/// Triangles that share a vertex, in all directions: many go through each other.
Polygons bush() {
  Polygons mesh;
  mesh.positions.emplace_back(0.3, -0.2, 0.1);
  std::mt19937 numbers(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < kAround; ++i) {
    const Vec3d middle = Vec3d(normal(numbers), normal(numbers), normal(numbers)).unit();
    for (int k = 0; k < 2; ++k)
      mesh.positions.push_back(mesh.positions[0] + middle +
                               Vec3d(normal(numbers), normal(numbers), normal(numbers)) * (i % 3 == 0 ? 1.0 : 0.05));
    mesh.add_face({0, static_cast<std::uint32_t>(2 * i + 1), static_cast<std::uint32_t>(2 * i + 2)});
  }
  return mesh;
}

/// Triangles around an edge, each tenth in the plane of the one before it.
Polygons book() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * (i % 10 == 0 ? i : i + 1) / kAround;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), i % 7 * 0.2);
    mesh.add_face({0, 1, static_cast<std::uint32_t>(i + 2)});
  }
  return mesh;
}

/// A cone over a flat fan that it goes through at some places.
Polygons cone_of(double dent) {
  Polygons mesh;
  mesh.positions = {{0, 0, 1}, {0, 0, 0}};
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), i % 50 == 0 ? -dent : 0);
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), i % 50 == 1 ? dent : 0);
  }
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const std::uint32_t next = (i + 1) % kAround;
    mesh.add_face({0, 2 * i + 2, 2 * next + 2});
    mesh.add_face({1, 2 * next + 3, 2 * i + 3});
  }
  return mesh;
}

/// All pairs, each triangle tested against all that its box meets.
std::vector<TrianglePair> brute(const Surface& surface, const std::vector<Vec3d>& positions) {
  std::vector<std::uint32_t> all(surface.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<TrianglePair> pairs;
  for (const auto& [s, t] : CrossingFinder(surface, positions).met_by(all, [&](std::uint32_t t) {
         const auto& [a, b, c] = surface.triangles[t];
         return std::array<Vec3d, 3>{positions[a], positions[b], positions[c]};
       }))
    if (s < t) pairs.emplace_back(s, t);
  return pairs;
}

}  // namespace

TEST_CASE("fans: triangles around one vertex or edge meet those that all pairs say", "[crossings][fans]") {
  const std::vector<Polygons> meshes = {bush(), book(), cone_of(0.01), cone_of(0)};
  const std::vector<bool> any = {true, true, true, false};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Surface surface = build_surface(meshes[i].view(), {});
    CAPTURE(i);
    std::vector<Vec3d> positions = surface.vertices;
    CrossingFinder finder(surface, positions);
    const std::vector<TrianglePair> pairs = brute(surface, positions);
    CHECK(pairs.empty() != any[i]);
    CHECK(finder.all() == pairs);
    CHECK(finder.listed().pairs == pairs);
    // Some vertices move, so that others meet.
    std::mt19937 numbers(2);
    std::normal_distribution<double> normal(0, 0.1);
    std::vector<std::uint8_t> moved(positions.size(), 0);
    for (std::size_t v = 5; v < positions.size(); v += 17) {
      positions[v] += Vec3d(normal(numbers), normal(numbers), normal(numbers));
      moved[v] = 1;
    }
    std::vector<std::uint32_t> changed;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& corners = surface.triangles[t];
      if (std::any_of(corners.begin(), corners.end(), [&](auto v) { return moved[v]; })) changed.push_back(t);
    }
    finder.update(changed);
    const std::vector<TrianglePair> now = brute(surface, positions);
    CHECK(now != pairs);
    CHECK(finder.all() == now);
    std::vector<TrianglePair> of_changed = now;
    std::erase_if(of_changed, [&](const TrianglePair& pair) {
      return !finder.is_updated(pair.first) && !finder.is_updated(pair.second);
    });
    CHECK(finder.of_updated() == of_changed);
    for (const std::uint32_t t : {changed.front(), changed.back()}) {
      std::vector<std::uint32_t> met = finder.met_by(t, positions), expected;
      for (const auto& [a, b] : now)
        if (a == t || b == t) expected.push_back(a == t ? b : a);
      std::sort(met.begin(), met.end());
      std::sort(expected.begin(), expected.end());
      CHECK(met == expected);
    }
  }
}
