// SPDX-License-Identifier: Apache-2.0
// Clearances between the parts of a 3MF package.
#include <catch2/catch.hpp>
#include <fstream>

#include "command/shell_command.h"
#include "support/threemf_packages.h"

TEST_CASE("3mf: parts that touch give way to each other", "[3mf][command]") {
  const ShellCommand shell;
  // Two of the tetrahedra, joined at the face that looks along -z: one is mirrored.
  const std::string bytes =
      package_of(model_of("<object id=\"1\" name=\"up\">" + kTetrahedronXml +
                              "</object><object id=\"2\" name=\"down\">" + kTetrahedronXml + "</object>",
                          "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 -1 0 0 0\"/>"));
  std::ofstream(shell.file("two.3mf"), std::ios::binary) << bytes;
  CHECK(shell("two.3mf same.3mf --distance 0").code == 0);
  CHECK(shell.slurp(shell.file("same.3mf")) == bytes);
  const Run run = shell("two.3mf loose.3mf --distance -0.1 --strict");
  CHECK(run.code == 0);
  CHECK_THAT(run.out,
             Catch::Contains("is within 1 % of -0.1 (on average 0 % off); 100.000 % of 8 vertices reached it"));
  const vdb_offset::io::MeshFile loose = vdb_offset::io::read_mesh(shell.file("loose.3mf"));
  for (std::size_t v = 0; v < 3; ++v) {
    CHECK(loose.polygons.positions[v][2] == Approx(0.1).epsilon(1e-9));
    CHECK(loose.polygons.positions[4 + v][2] == Approx(-0.1).epsilon(1e-9));
  }
  CHECK(shell("check two.3mf loose.3mf --distance -0.1 --strict").code == 0);

  CHECK(shell("two.3mf one.3mf --distance -0.2 --only group=down --strict").code == 0);
  const vdb_offset::io::MeshFile one = vdb_offset::io::read_mesh(shell.file("one.3mf"));
  CHECK(one.polygons.positions[0] == vdb_offset::Vec3d(0, 0, 0));
  CHECK(one.polygons.positions[4][2] == Approx(-0.2).epsilon(1e-9));
  check_failure(shell, "two.3mf a.3mf --distance 1 --only group=left", 1,
                "expected a group among down, up, got 'left'");
}
