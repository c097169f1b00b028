// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/places.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shapes.h"

struct Run {
  int code;  ///< Exit code, or 128 + signal.
  std::string out, err;
};

/// A folder with a sphere in it, and the command run inside.
class ShellCommand {
 public:
  ShellCommand() {
    std::filesystem::create_directories(path_);
    vdb_offset::io::write_mesh(file("sphere.obj"), vdb_offset::shapes::icosphere(1, 3).view());
  }
  ~ShellCommand() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }
  std::size_t count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

  std::string environment;  ///< Variables that the command gets besides, as NAME=VALUE.

  Run operator()(const std::string& arguments) const {
    const std::string err = (std::filesystem::temp_directory_path() / ("vdb_offset_err_" + std::to_string(::getpid())))
                                .string(),
                      out = err + "_out";
    const int status =
        std::system(("cd '" + path_.string() + "' && exec env " + environment + " '" +
                     vdb_offset::test::command_path() + "' " + arguments + " >" + out + " 2>" + err + " </dev/null")
                        .c_str());
    Run run{WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), slurp(out), slurp(err)};
    std::filesystem::remove(err);
    std::filesystem::remove(out);
    return run;
  }
  std::string slurp(const std::string& path) const {
    std::ifstream in(path);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("vdb_offset_command_test_" + std::to_string(::getpid()));
};

/// Exit code and message of a call that must fail and leave nothing behind.
inline void check_failure(const ShellCommand& shell, const std::string& arguments, int code,
                          const std::string& message) {
  INFO(arguments);
  const std::size_t before = shell.count();
  const Run run = shell(arguments);
  CHECK(run.code == code);
  CHECK_THAT(run.err, Catch::StartsWith("vdb_offset: ") && Catch::Contains(message));
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  CHECK(run.out.empty());
  CHECK(shell.count() == before);
}
