// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <filesystem>

#include "command/shell_command.h"

using namespace vdb_offset;

TEST_CASE("command: --html writes a page for each distance, of which each has the command", "[command][page]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1 -d '0.2 + 0*x' --html 'p_{i}.html'").code == 0);
  for (const std::string name : {"p_001.html", "p_002.html"})
    CHECK_THAT(shell.slurp(shell.file(name)),
               Catch::StartsWith("<!DOCTYPE html>") &&
                   Catch::Contains("sphere.obj out.obj -d 0.1 -d '0.2 + 0*x' --html 'p_{i}.html'"));
  const Run piped = shell("sphere.obj out.obj -d 0.1 --html -");
  CHECK_THAT(piped.out, Catch::StartsWith("<!DOCTYPE html>"));
  CHECK_THAT(piped.err, Catch::Contains("reached"));
}

TEST_CASE("command: pages of layers have the surface at each height, and the cells' quality",
          "[command][page][layers]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.vtu --layers 3 --total-thickness 0.1 --html p.html").code == 0);
  const std::string page = shell.slurp(shell.file("p.html"));
  for (const std::string name : {"layer 1", "layer 2", "layer 3"})
    CHECK_THAT(page, Catch::Contains("\"" + name + "\""));
  CHECK_THAT(page, Catch::Contains("\"quality\":"));
}

TEST_CASE("command: pages that cannot be written are refused before the work", "[command][page]") {
  const ShellCommand shell;
  check_failure(shell, "sphere.obj out.obj -d 0.1 --html p.obj", 1, "expected a page that ends in .html");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --mode iso --html p.html", 1,
                "--html and --mode iso exclude each other");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --report p.html --html p.html", 1, "expected a file of its own");
  check_failure(shell, "sphere.obj out.obj -d 0.1 --html nowhere/p.html", 4, "nowhere/p.html");
  CHECK_FALSE(std::filesystem::exists(shell.file("out.obj")));
}
