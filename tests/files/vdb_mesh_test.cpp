// SPDX-License-Identifier: Apache-2.0
// Meshes of OpenVDB's grids, and level sets of meshes.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <new>
#include <random>
#include <sstream>

#include "document/trial.h"
#include "space/surface/surface.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "vdb_offset/field.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

std::string vdb_bytes(const openvdb::GridPtrVec& grids) {
  openvdb::initialize();
  std::ostringstream text;
  openvdb::io::Stream(text).write(grids);
  return text.str();
}

openvdb::FloatGrid::Ptr vdb_sphere(double radius, double voxel, const std::string& name,
                                   const Vec3d& centre = Vec3d(0.0)) {
  openvdb::initialize();
  const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(radius), openvdb::Vec3f(centre), static_cast<float>(voxel));
  grid->setName(name);
  return grid;
}

io::MeshFile vdb_mesh(const std::string& bytes) { return io::parse_mesh("a.vdb", io::Format::Vdb, bytes); }

/// Reads a file's mesh with options.
io::MeshFile vdb_mesh_as(const std::string& bytes, const io::VdbReading& how) {
  const Folder folder;
  const std::string path = folder.file("a.vdb");
  write_file(path, bytes);
  return io::read_mesh(path, {.format = {}, .cad = {}, .vdb = how});
}

}  // namespace

TEST_CASE("vdb: the zero surface of a level set is the mesh", "[io]") {
  const Vec3d centre(10, -3, 5);
  const double h = 0.05;
  const io::MeshFile file = vdb_mesh(vdb_bytes({vdb_sphere(1, h, "ball", centre)}));
  REQUIRE(file.polygons.positions.size() > 5000);
  // Interpolation is off by h^2 / 8 times the sum of both curvatures, and by the floats of the grid.
  for (const Vec3d& position : file.polygons.positions)
    CHECK(std::abs((position - centre).length() - 1) < h * h / 8 * 2 / (1 - h) + 1e-5);
  CHECK(test::enclosed_volume(file.polygons) == Approx(4.18879).epsilon(0.005));
  CHECK(build_surface(file.polygons.view(), {}).facts.closed());
  CHECK(file.voxel_size == Approx(h));
  CHECK(file.format == io::Format::Vdb);
}

TEST_CASE("vdb: faces point outward of whatever grid and transform", "[io]") {
  const openvdb::FloatGrid::Ptr grid = vdb_sphere(1, 0.1, "ball");
  const auto fog = grid->deepCopy();
  openvdb::tools::sdfToFogVolume(*fog);
  fog->setName("smoke");
  const std::string of_fog = vdb_bytes({fog});
  CHECK_THROWS_WITH(vdb_mesh(of_fog), Catch::Contains("expected a level set, got a fog volume 'smoke' (--isovalue V"));
  const io::MeshFile middle = vdb_mesh_as(of_fog, {.grid = {}, .isovalue = 0.5});
  // Fog is 0 at the surface, and 1 three voxels inside.
  CHECK(test::enclosed_volume(middle.polygons) == Approx(4.18879 * std::pow(1 - 0.15, 3)).epsilon(0.03));
  CHECK(test::enclosed_volume(vdb_mesh_as(vdb_bytes({grid}), {.grid = {}, .isovalue = 0.1}).polygons) ==
        Approx(4.18879 * std::pow(1.1, 3)).epsilon(0.02));
  grid->transform().postScale(Vec3d(-1, 2, 1));
  CHECK(test::enclosed_volume(vdb_mesh(vdb_bytes({grid})).polygons) == Approx(2 * 4.18879).epsilon(0.02));
}

TEST_CASE("vdb: the grid is the one that is named, or the only level set", "[io]") {
  const auto small = vdb_sphere(0.5, 0.1, "small"), large = vdb_sphere(1, 0.1, "large");
  const auto numbers = openvdb::Int32Grid::create(0);
  numbers->setName("numbers");
  CHECK(test::enclosed_volume(vdb_mesh(vdb_bytes({numbers, large})).polygons) > 4);
  const std::string both = vdb_bytes({small, large, numbers});
  CHECK_THROWS_WITH(vdb_mesh(both), Catch::Contains("expected a level set, got level set 'small', level set 'large'") &&
                                        Catch::Contains("(--grid NAME picks one)"));
  CHECK(test::enclosed_volume(vdb_mesh_as(both, {.grid = "large", .isovalue = {}}).polygons) > 4);
  CHECK_THROWS_WITH(vdb_mesh_as(both, {.grid = "huge", .isovalue = {}}),
                    Catch::Contains("'huge', got level set 'small'"));
  const auto same = vdb_sphere(1, 0.1, "small");
  const std::string twice = vdb_bytes({small, same});
  CHECK_THROWS_WITH(vdb_mesh(twice), Catch::Contains("got level set 'small[0]', level set 'small[1]'"));
  CHECK(test::enclosed_volume(vdb_mesh_as(twice, {.grid = "small[1]", .isovalue = {}}).polygons) > 4);
  CHECK_THROWS_WITH(vdb_mesh(vdb_bytes({numbers})),
                    Catch::Contains("expected a level set, got grid 'numbers' of int32s"));
  CHECK_THROWS_WITH(vdb_mesh(vdb_bytes({})), Catch::Contains("got none"));
}

TEST_CASE("vdb: grids without a surface, and with numbers that are none, are refused", "[io]") {
  const auto grid = vdb_sphere(1, 0.1, "ball");
  CHECK_THROWS_WITH(vdb_mesh_as(vdb_bytes({grid}), {.grid = {}, .isovalue = 7.0}),
                    Catch::Contains("expected a surface where the level set 'ball' is 7, got values from -0.29"));
  grid->tree().setValue(openvdb::Coord(10, 0, 0), std::nanf(""));
  CHECK_THROWS_WITH(vdb_mesh(vdb_bytes({grid})), Catch::Contains("expected finite numbers"));
  // A tile whose sides would be a hundred million faces.
  const auto huge = openvdb::FloatGrid::create(1);
  huge->setGridClass(openvdb::GRID_LEVEL_SET);
  huge->tree().addTile(3, openvdb::Coord(0), -1, true);
  const auto limit = [](std::size_t bytes) { set_memory_limit(bytes); };
  limit(std::size_t{2} << 30);
  CHECK_THROWS_AS(vdb_mesh(vdb_bytes({huge})), OutOfBudget);
  limit(0);
}

TEST_CASE("vdb: broken files are refused in one line, or read", "[io]") {
  const std::string bytes = vdb_bytes({vdb_sphere(0.5, 0.1, "ball")});
  std::mt19937 random(3);
  const auto read_or_refused = [](const std::string& some) {
    try {
      vdb_mesh(some);
    } catch (const InvalidInput& error) {
      CHECK_THAT(error.what(), !Catch::Contains("\n"));
    } catch (const OutOfBudget&) {
    }
  };
  for (std::size_t size = 1; size < bytes.size(); size += 1 + bytes.size() / 60) read_or_refused(bytes.substr(0, size));
  for (int i = 0; i < 100; ++i) {
    std::string other = bytes;
    for (int k = 0; k < 3; ++k) other[random() % (i % 2 ? 2000 : other.size())] ^= static_cast<char>(1 << random() % 8);
    read_or_refused(other);
  }
}

TEST_CASE("vdb: a reader that ends the process ends its trial", "[io]") {
  const auto tried = [](const std::function<void()>& work) {
    return io::try_in_child("a.vdb", std::size_t{1} << 30, work);
  };
  CHECK(tried([] {}));
  CHECK(!tried([] { throw InvalidInput("thrown"); }));
  CHECK_THROWS_WITH(tried([] { ::_exit(7); }), Catch::Contains("a.vdb: expected a file that its library can read") &&
                                                   Catch::Contains("ends it with code 7"));
  CHECK_THROWS_AS(tried([] { throw std::bad_alloc(); }), OutOfBudget);
}

TEST_CASE("vdb: a level set of a mesh is its distance", "[io]") {
  const double h = 0.04;
  const openvdb::FloatGrid::Ptr grid = make_level_set(shapes::icosphere(1, 6).view(), h);
  CHECK(grid->getName() == "surface");
  CHECK(grid->getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(grid->background() == Approx(3 * h));
  CHECK(grid->voxelSize() == Vec3d(h));
  CHECK(grid->tree().getValue(openvdb::Coord::round(grid->worldToIndex(Vec3d(0.0)))) == Approx(-3 * h));
  double worst = 0;
  for (auto value = grid->cbeginValueOn(); value; ++value)
    worst = std::max(worst, std::abs(*value - (grid->indexToWorld(value.getCoord()).length() - 1)));
  CHECK(worst < 2e-4);  // of the sphere's faces
  const Folder folder;
  save_grid(grid, folder.file("ball.vdb"), {{"made_of", "a ball"}});
  const io::MeshFile file = io::read_mesh(folder.file("ball.vdb"));
  for (const Vec3d& position : file.polygons.positions) CHECK(std::abs(position.length() - 1) < 7e-4);
  CHECK_THROWS_AS(make_level_set(shapes::icosphere(1, 2).view(), 1e-6), InvalidInput);
  CHECK_THROWS_AS(make_level_set(shapes::hemisphere(1, 16, 8).view(), 0.1), InvalidInput);
  CHECK_THROWS_AS(save_grid(grid, folder.file("no/ball.vdb")), WriteError);
}
