// SPDX-License-Identifier: Apache-2.0
// Where the build and the project have what tests use.
#pragma once

#include <string>

namespace vdb_offset::test {

std::string command_path();
/// The program that makes the CAD models of tests, where CAD files are read.
std::string cad_models_path();
/// The folder of the modules that the command and the library open.
std::string modules_path();
std::string scenes_path();

}  // namespace vdb_offset::test
