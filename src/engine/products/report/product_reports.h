// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "vdb_offset/cells.h"
#include "vdb_offset/result.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

nlohmann::ordered_json spread_json(const Spread& spread);

// What reports say of things that are made of an offset.
nlohmann::ordered_json shell_json(const ShellFacts& shell);
nlohmann::ordered_json cad_json(const CadFileFacts& cad);
nlohmann::ordered_json fill_json(const FillReport& fill);
nlohmann::ordered_json boundary_json(std::span<const PatchFacts> boundary);

}  // namespace vdb_offset
