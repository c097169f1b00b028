// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <cstdlib>
#include <string>
#include <vector>

#include "shell_command.h"

namespace {

/// What the command writes to a terminal.
std::string on_terminal(const ShellCommand& shell, const std::string& arguments) {
  const std::string seen = shell.file("seen");
  const int status = std::system(("cd '" + shell.file("") + "' && script -qec \"'" + vdb_offset::test::command_path() +
                                  "' " + arguments + "\" /dev/null >'" + seen + "' </dev/null")
                                     .c_str());
  CHECK(WEXITSTATUS(status) == 0);
  return shell.slurp(seen);
}

/// The number before each " %  " that follows a bar.
std::vector<int> percentages_in(const std::string& text) {
  std::vector<int> all;
  for (std::size_t at = text.find("] "); at != std::string::npos; at = text.find("] ", at + 1))
    all.push_back(std::atoi(&text[at + 2]));
  return all;
}

}  // namespace

TEST_CASE("command: one bar for a whole run, which never falls and ends at 100 %", "[command][progress]") {
  const ShellCommand shell;
  for (const std::string arguments :
       {"sphere.obj o.obj -d 0.1", "sphere.obj o{}.obj -d 0.1 -d -0.1",
        "sphere.obj o.vtu --layers 3 --total-thickness 0.1", "sphere.obj o.obj -d 0.1 --mode iso",
        "sphere.obj o{}.obj -d 0.1 -d -0.1 --mode iso", "sphere.obj o.obj -d 0.1 --tolerance 5%",
        "check sphere.obj sphere.obj -d 0"}) {
    INFO(arguments);
    const std::string text = on_terminal(shell, arguments);
    const std::vector<int> shown = percentages_in(text);
    REQUIRE(shown.size() >= 2);
    CHECK(shown.front() == 0);
    CHECK(std::is_sorted(shown.begin(), shown.end()));
    CHECK(shown.back() == 100);
    CHECK_THAT(text, Catch::Contains("%  computing distances") || Catch::Contains("%  measuring"));
  }
  CHECK(percentages_in(on_terminal(shell, "sphere.obj o.obj -d 0.1 -q")).empty());
  CHECK(shell("sphere.obj o.obj -d 0.1").err.empty());  // no terminal
}

TEST_CASE("command: the bar of a longer run says how long the rest will take", "[command][progress][long]") {
  const ShellCommand shell;
  vdb_offset::io::write_mesh(shell.file("fine.obj"), vdb_offset::shapes::icosphere(1, 7).view());
  const std::string text = on_terminal(shell, "fine.obj o.obj -d 0.1 --threads 1");
  const std::size_t left = text.find(" s left");
  REQUIRE(left != std::string::npos);
  const std::size_t comma = text.rfind(", ", left);
  CHECK(std::isdigit(static_cast<unsigned char>(text[comma + 2])));
  CHECK_THAT(text.substr(comma - 30, 30), Catch::Contains(" %  "));
}
