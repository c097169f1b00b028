// SPDX-License-Identifier: Apache-2.0
// The only source of the tests with paths of this checkout in it: all others are the same to a compiler's cache
// wherever they lie.
#include "support/places.h"

namespace vdb_offset::test {

std::string command_path() { return BUILD "/vdb_offset"; }

std::string cad_models_path() { return BUILD "/tests/vdb_offset_cad_models"; }

std::string modules_path() { return BUILD; }

std::string scenes_path() { return SCENES; }

}  // namespace vdb_offset::test
