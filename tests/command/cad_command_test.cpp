// SPDX-License-Identifier: Apache-2.0
// What the command tells of CAD models.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "cad/cad_files.h"
#include "command/shell_command.h"
#include "support/places.h"

using namespace vdb_offset;

TEST_CASE("command: of a CAD model that is written, no faces of a mesh are told", "[command][cad]") {
  const ShellCommand shell;
  const std::string bracket = test::scenes_path() + "/bracket.step ";
  const auto told = [&](const std::string& words) {
    const Run run = shell(bracket + words);
    CHECK(run.code == 0);
    return run.out;
  };
  const std::string model = told("out.step -d 1mm");
  CHECK_THAT(model, Catch::StartsWith("out.step: a valid solid: 13 faces") && Catch::Contains("; as a mesh, "));
  CHECK_THAT(model, !Catch::Contains("% off") && !Catch::Contains("error is"));
  CHECK_THAT(told("out.obj -d 1mm --corners round"), !Catch::Contains("as a mesh") && Catch::Contains(" % off)") &&
                                                         Catch::Contains("the faces' error is at sharp corners"));
  // Round corners leave no vertex of this model on a single face's offset.
  CHECK_THAT(told("out.step -d 1mm -v --corners round"), !Catch::Contains("from the faces of the CAD model"));
  CHECK_THAT(told("out.step -d 1mm -v"), Catch::Contains("\nnote: measured from the faces of the CAD model, "));
}

TEST_CASE("command: beside what stays, a CAD model's vertices are measured from what moves", "[command][cad]") {
  const ShellCommand shell;
  // The bottom, which ends in a fillet, and an end: the rim goes up the fillet, and has corners in which both move.
  const Run run = shell(test::scenes_path() +
                        "/bracket.step higher.obj -d -0.2 --only face=7 --only face=8 -v --report higher.json");
  CHECK(run.code == 0);
  CHECK_THAT(run.out, Catch::Contains("from the faces of the CAD model, "));
  const auto facts = nlohmann::json::parse(shell.slurp(shell.file("higher.json")))["cad_faces"];
  CHECK(facts["worst_error"].get<double>() < 1e-9);
}

TEST_CASE("command: in CAD models out, bodies that touch hold each other back nowhere", "[command][cad]") {
  REQUIRE(test::cad_files().is_made());
  const ShellCommand shell;
  // A face goes farther than a fillet beside it, which takes triangles: in both of two blocks as in one alone.
  const auto volume = [&](const std::string& arguments) {
    const Run run = shell(test::cad_files().folder().string() + "/" + arguments + " -d 0.5 --report o.json");
    CHECK(run.code == 0);
    const auto report = nlohmann::json::parse(shell.slurp(shell.file("o.json")));
    CHECK(report["cad_file"]["triangles"].get<int>() > 0);
    return report["cad_file"]["volume"].get<double>();
  };
  const double one = volume("block.step one.step --distance-of face=1:1.2");
  CHECK(one > 41 * 31 * 20);
  CHECK(volume("twin_blocks.step two.step --distance-of face=1:1.2 --distance-of face=9:1.2") ==
        Approx(2 * one).epsilon(1e-6));
}
