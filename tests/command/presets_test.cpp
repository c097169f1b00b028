// SPDX-License-Identifier: Apache-2.0
// Options that come from a preset.
#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "command/shell_command.h"

TEST_CASE("presets: a problem with an option that a preset gave says so", "[command]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj out.obj --preset fit", 1,
                "--clearance needs --obstacle or --fit (--clearance comes from --preset fit");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --preset hollow --html p.html", 1,
                "--html and --mode iso exclude each other (--mode comes from --preset hollow");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --preset kerf", 1,
                "--close: expected curves, as this is not for meshes (--close comes from --preset kerf; without it: "
                "--close=false)");
  CHECK(shell("sphere.obj out.obj -d 0.1 --preset kerf --close=false -q").code == 0);
  // One that was typed is nobody else's.
  check_failure(shell, "sphere.obj out.obj -d 0.1 --close", 1, "not for meshes\n");
}

TEST_CASE("presets: a drawing to cut may have lines that stay open", "[command]") {
  const ShellCommand shell;
  const std::string head = "<svg xmlns='http://www.w3.org/2000/svg' width='100' height='100'>",
                    line = "<path d='M5,50 L60,50'/>";
  std::ofstream(shell.file("cut.svg")) << head << "<rect x='5' y='5' width='40' height='30'/>" << line << "</svg>";
  const Run cut = shell("cut.svg out.svg -d 2 --preset kerf");
  CHECK(cut.code == 0);
  CHECK_THAT(cut.out, Catch::Contains("1 of 2 curves is open and moves to one side, which its direction decides") &&
                          Catch::Contains("in the drawing's own, of 0.2646 mm: 2 is 0.5292 mm. For millimetres: "
                                          "--distance 2mm"));
  CHECK_THAT(shell("cut.svg out.svg -d 2mm --preset kerf").out, !Catch::Contains("lengths without a unit"));
  std::ofstream(shell.file("line.svg")) << head << line << "</svg>";
  check_failure(shell, "line.svg out.svg -d 2 --preset kerf", 2,
                "line.svg: --close: expected a closed curve, or ends nearer to each other than 0.1 of the length "
                "between them, got a gap of 55 in 55 (--close comes from --preset kerf; without it: --close=false)");
}

TEST_CASE("presets: a height that is given takes the place of the preset's", "[command]") {
  const ShellCommand shell;
  CHECK_THAT(shell("sphere.obj out.vtu --preset layers --total-thickness 0.1").out,
             Catch::Contains("10 layers full on 100.0 %") && Catch::Contains("0.1 of 0.1 thick"));
  std::ofstream(shell.file("heights.txt")) << "0.01\n0.03\n";
  CHECK_THAT(shell("sphere.obj out.vtu --preset layers --heights heights.txt").out,
             Catch::Contains("2 layers full on 100.0 %") && Catch::Contains("0.03 of 0.03 thick"));
}

TEST_CASE("presets: a hollow figure keeps its own faces outside, or the run says that it does not", "[command]") {
  const ShellCommand shell;
  const std::string outside = "above 0 the distance makes a new skin outside";
  CHECK_THAT(shell("sphere.obj out.obj -d 0.2 --preset hollow").out, Catch::Contains(outside));
  CHECK_THAT(shell("sphere.obj out.obj -d -0.2 --preset hollow").out, !Catch::Contains(outside));
}
