// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "command/shell_command.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

TEST_CASE("--layers with two lengths says how they grow, and two lengths alone how many there are",
          "[command][layers]") {
  ShellCommand shell;
  const auto layers_of = [&](const std::string& options) {
    const Run made = shell("sphere.obj out.vtu " + options + " --report r.json");
    INFO(options << made.err);
    CHECK(made.code == 0);
    return nlohmann::json::parse(std::ifstream(shell.file("r.json")))["layers"];
  };
  const auto ten = layers_of("--layers 10 --first-height 0.01 --total-thickness 0.2");
  CHECK(ten["count"] == 10);
  CHECK(ten["growth"]["least"] == Approx(1.1469).epsilon(1e-3));
  CHECK(ten["thickness_asked"]["mean"] == Approx(0.2));
  CHECK(layers_of("--first-height 0.01 --total-thickness 0.2")["count"] == 9);
  CHECK(layers_of("--first-height 0.01 --total-thickness 0.2 --growth 1.5")["count"] == 6);
  // The sphere's edges are 0.14 long on average, and 0.12 to 0.16.
  const auto isotropic = layers_of("--first-height 0.01 --last-height edge --growth 1.5");
  CHECK(isotropic["count"] == 8);
  CHECK(isotropic["growth"]["largest"] > isotropic["growth"]["least"]);
  // y+ of 1 at 1e6 over a length of 2.
  const auto viscous = layers_of("--layers 2 --growth 1 --y-plus 1 --reynolds 1e6");
  CHECK(viscous["thickness_asked"]["mean"] == Approx(4 * 2.31079e-5));
  CHECK(layers_of("--layers 2 --growth 1 --y-plus 1 --speed 10 --viscosity 1.8e-5 --density 0.9 --length 2") ==
        viscous);
  // What a preset says of the number or the growth gives way to two lengths.
  CHECK(layers_of("--preset layers --first-height 0.01 --total-thickness 0.2")["count"] == 10);
  CHECK(layers_of("--preset layers --first-height 0.01 --total-thickness 0.2 --growth 1.5")["count"] == 6);
}

TEST_CASE("--layers says in one line which of its lengths do not go together", "[command][layers]") {
  ShellCommand shell;
  const auto refused = [&](const std::string& options, const char* why, int code = 1) {
    const Run run = shell("sphere.obj out.vtu " + options);
    INFO(options << run.err);
    CHECK(run.code == code);
    CHECK_THAT(run.err, Catch::Contains(why));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(shell.has("out.vtu"));
  };
  refused("--layers 3 --growth 1.2 --first-height 0.01 --total-thickness 0.1", "expected three of --layers, --growth");
  refused("--first-height 0.01 --last-height 0.02 --total-thickness 0.1", "expected three of --layers, --growth");
  refused("--last-height 0.02 --total-thickness 0.1", "--total-thickness with --last-height needs --layers");
  refused("--layers 3", "--layers needs --first-height or");
  refused("--first-height 0.1", "--first-height needs --layers");
  refused("--layers 3 --y-plus 1", "--y-plus needs one of --viscosity, --reynolds");
  refused("--layers 3 --y-plus 1 --viscosity 1 --reynolds 10", "--y-plus needs only one of --viscosity, --reynolds");
  refused("--layers 3 --y-plus 0 --reynolds 10", "--y-plus: expected a finite number other than 0, got '0'");
  refused("--layers 3 --y-plus 1 --first-height 1 --reynolds 10", "exclude each other");
  refused("--layers 3 --first-height 0.1 --speed 3", "--speed needs --case or --y-plus");
  refused("--layers 3 --first-height 0.1 --blend 3", "--blend: expected --layers-of");
  refused("--layers 3 --first-height 0.1 --total-thickness=-0.4", "expected lengths of one sign", 2);
  refused("--layers 3 --first-height 0.1 --layers-of nose:0.4", "--layers-of");
}

TEST_CASE("--layers-of gives a part heights of its own", "[command][layers]") {
  ShellCommand shell;
  std::ofstream(shell.file("plate.obj")) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\n"
                                            "g left\nf 1 2 5 4\ng middle\nf 2 3 6 5\ng right\nf 3 7 8 6\n";
  const Run made = shell("plate.obj out.obj --layers 2 --growth 1 --first-height 0.1 --layers-of group=right:0.3");
  CHECK(made.code == 0);
  const auto outer = io::read_mesh(shell.file("out_002.obj")).polygons.positions;
  const double expected[] = {0.2, 0.2, 0.4, 0.2, 0.2, 0.4, 0.6, 0.6};
  for (std::size_t v = 0; v < 8; ++v) CHECK(outer[v][2] == Approx(expected[v]).epsilon(1e-4));
}

TEST_CASE("--layers opens sharp edges of CAD models into fans as well", "[command][layers][cad]") {
  ShellCommand shell;
  const Run made = shell(scenes_path() + "/bracket.step out.vtu --layers 2 --first-height 0.02 --report r.json");
  INFO(made.err);
  CHECK(made.code == 0);
  const auto report = nlohmann::json::parse(std::ifstream(shell.file("r.json")));
  CHECK(report["layers"]["fan_cells"] > 0);
  CHECK(report["layers"]["coverage"] > 0.99);
}
