// SPDX-License-Identifier: Apache-2.0
// Lengths with units.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "command/shell_command.h"

namespace {

/// Requires that two calls write the same bytes.
void check_same(const ShellCommand& shell, const std::string& with_units, const std::string& without) {
  INFO(with_units << "  =  " << without);
  CHECK(shell("sphere.obj a.obj -q " + with_units).code == 0);
  CHECK(shell("sphere.obj b.obj -q " + without).code == 0);
  const std::string written = shell.slurp(shell.file("a.obj"));
  CHECK(written.size() > 1000);
  CHECK(written == shell.slurp(shell.file("b.obj")));
}

}  // namespace

TEST_CASE("units: a length with a unit is that length in the unit of the file", "[command][long]") {
  const ShellCommand shell;
  check_same(shell, "-d 0.1mm --unit mm", "-d 0.1");
  check_same(shell, "-d 0.1mm --unit cm", "-d 0.01");
  check_same(shell, "-d 2mm --unit m", "-d 0.002");
  check_same(shell, "-d -2cm --unit ft", "-d -0.06561679790026247");
  check_same(shell, "-d '0.1 in' --unit in", "-d 0.1");
  check_same(shell, "-d 0.1in --unit mm", "-d 2.54");
  check_same(shell, "--unit um -d 1e-3mm", "-d 1");
  check_same(shell, "-d 1% --unit mm", "-d 1%");
  check_same(shell, "-d 0.1 --unit mm", "-d 0.1");
  check_same(shell, "-d '0.1 + 0.01*x' --unit mm", "-d '0.1 + 0.01*x'");
  check_same(shell, "--distance-xy 1cm --distance-z 0.5mm --unit cm", "--distance-xy 1 --distance-z 0.05");
  check_same(shell, "-d 1mm --voxel-size 0.5mm --weld 1um --unit cm", "-d 0.1 --voxel-size 0.05 --weld 1e-4");
  check_same(shell, "-d 1mm --shell --inner 2mm --unit cm", "-d 0.1 --shell --inner 0.2");
  check_same(shell, "-d 1mm --tolerance 0.1mm --unit cm", "-d 0.1 --tolerance 0.01");
  CHECK(shell("sphere.obj out.msh --layers 2 --first-height 1mm --unit cm -q").code == 0);
  CHECK(shell("sphere.obj out.obj -d 1mm --unit cm -q").code == 0);
  CHECK(shell("check sphere.obj out.obj -d 1mm --unit cm --strict").code == 0);
  CHECK(shell("check sphere.obj out.obj -d 1mm --unit mm --strict").code == 3);
}

TEST_CASE("units: a drawing's size and viewBox tell its unit", "[command]") {
  const ShellCommand shell;
  std::ofstream(shell.file("a.svg")) << "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' "
                                        "viewBox='0 0 1000 600'><rect x='50' y='50' width='400' height='300'/></svg>";
  CHECK(shell("a.svg o.svg -d 0.1mm --corners miter").code == 0);
  CHECK_THAT(shell.slurp(shell.file("o.svg")), Catch::Contains("M49,49 L451,49 L451,351 L49,351 Z"));
  CHECK(shell("check a.svg o.svg -d 0.1mm --corners miter --strict").code == 0);
  const Run other = shell("a.svg o.svg -d 0.1mm --unit mm");
  CHECK(other.code == 0);
  CHECK_THAT(other.err, Catch::Contains("its own unit is 0.1 mm, and --unit takes it for 1 mm"));
  std::ofstream(shell.file("b.svg")) << "<svg xmlns='http://www.w3.org/2000/svg' width='100%' viewBox='0 0 1000 600'>"
                                        "<rect x='50' y='50' width='400' height='300'/></svg>";
  check_failure(shell, "b.svg p.svg -d 0.1mm", 1, "does not state its unit; add --unit mm");
}

TEST_CASE("units: what is said of lengths is in the unit of the distance, also in a file of another one", "[command]") {
  const ShellCommand shell;
  const auto says = [&](const std::string& arguments, const std::string& words) {
    INFO(arguments);
    CHECK_THAT(shell("sphere.obj " + arguments).out, Catch::Contains(words));
  };
  says("a.obj -d 0.2mm --unit in", "within 1 % of 0.2 mm (");
  says("a.obj -d 0.2 --unit in", "within 1 % of 0.2 in (");
  says("a.obj -d 0.2", "within 1 % of 0.2 (");
  says("a.obj -d 1mm --voxel-size 0.1cm --unit in", "within 1 % of 1 mm (");
  says("a.obj -d 2.54mm --unit in --dry-run", "distance   2.54 mm\nvoxel size");
  says("a.obj -d 2.54mm --unit in --mode iso --voxel-size 2.54mm", " at 2.54 mm: 1 component");
  says("a.vtu --layers 2 --total-thickness 5.08mm --unit in", "5.08 mm of 5.08 mm thick on average");
  // Of a ball 2 in wide with a wall of 0.1 in, the outer radius is 1.1 in: in mm³ 4/3 pi (27.94³ - 25.4³).
  const std::string solid = shell("sphere.obj a.obj -d 2.54mm --unit in --shell --report r.json").out;
  CHECK_THAT(solid, Catch::Contains("shell closed, volume ") && Catch::Contains(" mm³ ("));
  const double volume = std::stod(solid.substr(solid.find("volume ") + 7));
  CHECK(volume == Approx(22700).epsilon(0.02));
  const auto report = nlohmann::json::parse(shell.slurp(shell.file("r.json")));
  CHECK_THAT(solid, Catch::StartsWith(report["verdict"].get<std::string>()));
  CHECK(report["distance"].get<double>() == Approx(0.1));  // in units of the file
  CHECK(shell("sphere.obj b.obj -d 2.54mm --unit in -q").code == 0);
  CHECK_THAT(shell("check sphere.obj b.obj -d 2.54mm --unit in").out,
             Catch::StartsWith("distance    2.54 mm: 100.000 %") && Catch::Contains("median 2.54 mm"));
  const Run json = shell("check sphere.obj b.obj -d 2.54mm --unit in --json");
  CHECK_THAT(nlohmann::json::parse(json.out)["verdict"].get<std::string>(),
             Catch::StartsWith("b.obj: valid; ") && Catch::Contains("within 1 % of 2.54 mm"));
  const Run none = shell("sphere.obj a.obj -d -60mm --unit in");
  CHECK(none.code == 3);
  CHECK_THAT(none.err, Catch::Contains("reached the distance of -60 mm: the part is thinner than 2 × 60 mm."));
}

TEST_CASE("units: a format without the unit of the input is no silent loss of it", "[command]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj in.glb -d 0.1 -q").code == 0);  // in metres, as all of glTF
  CHECK_THAT(shell("in.glb out.stl -d 1mm").err, Catch::Contains("the unit (1000 mm)"));
  CHECK_THAT(shell("in.glb out.gltf -d 1mm").err, !Catch::Contains("the unit"));
  CHECK(shell("sphere.obj in.3mf -d 0.1 --unit mm -q").code == 0);
  CHECK_THAT(shell("in.3mf out.glb -d 0.1mm").err, Catch::Contains("the unit (1 mm; the numbers stay as they are"));
  CHECK_THAT(shell("in.3mf out.stl -d 0.1mm").err, !Catch::Contains("the unit"));
}

TEST_CASE("units: what cannot be meant is refused", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj a.obj -d 0.2mm", 1, "does not state its unit; add --unit mm");
  check_failure(shell, "sphere.obj a.obj -d 0.2 --unit parsec", 1,
                "--unit: expected 'um', 'mm', 'cm', 'm', 'in' or 'ft'");
  check_failure(shell, "sphere.obj a.obj -d 0.2 --unit Inch", 1, "got 'Inch'; did you mean in?");
  check_failure(shell, "sphere.obj a.obj -d 0.2 MM", 1, "MM: expected the unit without a space, as in 0.2mm");
  check_failure(shell, "sphere.obj a.obj -d 0.2km --unit m", 1, "--distance: distance '0.2km'");
  check_failure(shell, "sphere.obj a.obj -d mm --unit mm", 1, "unknown name 'mm'");
  check_failure(shell, "sphere.obj a.obj -d 0.2mmm --unit mm", 1, "--distance: distance '0.2mmm'");
  check_failure(shell, "sphere.obj a.obj -d 0.1 --max-memory 4mm --unit mm", 1, "--max-memory");
}
