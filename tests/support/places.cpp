// SPDX-License-Identifier: Apache-2.0
// The only source of the tests with paths of this checkout in it: all others are the same to a compiler's cache
// wherever they lie.
#include "support/places.h"

namespace vdb_offset::test {

std::string command_path() { return COMMAND; }

#ifdef CAD_MODELS
std::string cad_models_path() { return CAD_MODELS; }
#endif

std::string modules_path() { return MODULES; }

std::string scenes_path() { return SCENES; }

}  // namespace vdb_offset::test
