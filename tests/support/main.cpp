// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "support/places.h"

int main(int argc, char** argv) {
  // Where the build has its modules: they are looked for beside a program, and the tests lie elsewhere.
  ::setenv("VDB_OFFSET_MODULES", vdb_offset::test::modules_path().c_str(), 1);
  return Catch::Session().run(argc, argv);
}
