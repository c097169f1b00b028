// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "vdb_offset/result.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

// What reports say of things that are made of an offset.
nlohmann::ordered_json shell_json(const ShellFacts& shell);
nlohmann::ordered_json cad_json(const CadFileFacts& cad);

}  // namespace vdb_offset
