// SPDX-License-Identifier: Apache-2.0
// What the command loads, and when.
#include <stdlib.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "command/shell_command.h"
#include "support/places.h"

#ifdef LOADS_WRITERS
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

TEST_CASE("command: OpenVDB, VTK and CGNS are loaded by runs that need them, and by no others", "[command][start]") {
  using Catch::Contains;
  const ShellCommand shell;
  const std::string layers = " --layers 2 --first-height 0.01";
  for (const std::string& arguments :
       {std::string("--version"), std::string("sphere.obj out.glb --distance 0.1"),
        std::string("sphere.obj in.vtp --distance 0.1"), std::string("sphere.obj shell.obj --distance 0.1 --shell"),
        std::string("sphere.obj offset.obj --distance 0.1"), std::string("check sphere.obj offset.obj"),
        std::string("sphere.obj out.obj -d 0.1 -d -0.1 --collision merge --report r.json --states s.csv --paths p.obj"),
        "sphere.obj out.msh" + layers}) {
    INFO(arguments);
    CHECK_THAT(loaded_by(shell, arguments), Contains("libtbb") && !Contains("libopenvdb") && !Contains("libvtk") &&
                                                !Contains("libcgns") && !Contains("libhdf5") && !Contains("libassimp"));
  }
  for (const std::string arguments :
       {"sphere.obj out.obj --distance 0.1 --save-vdb out.vdb", "sphere.obj out.obj --distance 0.1 --mode iso"}) {
    INFO(arguments);
    CHECK_THAT(loaded_by(shell, arguments), Contains("libopenvdb") && !Contains("libvtk") && !Contains("libcgns"));
  }
  CHECK(shell.has("out.vdb"));
  CHECK_THAT(loaded_by(shell, "in.vtp out.obj --distance 0.1"), Contains("libvtkIOXML") && !Contains("libassimp"));
  CHECK_THAT(loaded_by(shell, "sphere.obj out.vtu" + layers),
             Contains("libvtkIOXML") && !Contains("libcgns") && !Contains("libopenvdb"));
  CHECK_THAT(loaded_by(shell, "sphere.obj out.cgns" + layers),
             Contains("libcgns") && !Contains("libvtk") && !Contains("libopenvdb"));
  CHECK(shell.has("out.vtu"));
  CHECK(shell.has("out.cgns"));
}

TEST_CASE("command: a missing module is told before the work, in one line", "[command][start]") {
  const ShellCommand shell;
  const std::string alone = shell.file("alone"), text = shell.file("text");
  std::filesystem::copy_file(vdb_offset::test::command_path(), alone);
  const auto check_missing = [&](const std::string& out, const std::string& options, int code, const char* told) {
    INFO(out << ' ' << options);
    const int status = std::system(("cd / && env -u VDB_OFFSET_MODULES '" + alone + "' '" + shell.file("sphere.obj") +
                                    "' '" + shell.file(out) + "' " + options + " --quiet 2>'" + text + "' </dev/null")
                                       .c_str());
    CHECK(WEXITSTATUS(status) == code);
    const std::string err = shell.slurp(text);
    CHECK_THAT(err, Catch::Contains(told) && Catch::Contains("install the whole package"));
    CHECK(std::count(err.begin(), err.end(), '\n') == 1);
    CHECK(!shell.has(out));
  };
  const std::string layers = "--layers 2 --first-height 0.01";
  check_missing("out.vtu", layers, 4, "out.vtu: expected the module vdb_offset_vtk.so, which writes it");
  check_missing("out.cgns", layers, 4, "out.cgns: expected the module vdb_offset_cgns.so, which writes it");
  check_missing("out.obj", "-d 0.1 --save-vdb '" + shell.file("out.vdb") + "'", 4,
                "out.vdb: expected the module vdb_offset_vdb.so, which writes it");
  check_missing("out.obj", "-d 0.1 --mode iso", 3, "capture: expected the module vdb_offset_vdb.so, which does it");
}
#endif
