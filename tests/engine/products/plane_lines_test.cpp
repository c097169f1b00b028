// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "support/fills.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A part of a pipe along x, seen from inside, of radius 1: its first edge is in the plane z = 0.
Polygons part_of_pipe(int segments, double angle, int stacks, double length) {
  Polygons mesh;
  const auto n = static_cast<std::uint32_t>(segments) + 1;
  for (int j = 0; j <= stacks; ++j)
    for (int i = 0; i <= segments; ++i) {
      const double at = angle * i / segments;
      const bool is_up = i == segments && angle == std::numbers::pi / 2,
                 is_back = i == segments && angle == std::numbers::pi;
      mesh.positions.emplace_back(length * j / stacks, is_up ? 0 : std::cos(at), is_back ? 0 : std::sin(at));
    }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(stacks); ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i;
      mesh.add_face({a, a + n, a + n + 1, a + 1});
    }
  return mesh;
}

/// The part of a mesh's faces of which all corners have coordinates of 0 or more along the first so many axes.
Polygons part_at(const Polygons& mesh, int axes) {
  Polygons part;
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    bool is_in = true;
    for (const auto v : face)
      for (int k = 0; k < axes; ++k) is_in = is_in && mesh.positions[v][k] > -1e-12;
    if (!is_in) continue;
    std::vector<std::uint32_t> corners;
    for (const auto v : face) {
      const auto [found, is_new] = number.try_emplace(v, static_cast<std::uint32_t>(part.positions.size()));
      if (is_new) part.positions.push_back(mesh.positions[v]);
      corners.push_back(found->second);
    }
    part.add_face({corners[0], corners[1], corners[2]});
  }
  for (Vec3d& x : part.positions)
    for (int k = 0; k < 3; ++k)
      if (std::abs(x[k]) < 1e-12) x[k] = 0;
  return part;
}

/// A sphere of radius 1 whose faces end at the planes of coordinates.
Polygons octahedral_sphere(int levels) {
  Polygons sphere;
  sphere.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u})
        if ((x + y + z) % 2 == 0) sphere.add_face({x, y, z});
        else sphere.add_face({x, z, y});
  for (int level = 0; level < levels; ++level) {
    Polygons finer{sphere.positions, {}, {0}};
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(finer.positions.size()));
      if (is_new) finer.positions.push_back((sphere.positions[a] + sphere.positions[b]).unit());
      return found->second;
    };
    for (std::size_t f = 0; f < sphere.face_count(); ++f) {
      const auto face = sphere.view().face(f);
      const std::uint32_t ab = middle(face[0], face[1]), bc = middle(face[1], face[2]), ca = middle(face[2], face[0]);
      finer.add_face({face[0], ab, ca});
      finer.add_face({ab, face[1], bc});
      finer.add_face({ca, bc, face[2]});
      finer.add_face({ab, bc, ca});
    }
    sphere = std::move(finer);
  }
  return sphere;
}

/// Requires a patch in a plane across an axis, of an area.
void require_in_plane(const VolumeMesh& mesh, const BoundaryPatch& patch, double area) {
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    bool all = true;
    for (const auto p : patch.corners) all = all && mesh.points[p][k] == mesh.points[patch.corners[0]][k];
    if (all) axis = k;
  }
  REQUIRE(axis >= 0);
  Vec3d above = mesh.points[patch.corners[0]];
  above[axis] -= 1;
  double covered = 0;
  for (std::size_t f = 0; f < patch.face_count(); ++f)
    covered += std::abs(six_volumes_below(mesh.points, patch.face(f), above)) / 2;
  CHECK(covered == Approx(area).epsilon(1e-9));
}

}  // namespace

TEST_CASE(
    "plane lines: half a pipe is closed by its ends and the plane through its axis, a quarter by two such planes") {
  const bool is_half = GENERATE(true, false);
  const double angle = std::numbers::pi / (is_half ? 1 : 2);
  const int segments = is_half ? 16 : 8;
  const Polygons wall = part_of_pipe(segments, angle, 12, 3);
  const double section = segments * std::sin(std::numbers::pi / 16) / 2;
  for (const double thickness : {0.05, 0.3}) {
    const Filled made = fill(wall, thickness, fill_from_middle);
    require_mesh(made.mesh, 3 * section);
    // In units in which areas are tiny.
    Polygons small = wall;
    for (Vec3d& x : small.positions) x *= 1e-3;
    const Filled made_small = fill(small, 1e-3 * thickness, fill_from_middle);
    CHECK(made_small.mesh.patches.size() == made.mesh.patches.size());
    CHECK(enclosed_volume(made_small.mesh) == Approx(3e-9 * section).epsilon(1e-9));
    // The wall, its two ends, and the planes along it.
    REQUIRE(made.mesh.patches.size() == (is_half ? 4 : 5));
    std::multiset<double> areas;
    for (const BoundaryPatch& patch : made.mesh.patches) {
      if (patch.kind != BoundaryPatch::Kind::Side) continue;
      const double x = made.mesh.points[patch.corners[0]][0];
      bool is_end = x == 0 || x == 3;
      for (const auto p : patch.corners) is_end = is_end && made.mesh.points[p][0] == x;
      require_in_plane(made.mesh, patch, is_end ? section : 3 * (is_half ? 2 : 1));
      areas.insert(is_end ? 0 : 1);
    }
    CHECK(areas.count(0) == 2);
    CHECK(areas.count(1) == (is_half ? 1 : 2));
  }
}

TEST_CASE("plane lines: a quarter or an eighth of a body has a farfield that ends at its planes") {
  const int planes = GENERATE(2, 3);
  const bool is_box = GENERATE(true, false);
  std::vector<FillDomain> seen;
  const Filler look = [&](const FillDomain& domain) -> FilledDomain {
    seen.push_back(domain);
    throw FillFailed("enough");
  };
  FillOptions options;
  options.farfield.size = 5;
  options.farfield.in_lengths = false;
  options.farfield.shape = is_box ? Farfield::Shape::Box : Farfield::Shape::Sphere;
  CHECK_THROWS_AS(fill(part_at(octahedral_sphere(3), planes), 0.1, look, options), FillFailed);
  REQUIRE(seen.size() == 1);
  double six_volumes = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  Vec3d lowest(1e9), highest(-1e9);
  for (const auto& t : seen[0].triangles) {
    for (std::size_t k = 0; k < 3; ++k) REQUIRE(sides.insert({t[k], t[(k + 1) % 3]}).second);
    six_volumes += seen[0].points[t[0]].dot(seen[0].points[t[1]].cross(seen[0].points[t[2]]));
  }
  for (const auto& [a, b] : sides) REQUIRE(sides.contains({b, a}));
  for (const Vec3d& x : seen[0].points) {
    lowest = openvdb::math::minComponent(lowest, x);
    highest = openvdb::math::maxComponent(highest, x);
  }
  const double share = planes == 2 ? 0.25 : 0.125, body = 4.0 / 3 * std::numbers::pi * 1.331 * share;
  const double reach = 6.1, whole = is_box ? 8 * std::pow(reach, 3) * share : 4.0 / 3 * std::numbers::pi * 125 * share;
  CHECK(six_volumes / 6 == Approx(whole - body).epsilon(is_box ? 1e-3 : 0.08));
  for (int k = 0; k < planes; ++k) CHECK(highest[k] - lowest[k] == Approx(is_box ? reach : 5));
}

TEST_CASE("plane lines: planes that follow from the faces beside a straight border alone are reported") {
  Polygons wall = part_of_pipe(16, std::numbers::pi, 12, 3);
  CHECK(fill(wall, 0.1, fill_from_middle).report.guessed_planes.empty());
  for (Vec3d& x : wall.positions) x = {x[0], 0.8 * x[1] - 0.6 * x[2], 0.6 * x[1] + 0.8 * x[2]};
  const Filled made = fill(wall, 0.1, fill_from_middle);
  REQUIRE(made.report.guessed_planes.size() == 2);
  for (const SymmetryPlane& plane : made.report.guessed_planes)
    CHECK(std::abs(plane.normal.dot(Vec3d(0, -0.6, 0.8))) == Approx(std::cos(std::numbers::pi / 32)).epsilon(1e-6));
}

TEST_CASE("plane lines: a border that is not made of planes stays one opening, and is not covered") {
  // A tube with slanting, wavy ends.
  Polygons wall;
  constexpr std::uint32_t kSegments = 24, kStacks = 6;
  for (std::uint32_t j = 0; j <= kStacks; ++j)
    for (std::uint32_t i = 0; i < kSegments; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSegments;
      wall.positions.emplace_back(0.5 * j + (j == kStacks ? 0.3 * std::cos(3 * angle) : 0), std::cos(angle),
                                  std::sin(angle));
    }
  for (std::uint32_t j = 0; j < kStacks; ++j)
    for (std::uint32_t i = 0; i < kSegments; ++i) {
      const std::uint32_t a = j * kSegments + i, b = j * kSegments + (i + 1) % kSegments;
      wall.add_face({a, a + kSegments, b + kSegments, b});
    }
  CHECK_THROWS_WITH(fill(wall, 0.05, fill_from_middle), Catch::Contains("expected flat openings"));
}
