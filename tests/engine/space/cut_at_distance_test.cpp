// SPDX-License-Identifier: Apache-2.0
#include "space/query/cut_at_distance.h"

#include <catch2/catch.hpp>
#include <random>

#include "support/oracles.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

struct Cuts {
  std::size_t tried = 0;
  double worst = 0;      // distance by brute force, relative
  double worst_off = 0;  // off the way, or beyond one of its ends, relative to its length
};

/// Cuts random ways out from near a mesh to beyond a distance, where they come to be at it.
Cuts cut_ways(const Polygons& mesh, double distance) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.05);
  const ClosestQuery query(surface);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> signed_unit(-1, 1);
  const auto somewhere = [&] { return Vec3d(signed_unit(random), signed_unit(random), signed_unit(random)); };
  Cuts cuts;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3d foot = (surface.vertices[a] + surface.vertices[b] * 0.9 + surface.vertices[c] * 0.2) / 2.1,
                from = foot + surface.triangle_normals[t] * (0.3 * distance),
                to = foot + surface.triangle_normals[t] * (2 * distance) + somewhere() * distance;
    const auto measure = [&](const Vec3d& x) { return sample_at(x, query(x, t)); };
    const Sample near = measure(from), far = measure(to);
    if (!(near.phi < distance && far.phi > distance)) continue;
    const Sample at = cut_at_distance(surface, near, far, distance, measure,
                                      [&](const Sample& s) { return std::abs(s.phi - distance) <= 1e-9 * distance; });
    const double exact = test::brute_force_distance(mesh.view(), at.x + surface.origin);
    cuts.worst = std::max(cuts.worst, std::abs(exact - distance) / distance);
    const Vec3d way = to - from, gone = at.x - from;
    const double along = gone.dot(way) / way.lengthSqr();
    cuts.worst_off = std::max({cuts.worst_off, (gone - way * along).length() / way.length(), -along, along - 1});
    ++cuts.tried;
  }
  return cuts;
}

}  // namespace

TEST_CASE("cut: over corners, edges and faces the point at a distance is found, and lies on the way", "[cut]") {
  for (const double distance : {0.01, 0.1, 0.5}) {
    const Cuts cuts = cut_ways(shapes::bumpy_sphere(1, 0.5, 2.5, 3, 4), distance);
    CAPTURE(distance, cuts.tried);
    CHECK(cuts.tried > 500);
    CHECK(cuts.worst < 1e-8);
    CHECK(cuts.worst_off < 1e-12);
  }
}
