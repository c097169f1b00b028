// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "job.h"
#include "vdb_offset/distances.h"

namespace vdb_offset::tool {

/// The heights of layers above the wall, from there on. \pre layers are asked for. \throw ReadError, InvalidInput, for
/// a file of heights with its line
std::vector<Distances> heights_of_layers(Job& job);

}  // namespace vdb_offset::tool
