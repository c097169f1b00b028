// SPDX-License-Identifier: Apache-2.0
// Level sets in and out of the command.
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "command/shell_command.h"

namespace {

openvdb::FloatGrid::Ptr grid_in(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
}

/// How far the grid's distances are from those to a sphere, at most.
double off_sphere(const openvdb::FloatGrid& grid, double radius) {
  double worst = 0;
  for (auto value = grid.cbeginValueOn(); value; ++value)
    worst = std::max(worst, std::abs(*value - (grid.indexToWorld(value.getCoord()).length() - radius)));
  return worst;
}

}  // namespace

TEST_CASE("command: an iso-surface is written as a level set, and is read again in all modes", "[command]") {
  const ShellCommand shell;
  const Run run = shell("sphere.obj a.vdb -d 0.2 --mode iso --voxel-size 0.05 --report r.json");
  REQUIRE(run.code == 0);
  const openvdb::FloatGrid::Ptr grid = grid_in(shell.file("a.vdb"));
  CHECK(grid->voxelSize()[0] == Approx(0.05));
  CHECK(grid->metaValue<std::string>("offset_distance") == "0.2");
  CHECK(off_sphere(*grid, 1.2) < 0.01);  // of the source's faces
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("r.json")));
  CHECK(report["level_set"]["active_voxels"] == grid->activeVoxelCount());
  CHECK_THAT(run.out, Catch::Contains("a.vdb: level set of " + std::to_string(grid->activeVoxelCount()) +
                                      " active voxels of 0.05"));
  // Voxels as those of the source.
  REQUIRE(shell("a.vdb b.vdb -d 0.1 --mode iso").code == 0);
  const openvdb::FloatGrid::Ptr larger = grid_in(shell.file("b.vdb"));
  CHECK(larger->voxelSize()[0] == Approx(0.05));
  CHECK(off_sphere(*larger, 1.3) < 0.015);
  CHECK(shell("b.vdb c.obj -d -0.1 --strict").code == 0);
  CHECK(shell("check b.vdb c.obj -d -0.1 --strict").code == 0);
  CHECK(shell("b.vdb d.obj -d 0.1 --isovalue 0.05 --grid surface --strict").code == 0);
}

TEST_CASE("command: where a level set has no place, one line says so", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj a.vdb -d 0.1", 1, "a.vdb: expected --mode iso");
  check_failure(shell, "sphere.obj a.vdb -d 0.1 --mode iso --shell", 1, "without --shell");
  check_failure(shell, "sphere.obj a.vdb.gz -d 0.1 --mode iso", 1, "a.vdb.gz: expected .vdb alone");
  check_failure(shell, "sphere.obj a.vdb -d 0.1 --mode iso --transport color", 1, "--transport: expected a mesh");
  check_failure(shell, "sphere.obj a.obj -d 0.1 --grid phi", 1, "that ends in .vdb");
  check_failure(shell, "sphere.obj a.obj -d 0.1 --isovalue 1", 1, "that ends in .vdb");
}
