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

TEST_CASE("command: a page has the unit of its file and the axis that is up in its format", "[command][page]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.glb -d 0.1").code == 0);
  CHECK(shell("view out.glb --no-open --html glb.html").code == 0);
  CHECK_THAT(shell.slurp(shell.file("glb.html")), Catch::Contains(R"("unit":"m")") && Catch::Contains(R"("up":1)"));
  CHECK(shell("view sphere.obj --unit mm --no-open --html obj.html").code == 0);
  CHECK_THAT(shell.slurp(shell.file("obj.html")), Catch::Contains(R"("unit":"mm")") && Catch::Contains(R"("up":2)"));
  CHECK(shell("sphere.obj out.obj -d 0.1 --html run.html").code == 0);
  CHECK_THAT(shell.slurp(shell.file("run.html")), Catch::Contains(R"("unit":"")"));
}

TEST_CASE("command: view shows a mesh, and a result as check measures it", "[command][page]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj out.obj -d 0.1").code == 0);
  const Run alone = shell("view sphere.obj --no-open --html alone.html");
  CHECK(alone.code == 0);
  CHECK(alone.out == "alone.html\n");
  CHECK(alone.err.empty());
  CHECK_THAT(shell.slurp(shell.file("alone.html")), Catch::Contains(R"("surfaces":[])"));
  CHECK(shell("view sphere.obj out.obj -d 0.1 --no-open --html both.html").code == 0);
  CHECK(shell("check sphere.obj out.obj -d 0.1 --html checked.html").code == 0);
  const auto surfaces = [&](const std::string& name) {
    const std::string page = shell.slurp(shell.file(name));
    const std::size_t begin = page.find("\"surfaces\":[");
    return page.substr(begin, page.find("]}]", begin) - begin);
  };
  CHECK(surfaces("both.html") == surfaces("checked.html"));
  CHECK_THAT(surfaces("both.html"), Catch::Contains("\"states\""));
  const Run piped = shell("view sphere.obj out.obj --html -");
  CHECK_THAT(piped.out, Catch::StartsWith("<!DOCTYPE html>"));
}

TEST_CASE("command: view shows a result with other faces as it is", "[command][page]") {
  const ShellCommand shell;
  CHECK(shell("sphere.obj iso.obj -d 0.1 --mode iso").code == 0);
  const Run run = shell("view sphere.obj iso.obj --no-open --html p.html");
  CHECK(run.code == 0);
  CHECK_THAT(run.err, Catch::Contains("iso.obj: has other vertices or faces than the source, so nothing is measured"));
  CHECK_THAT(shell.slurp(shell.file("p.html")),
             Catch::Contains("\"surface0.corners\"") && Catch::Contains("\"iso.obj\""));
}

TEST_CASE("command: view writes a temporary file for its owner, and opens it by $BROWSER", "[command][page]") {
  ShellCommand shell;
  std::filesystem::create_directory(shell.file("tmp"));
  const auto files = [&] {
    std::vector<std::filesystem::path> found;
    for (const auto& each : std::filesystem::directory_iterator(shell.file("tmp")))
      if (each.path().extension() == ".html") found.push_back(each.path());
    return found;
  };
  shell.environment = "TMPDIR='" + shell.file("tmp") + "' BROWSER='none-of-that-name:cp -f %s seen.html'";
  const Run opened = shell("view sphere.obj");
  CHECK(opened.code == 0);
  CHECK(opened.err.empty());
  REQUIRE(files().size() == 1);
  CHECK(opened.out == files()[0].string() + "\n");
  CHECK(shell.slurp(shell.file("seen.html")) == shell.slurp(files()[0].string()));
  CHECK((std::filesystem::status(files()[0]).permissions() & std::filesystem::perms::others_read) ==
        std::filesystem::perms::none);
  shell.environment = "TMPDIR='" + shell.file("tmp") + "' BROWSER=false";
  const Run failed = shell("view sphere.obj --html kept.html");
  CHECK(failed.code == 0);
  CHECK_THAT(failed.err, Catch::Contains("kept.html: not opened (false: exit code 1)"));
  CHECK(shell.has("kept.html"));
  check_failure(shell, "view sphere.obj none.obj --no-open", 2, "none.obj");
  CHECK(files().size() == 1);
  shell.environment = "TMPDIR='" + shell.file("none") + "'";
  check_failure(shell, "view sphere.obj --no-open", 4, "TMPDIR: expected a folder");
}

TEST_CASE("command: view refuses what it cannot show, and files named view are files", "[command][page]") {
  const ShellCommand shell;
  check_failure(shell, "view sphere.obj -d 0.1 --no-open", 1, "--distance: expected a RESULT");
  check_failure(shell, "view none.obj --no-open", 2, "none.obj: cannot be opened");
  check_failure(shell, "view --no-open", 1, "FILE");
  check_failure(shell, "view sphere.obj '' --no-open", 1, "RESULT: expected a value");
  check_failure(shell, "view sphere.obj --html sphere.obj", 1, "expected a page that ends in .html");
  check_failure(shell, "view sphere.obj --html no/p.html", 4, "no/p.html");
  std::filesystem::copy_file(shell.file("sphere.obj"), shell.file("view"));
  CHECK(shell("./view out.obj --format obj -d 0.1").code == 0);
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
