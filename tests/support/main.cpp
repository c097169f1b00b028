// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

int main(int argc, char** argv) {
  // Where the build has its modules: they are looked for beside a program, and the tests lie elsewhere.
  ::setenv("VDB_OFFSET_MODULES", MODULES, 1);
  return Catch::Session().run(argc, argv);
}
