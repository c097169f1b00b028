// SPDX-License-Identifier: Apache-2.0
// One distance for each vertex, from those of faces.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

/// Quads along x from -5 to 5, a unit each, with a distance of 1 below x = 0 and of 3 beyond.
struct Strip {
  Polygons mesh;
  FaceDistances faces;

  explicit Strip(bool shared = true) {
    for (int i = 0; i < 10; ++i) {
      std::vector<std::uint32_t> corners;
      for (const auto& [x, y] : {std::pair{i, 0}, {i + 1, 0}, {i + 1, 1}, {i, 1}})
        corners.push_back(vertex(x - 5, y, shared));
      mesh.add_face({corners[0], corners[1], corners[2], corners[3]});
      faces.part.push_back(i < 5 ? 0 : 1);
      faces.at_corner.insert(faces.at_corner.end(), 4, i < 5 ? 1.0 : 3.0);
    }
  }

  std::uint32_t vertex(double x, double y, bool shared) {
    const Vec3d p(x, y, 0);
    for (std::uint32_t v = 0; shared && v < mesh.positions.size(); ++v)
      if (mesh.positions[v] == p) return v;
    mesh.positions.push_back(p);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  }

  double at(double x) const {
    const Distances distances = vertex_distances(mesh.view(), faces);
    double found = NAN;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (mesh.positions[v].x() != x) continue;
      if (!std::isnan(found)) CHECK(distances[v] == found);
      found = distances[v];
    }
    return found;
  }
};

}  // namespace

TEST_CASE("face distances: where parts meet vertices have the mean, and all else its own") {
  for (const bool shared : {true, false}) {
    const Strip strip(shared);
    CHECK(strip.at(-1) == 1);
    CHECK(strip.at(0) == 2);
    CHECK(strip.at(1) == 3);
  }
}

TEST_CASE("face distances: parts blend into each other over a length") {
  Strip strip;
  strip.faces.blend = 4;
  const auto beside = [](double own, double other, double share) {
    const double s = 1 - share, weight = s * s * s * (10 - 15 * s + 6 * s * s);
    return (own + weight * other) / (1 + weight);
  };
  CHECK(strip.at(0) == 2);
  for (const int x : {1, 2, 3}) {
    CHECK(strip.at(-x) == Approx(beside(1, 3, x / 4.0)).epsilon(1e-14));
    CHECK(strip.at(x) == Approx(beside(3, 1, x / 4.0)).epsilon(1e-14));
  }
  CHECK(strip.at(-4) == 1);
  CHECK(strip.at(4) == 3);
}

TEST_CASE("face distances: what is beyond a sharp edge is not blended") {
  Strip strip;
  strip.faces.blend = 4;
  strip.faces.piece = strip.faces.part;
  CHECK(strip.at(-1) == 1);
  CHECK(strip.at(0) == 2);
  CHECK(strip.at(1) == 3);
}

TEST_CASE("face distances: the distance of the closest point of an edge counts beyond it") {
  Strip strip;
  strip.faces.blend = 2;
  // Of the second part: 3 at y = 0, and 5 at y = 1.
  for (std::size_t c = 0; c < strip.mesh.corners.size(); ++c)
    if (strip.faces.part[c / 4] == 1 && strip.mesh.positions[strip.mesh.corners[c]].y() == 1)
      strip.faces.at_corner[c] = 5;
  const Distances distances = vertex_distances(strip.mesh.view(), strip.faces);
  for (std::size_t v = 0; v < strip.mesh.positions.size(); ++v) {
    const Vec3d& p = strip.mesh.positions[v];
    if (p.x() == 0) CHECK(distances[v] == (1 + (p.y() == 1 ? 5 : 3)) / 2.0);
    if (p.x() == -1) CHECK(distances[v] == Approx((1 + 0.5 * (p.y() == 1 ? 5 : 3)) / 1.5));
  }
}

TEST_CASE("face distances: what is the same everywhere is one, and what is missing is told") {
  Strip strip;
  strip.faces.at_corner.assign(strip.faces.at_corner.size(), 0.1);
  CHECK(vertex_distances(strip.mesh.view(), strip.faces).uniform());
  strip.faces.at_corner.pop_back();
  CHECK_THROWS_AS(vertex_distances(strip.mesh.view(), strip.faces), InvalidInput);
  strip.faces.at_corner.push_back(1);
  strip.faces.blend = -1;
  CHECK_THROWS_AS(vertex_distances(strip.mesh.view(), strip.faces), InvalidInput);
}
