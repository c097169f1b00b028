// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "vdb_offset/cells.h"

namespace vdb_offset {

/// The name, or with a number behind it if a patch has it.
std::string free_name(const VolumeMesh& mesh, const std::string& wanted);

}  // namespace vdb_offset
