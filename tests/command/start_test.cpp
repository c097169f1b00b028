// SPDX-License-Identifier: Apache-2.0
// What the command loads, and when.
#include <stdlib.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "command/shell_command.h"
#include "support/places.h"

namespace {

/// The names of all that is loaded while the command runs, which must succeed.
std::string loaded_by(const ShellCommand& shell, const std::string& arguments) {
  const std::filesystem::path folder = shell.file("loaded");
  std::filesystem::create_directory(folder);
  ::setenv("LD_DEBUG", "libs", 1);
  ::setenv("LD_DEBUG_OUTPUT", (folder / "by").c_str(), 1);
  CHECK(shell(arguments).code == 0);
  ::unsetenv("LD_DEBUG");
  ::unsetenv("LD_DEBUG_OUTPUT");
  std::string text;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) text += shell.slurp(entry.path().string());
  std::filesystem::remove_all(folder);
  return text;
}

}  // namespace

TEST_CASE("command: VTK and CGNS are loaded by runs that write their files, and by no others", "[command][start]") {
  using Catch::Contains;
  const ShellCommand shell;
  const std::string layers = " --layers 2 --first-height 0.01";
  for (const std::string& arguments :
       {std::string("--version"), std::string("sphere.obj out.glb --distance 0.1"),
        std::string("sphere.obj in.vtp --distance 0.1"), "sphere.obj out.msh" + layers}) {
    INFO(arguments);
    CHECK_THAT(loaded_by(shell, arguments), Contains("libopenvdb") && !Contains("libvtk") && !Contains("libcgns") &&
                                                !Contains("libhdf5") && !Contains("libassimp"));
  }
  CHECK_THAT(loaded_by(shell, "in.vtp out.obj --distance 0.1"), Contains("libvtkIOXML") && !Contains("libassimp"));
  CHECK_THAT(loaded_by(shell, "sphere.obj out.vtu" + layers), !Contains("libvtk") && !Contains("libcgns"));
  CHECK_THAT(loaded_by(shell, "sphere.obj out.cgns" + layers), Contains("libcgns") && !Contains("libvtk"));
  CHECK(shell.has("out.vtu"));
  CHECK(shell.has("out.cgns"));
}

TEST_CASE("command: a missing module is told before the work, in one line", "[command][start]") {
  const ShellCommand shell;
  const std::string alone = shell.file("alone"), text = shell.file("text");
  std::filesystem::copy_file(vdb_offset::test::command_path(), alone);
  const int status =
      std::system(("cd / && env -u VDB_OFFSET_MODULES '" + alone + "' '" + shell.file("sphere.obj") + "' '" +
                   shell.file("out.cgns") + "' --layers 2 --first-height 0.01 --quiet 2>'" + text + "' </dev/null")
                      .c_str());
  CHECK(WEXITSTATUS(status) == 4);
  const std::string err = shell.slurp(text);
  CHECK_THAT(err, Catch::Contains("out.cgns: expected the module vdb_offset_cgns.so, which writes it") &&
                      Catch::Contains("install the whole package"));
  CHECK(std::count(err.begin(), err.end(), '\n') == 1);
  CHECK(!shell.has("out.cgns"));
}
