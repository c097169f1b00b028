// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "command/shell_command.h"
#include "vdb_offset/io/case_file.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

constexpr const char* kSquare = "0 0\n1 0\n1 1\n0 1\n0 0\n";

}  // namespace

TEST_CASE("--fill fills what layers leave, and --case writes what a solver needs besides", "[command]") {
  ShellCommand shell;
  std::ofstream(shell.file("square.dat")) << kSquare;
  const Run made = shell(
      "square.dat case/constant/polyMesh --layers 3 --first-height 0.02 --fill --farfield box:3L --report r.json "
      "--case openfoam:case --reynolds 100 --speed 2 --patch wall=body --patch farfield=far:farfield");
  CHECK(made.code == 0);
  CHECK_THAT(made.out, Catch::Contains("the rest filled with"));
  const std::string boundary = text_of(shell.file("case/constant/polyMesh/boundary"));
  for (const char* const name : {"body", "far", "front_and_back", "empty"}) CHECK_THAT(boundary, Catch::Contains(name));
  for (const char* const name : {"0/U", "0/p", "system/controlDict", "system/fvSchemes", "system/fvSolution", "README",
                                 "constant/turbulenceProperties"})
    CHECK(shell.has(std::string("case/") + name));
  CHECK_THAT(text_of(shell.file("case/constant/transportProperties")), Catch::Contains("0.02;"));
  CHECK_THAT(text_of(shell.file("case/0/U")), Catch::Contains("body { type noSlip; }"));
  const auto report = nlohmann::json::parse(std::ifstream(shell.file("r.json")));
  CHECK(report["layers"]["fill"]["triangles"] > 50);
  CHECK(report["layers"]["fill"]["scaled_jacobian"]["median"] > 0.6);
  // What is there stays; where it is not as the case would have it, that is said.
  const std::string again =
      "square.dat case/constant/polyMesh --layers 3 --first-height 0.02 --fill --farfield box:3L "
      "--case openfoam:case --speed 2 --patch wall=body --patch farfield=far:farfield --reynolds ";
  CHECK_THAT(shell(again + "100").err, !Catch::Contains("warning: case"));
  std::ofstream(shell.file("case/0/U")) << "mine";
  for (const char* const folder : {"case/500", "case/processor0"})
    std::filesystem::create_directories(shell.file(folder));
  const Run kept = shell(again + "50");
  CHECK(kept.code == 0);
  CHECK(text_of(shell.file("case/0/U")) == "mine");
  CHECK_THAT(kept.err, Catch::Contains("rm case/0/U case/constant/transportProperties case/README)"));
  CHECK_THAT(kept.err, Catch::Contains("rm -r case/500 case/processor0)"));
}

TEST_CASE("--periodic couples the two borders of a period", "[command]") {
  ShellCommand shell;
  {
    std::ofstream wall(shell.file("sector.obj"));
    for (int i = 0; i <= 12; ++i)
      for (int j = 0; j <= 6; ++j)
        wall << "v " << i / 4.0 << ' ' << std::cos(std::acos(-1.0) / 18 * j) << ' '
             << std::sin(std::acos(-1.0) / 18 * j) << '\n';
    for (int i = 0; i < 12; ++i)
      for (int j = 1; j <= 6; ++j)
        wall << "f " << 7 * i + j << ' ' << 7 * i + j + 1 << ' ' << 7 * i + j + 8 << ' ' << 7 * i + j + 7 << '\n';
  }
  const std::string run = "sector.obj case/constant/polyMesh --layers 3 --total-thickness=-0.2 --fill ";
  const Run made =
      shell(run +
            "--periodic rotate:1,0,0@5,0,0,360/6 --case openfoam:case --viscosity 0.1 --patch sides_1=in:inlet "
            "--patch sides_2=out:outlet --patch periodic_1=here");
  CHECK(made.code == 0);
  CHECK_THAT(made.err, !Catch::Contains("--symmetry"));
  const std::string boundary = text_of(shell.file("case/constant/polyMesh/boundary"));
  for (const char* const text : {"cyclic;", "neighbourPatch  here;", "neighbourPatch  periodic_2;",
                                 "transform       rotational;", "rotationAxis    (1 0 0);"})
    CHECK_THAT(boundary, Catch::Contains(text));
  CHECK_THAT(text_of(shell.file("case/0/p")), Catch::Contains("here { type cyclic; }"));
  for (const char* const wrong : {"rotate:x", "rotate:x,0", "translate:0,0,0", "rotate:0,0,0,60", "shift:1,0,0"}) {
    const Run refused = shell(run + "--periodic " + wrong);
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::Contains("--periodic: expected"));
  }
  CHECK(shell(run + "--periodic rotate:x,50").code == 2);
  CHECK(shell(run + "--periodic rotate:x,60 --patch periodic_1=in:inlet").code != 0);
}

TEST_CASE("--case writes the options of SU2, with a marker for each patch", "[command]") {
  ShellCommand shell;
  std::ofstream(shell.file("rows.dat")) << "0 0\n1 0\n1 1\n0 1\n0 0\n";
  std::filesystem::create_directory(shell.file("case"));
  const Run made = shell(
      "rows.dat case/rows.su2 --layers 3 --first-height 0.02 --fill --farfield box:3L --case su2:case "
      "--viscosity 0.3 --density 1.5 --speed 2 --direction 0,3,0 --length 0.5 --patch wall=plate --patch "
      "farfield=far:farfield");
  INFO(made.err);
  CHECK(made.code == 0);
  const std::string options = text_of(shell.file("case/flow.cfg"));
  for (const char* const line :
       {"MARKER_HEATFLUX= ( plate, 0.0 )\n", "MARKER_FAR= ( far )\n", "MU_CONSTANT= 0.2\n", "REF_AREA= 0.5\n",
        "INC_VELOCITY_INIT= ( 0, 2, 0 )\n", "MESH_FILENAME= rows.su2\n", "MARKER_MONITORING= ( plate )\n"})
    CHECK_THAT(options, Catch::Contains(line));
  CHECK_THAT(options, !Catch::Contains("INLET"));
  CHECK_THAT(text_of(shell.file("case/README")), Catch::Contains("SU2_CFD flow.cfg"));
  // Each marker is one of the mesh.
  const std::string mesh = text_of(shell.file("case/rows.su2"));
  for (const char* const name : {"plate", "far"})
    CHECK_THAT(mesh, Catch::Contains(std::string("MARKER_TAG= ") + name + "\n"));
  // What is there stays.
  io::write_su2_case(
      shell.file("case/pipe.su2"),
      std::vector<io::CasePatch>{{"in", BoundaryPatch::Kind::Inlet}, {"out", BoundaryPatch::Kind::Outlet}},
      {.speed = 3, .viscosity = 1});
  CHECK(text_of(shell.file("case/flow.cfg")) == options);
  std::filesystem::remove(shell.file("case/flow.cfg"));
  io::write_su2_case(
      shell.file("case/pipe.su2"),
      std::vector<io::CasePatch>{{"in", BoundaryPatch::Kind::Inlet}, {"out", BoundaryPatch::Kind::Outlet}},
      {.speed = 3, .viscosity = 1});
  CHECK_THAT(
      text_of(shell.file("case/flow.cfg")),
      Catch::Contains("INC_INLET_TYPE= ( VELOCITY_INLET )\nMARKER_INLET= ( in, 288.15, 3, 1.0, 0.0, 0.0 )\n"
                      "INLET_USE_NORMAL= YES\nINC_OUTLET_TYPE= ( PRESSURE_OUTLET )\nMARKER_OUTLET= ( out, 0.0 )"));
}

TEST_CASE("--fill says in one line what it cannot do", "[command]") {
  ShellCommand shell;
  std::ofstream(shell.file("square.dat")) << kSquare;
  std::ofstream(shell.file("line.dat")) << "0 0\n1 0\n2 0.1\n";
  struct Wrong {
    const char* line;
    int code;
    const char* says;
  };
  const char* const layers = " --layers 3 --first-height 0.02 ";
  for (const auto& [line, code, says] :
       {Wrong{"square.dat none.vtu --fill -d 0.1", 1, "--fill needs"},
        Wrong{"square.dat none.vtu --farfield sphere:3L LAYERS", 1, "--farfield needs --fill"},
        Wrong{"square.dat none.vtu --fill --farfield sphere:x LAYERS", 1, "sphere:20L"},
        Wrong{"square.dat none.vtu --fill --fill-growth 1 LAYERS", 1, "above 1"},
        Wrong{"square.dat none.vtu --fill --farfield sphere:0.1L LAYERS", 2, "radius of at least"},
        Wrong{"square.dat none.vtu --fill --patch inlet=a:b LAYERS", 1, "PATCH=NAME:KIND"},
        Wrong{"square.dat none.vtu --fill --patch inlet=a LAYERS", 1, "expected one of wall, farfield"},
        Wrong{"square.dat none.vtu --fill --patch 'wall=my hull' LAYERS", 1, "letters, digits"},
        Wrong{"square.dat none.vtu --fill --patch wall=a --patch farfield=a LAYERS", 1, "another name for each"},
        Wrong{"square.dat none.vtu --fill --case openfoam:c --reynolds 1 LAYERS", 1, "c/constant/polyMesh"},
        Wrong{"square.dat c/constant/polyMesh --fill --case openfoam:c LAYERS", 1, "--viscosity"},
        Wrong{"square.dat none.vtu --fill --case fluent:c --reynolds 1 LAYERS", 1, "'openfoam:FOLDER' or 'su2:FOLDER'"},
        Wrong{"square.dat d/x.su2 --fill --case su2:c --reynolds 1 LAYERS", 1, "a .su2 file in c"},
        Wrong{"line.dat none.vtu --fill LAYERS", 2, "closed curves"}}) {
    std::string command = line;
    if (const auto at = command.find("LAYERS"); at != std::string::npos) command.replace(at, 6, layers);
    INFO(command);
    const Run refused = shell(command);
    CHECK(refused.code == code);
    CHECK_THAT(refused.err, Catch::Contains(says));
    CHECK_FALSE(shell.has("none.vtu"));
    CHECK_FALSE(shell.has("c"));
  }
}

TEST_CASE("patches that cannot be are refused before the mesh is filled, all at once and by their planes",
          "[command]") {
  ShellCommand shell;
  {
    std::ofstream pipe(shell.file("pipe.obj"));
    for (int i = 0; i <= 4; ++i)
      for (int j = 0; j < 12; ++j)
        pipe << "v " << i << ' ' << std::cos(M_PI * j / 6) << ' ' << std::sin(M_PI * j / 6) << '\n';
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 12; ++j)
        pipe << "f " << i * 12 + j + 1 << ' ' << i * 12 + (j + 1) % 12 + 1 << ' ' << (i + 1) * 12 + (j + 1) % 12 + 1
             << ' ' << (i + 1) * 12 + j + 1 << '\n';
  }
  // The filler has no time, which would be found first.
  const std::string layers =
      "pipe.obj pipe/constant/polyMesh --layers 2 --total-thickness=-0.1 --fill --fill-seconds 1e-9 ";
  const Run unknown = shell(layers + "--case openfoam:pipe --reynolds 20");
  CHECK(unknown.code == 1);
  for (const char* const says : {"sides_1 (in x = 0)", "sides_2 (in x = 4)", "--patch sides_1=inlet:inlet"})
    CHECK_THAT(unknown.err, Catch::Contains(says));
  // Two patches exchange their names: each stays what it was.
  const std::string swapped = " --fill-with tetgen --patch sides_1=sides_2:inlet --patch sides_2=sides_1:outlet";
  if (std::system("command -v tetgen >/dev/null 2>&1") == 0) {
    CHECK(shell("pipe.obj swapped/constant/polyMesh --layers 2 --total-thickness=-0.1 --fill --case openfoam:swapped "
                "--reynolds 20" +
                swapped)
              .code == 0);
    CHECK_THAT(text_of(shell.file("swapped/0/p")), Catch::Contains("sides_2 { type zeroGradient; }"));
    CHECK_THAT(text_of(shell.file("swapped/0/p")), Catch::Contains("sides_1 { type fixedValue;"));
  }
  using Kind = BoundaryPatch::Kind;
  for (const auto& patches : {std::vector<io::CasePatch>{{"in let", Kind::Inlet}},
                              std::vector<io::CasePatch>{{"end", Kind::Inlet}, {"end", Kind::Outlet}}})
    CHECK_THROWS_AS(io::write_openfoam_case(shell.file("none"), patches, {.viscosity = 1}), InvalidInput);
  const Run misnamed = shell(layers + "--patch inlet=a");
  CHECK(misnamed.code == 1);
  CHECK_THAT(misnamed.err, Catch::Contains("expected one of wall, sides_1, sides_2, got 'inlet'"));
  CHECK_FALSE(shell.has("pipe"));
}
