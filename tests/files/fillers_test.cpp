// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/filler.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "products/volume/cell_quality.h"
#include "products/volume/foam_measures.h"
#include "products/volume/volume_faces.h"
#include "support/oracles.h"
#include "support/places.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

bool has_tetgen() { return std::system("command -v tetgen >/dev/null 2>&1") == 0; }
bool has_gmsh() { return std::system("command -v gmsh >/dev/null 2>&1") == 0; }

/// Those that are installed.
std::vector<FillWith> fillers() {
  std::vector<FillWith> all{FillWith::Netgen};
  if (has_tetgen()) all.push_back(FillWith::TetGen);
  if (has_gmsh()) all.push_back(FillWith::Gmsh);
  return all;
}

/// Both, the other one shifted.
Polygons both(Polygons one, const Polygons& other, const Vec3d& shift) {
  const auto first = static_cast<std::uint32_t>(one.positions.size());
  for (const Vec3d& x : other.positions) one.positions.push_back(x + shift);
  const auto corners = static_cast<std::uint32_t>(one.corners.size());
  for (const std::uint32_t v : other.corners) one.corners.push_back(first + v);
  for (std::size_t f = 1; f < other.face_begin.size(); ++f) one.face_begin.push_back(corners + other.face_begin[f]);
  return one;
}

VolumeMesh fill(const Polygons& wall, double thickness, const Filler& filler, FillReport* report = nullptr) {
  const LayersResult layers = grow_layers(wall.view(), std::vector<Distances>{thickness / 2, thickness}, {});
  LayerCellFacts facts;
  VolumeMesh cells = make_cells(wall.view(), layers, {}, &facts);
  FillOptions options;
  options.farfield.size = 3;
  return fill_volume(wall.view(), layers, facts, {}, std::move(cells), options, filler, report);
}

}  // namespace

TEST_CASE("Netgen, TetGen and gmsh fill around a body, and inside of one", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  const FillWith with = GENERATE(from_range(fillers()));
  const Filler filler = io::make_filler(with, {});
  const bool is_outside = GENERATE(true, false);
  FillReport report;
  const VolumeMesh mesh = fill(shapes::icosphere(1, 2), is_outside ? 0.1 : -0.1, filler, &report);
  CHECK_NOTHROW(VolumeFaces(mesh));
  CHECK(report.tetrahedra > (is_outside ? 1000 : 100));
  CHECK(report.scaled_jacobian.least > (with == FillWith::Netgen ? 0.1 : 0.02));
  CHECK(report.jump.least >= 1);
}

TEST_CASE("domains of several shells are filled: around bodies, inside of them, and around their holes", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  const Filler filler = io::make_filler(GENERATE(from_range(fillers())), {});
  Polygons hole = shapes::icosphere(0.5, 1);
  std::reverse(hole.corners.begin(), hole.corners.end());  // faces of three corners, each of which is turned
  const Polygons hollow = both(shapes::icosphere(1, 2), hole, Vec3d(0.0));
  const Polygons walls = both(both(hole, shapes::icosphere(1, 2), Vec3d(0.0)), hollow, {3, 0, 0});
  CHECK(enclosed_volume(fill(walls, -0.1, filler)) == Approx(test::enclosed_volume(walls)));
  FillReport report;
  fill(both(shapes::icosphere(1, 2), shapes::icosphere(1, 2), {3, 0, 0}), 0.1, filler, &report);
  CHECK(report.tetrahedra > 2000);
}

TEST_CASE("bent faces are parted so that they leave no valley for flat tetrahedra", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  // Across, it is an ellipse that turns along the tube.
  constexpr std::uint32_t kAround = 16, kAlong = 20;
  Polygons tube;
  for (std::uint32_t i = 0; i <= kAlong; ++i)
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const double x = 0.15 * i, angle = 2 * M_PI * j / kAround, radius = 1 + 0.2 * std::sin(2 * angle + 2 * x);
      tube.positions.emplace_back(x, radius * std::cos(angle), radius * std::sin(angle));
      if (i == kAlong) continue;
      const std::uint32_t a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      tube.corners.insert(tube.corners.end(), {a, b, b + kAround, a + kAround});
      tube.face_begin.push_back(static_cast<std::uint32_t>(tube.corners.size()));
    }
  FillReport report;
  fill(tube, -0.1, io::make_filler(FillWith::Netgen, {}), &report);
  CHECK(report.scaled_jacobian.least > 0.05);  // 0.03 with valleys
}

TEST_CASE("bent faces are parted so that no cell is dented beyond its middle", "[no_races]") {
  if (!has_tetgen()) return;
  const VolumeMesh mesh = fill(shapes::naca_wing("2412", 1, 1, 20, 4), 0.0047, io::make_filler(FillWith::TetGen, {}));
  CHECK(std::ranges::count(mesh.cell_types, CellType::Polyhedron) > 100);
  CHECK(measure_foam(mesh, VolumeFaces(mesh)).wrong_faces == 0);
}

TEST_CASE("two halves on one plane are filled around, and the plane is one of symmetry throughout", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  const Polygons one = shapes::hemisphere(1, 12, 3), halves = both(one, one, {4, 0, 0});
  const VolumeMesh mesh = fill(halves, 0.1, io::make_filler(FillWith::Netgen, {}));
  CHECK_NOTHROW(VolumeFaces(mesh));
  using Kind = BoundaryPatch::Kind;
  CHECK(std::ranges::count(mesh.patches, Kind::Symmetry, &BoundaryPatch::kind) == 2);
  CHECK(std::ranges::count(mesh.patches, Kind::Side, &BoundaryPatch::kind) == 0);
  for (const BoundaryPatch& patch : mesh.patches)
    CHECK(std::ranges::count(mesh.patches, patch.name, &BoundaryPatch::name) == 1);
}

TEST_CASE("a border that is none ends in an error, or in a mesh of what was meant", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  using Spoil = std::function<void(FillDomain&)>;
  const Spoil spoil = GENERATE(values<Spoil>({
      [](FillDomain& domain) { std::swap(domain.triangles[5][0], domain.triangles[5][1]); },
      [](FillDomain& domain) { domain.triangles.erase(domain.triangles.begin() + 9); },
      [](FillDomain& domain) { domain.triangles.push_back(domain.triangles[3]); },
      [](FillDomain& domain) { domain.points[domain.triangles[7][0]] *= -1; },
      [](FillDomain& domain) {
        for (auto& t : domain.triangles) std::swap(t[0], t[1]);
      },
      [](FillDomain& domain) { domain.triangles.clear(); },
  }));
  const Filler filler = io::make_filler(GENERATE(from_range(fillers())), {.seconds = 10});
  const Filler spoilt = [&](FillDomain domain) {
    spoil(domain);
    return filler(domain);
  };
  // TetGen and gmsh do not ask how triangles run, and all may take double ones for one.
  try {
    const VolumeMesh mesh = fill(shapes::icosphere(1, 2), -0.1, spoilt);
    CHECK_NOTHROW(VolumeFaces(mesh));
    CHECK(enclosed_volume(mesh) == Approx(enclosed_volume(fill(shapes::icosphere(1, 2), -0.1, filler))));
  } catch (const FillFailed& failed) {
    CHECK_THAT(failed.what(), Catch::StartsWith("fill: expected"));
  }
}

TEST_CASE("a filler keeps to its time, ends when asked, and is missed where it is not there", "[no_races]") {
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
  // Netgen takes 20 s for each: its program is ended, or these would wait for it.
  const Polygons wall = shapes::icosphere(1, 5);
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(fill(wall, 0.1, io::make_filler(FillWith::Netgen, {.seconds = 0.5})), FillFailed);
  io::FillerLimits cancelled;
  cancelled.progress = [](Stage, double) { return false; };
  CHECK_THROWS_AS(fill(wall, 0.1, io::make_filler(FillWith::Netgen, cancelled)), Cancelled);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30));
  ::setenv("VDB_OFFSET_MODULES", "/nowhere", 1);
  CHECK_THROWS_AS(fill(wall, 0.1, io::make_filler(FillWith::Netgen, {})), ReadError);
  ::setenv("VDB_OFFSET_MODULES", test::modules_path().c_str(), 1);
}

TEST_CASE("a border of more triangles than memory can be had for is refused before it is filled", "[no_races]") {
  const FillWith with = GENERATE(FillWith::Netgen, FillWith::TetGen, FillWith::Gmsh);
  FillDomain domain;
  domain.triangles.resize(1000);  // nothing that a filler could fill
  CHECK_THROWS_AS(io::make_filler(with, {.most_memory = 1'000'000})(domain), OutOfBudget);
}
