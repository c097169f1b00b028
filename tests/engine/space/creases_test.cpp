// SPDX-License-Identifier: Apache-2.0
#include "space/surface/creases.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "space/surface/surface.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

/// Which of a mesh's vertices are on creases.
std::vector<std::uint8_t> on_creases(const Polygons& mesh) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.1);
  const std::vector<std::uint8_t> found = vertices_on_creases(surface);
  std::vector<std::uint8_t> of_mesh;
  for (const auto v : surface.welded) of_mesh.push_back(found[v]);
  return of_mesh;
}

std::size_t count_creased(const Polygons& mesh) {
  const auto found = on_creases(mesh);
  return static_cast<std::size_t>(std::count(found.begin(), found.end(), 1));
}

}  // namespace

TEST_CASE("creases: the edges of a box, with many faces or few", "[creases]") {
  for (const int divisions : {1, 4}) {
    const Polygons box = shapes::box(Vec3d(1, 2, 3), divisions, divisions > 1);
    const auto found = on_creases(box);
    for (std::size_t v = 0; v < found.size(); ++v) {
      const Vec3d& p = box.positions[v];
      const int sides = (std::abs(p[0]) > 0.499) + (std::abs(p[1]) > 0.999) + (std::abs(p[2]) > 1.499);
      CHECK(found[v] == (sides >= 2));
    }
  }
}

TEST_CASE("creases: the rims of a cylinder, and not its coarse flank", "[creases]") {
  const Polygons cylinder = shapes::cylinder(1, 2, 24, 4, 3);
  const auto found = on_creases(cylinder);
  for (std::size_t v = 0; v < found.size(); ++v) {
    const Vec3d& p = cylinder.positions[v];
    const bool at_rim = std::abs(p[2]) > 0.999 && std::hypot(p[0], p[1]) > 0.999;
    CHECK(found[v] == at_rim);
  }
}

TEST_CASE("creases: none on what is smooth or rough all over", "[creases]") {
  CHECK(count_creased(shapes::icosphere(1, 3)) == 0);
  CHECK(count_creased(shapes::torus(1, 0.3, 40, 20)) == 0);
  CHECK(count_creased(shapes::bumpy_sphere(1, 0.1, 4, 3, 4)) == 0);
}

TEST_CASE("creases: a few sharp edges that end in the surface are none", "[creases]") {
  // A sphere of which a sector of a few faces is pulled out: a smooth bump but for the short ridge on it.
  Polygons sphere = shapes::icosphere(1, 4);
  for (Vec3d& p : sphere.positions)
    if (p[2] > 0.5) p *= 1 + 0.3 * std::max(0.0, 1 - 6 * std::abs(p[0])) * std::max(0.0, 1 - 9 * p[1] * p[1]);
  CHECK(count_creased(sphere) < 12);
}

TEST_CASE("creases: a fold of an open patch runs from border to border", "[creases]") {
  Polygons patch = shapes::patch(1, 0, 4);
  std::size_t on_fold = 0;
  for (Vec3d& p : patch.positions) {
    on_fold += p[0] == 0;
    p[2] = std::abs(p[0]);
  }
  CHECK(on_fold == 5);
  CHECK(count_creased(patch) == on_fold);
}

TEST_CASE("creases: the tip of a cone of any number of sides, and no vertex of what bends finely both ways",
          "[creases]") {
  for (const std::uint32_t sides : {12u, 40u, 200u}) {
    Polygons cone;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      cone.positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    cone.positions.emplace_back(0, 0, 1);
    for (std::uint32_t i = 0; i < sides; ++i) cone.add_face({i, (i + 1) % sides, sides});
    CHECK(on_creases(cone).back() == 1);
    cone.positions.back()[2] = 0.2;  // bends by 22.6 degrees from side to side
    CHECK(on_creases(cone).back() == 0);
  }
  // By 18 degrees along each of its two directions; its quads are flat, so that four planes meet at each vertex.
  CHECK(count_creased(shapes::torus(1, 0.3, 20, 20)) == 0);
}
