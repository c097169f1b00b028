// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vdb_offset::tool {

/// Options that belong together, as a file for --config: presets/NAME.toml when the command was built.
struct Preset {
  std::string_view name, text;
};
std::span<const Preset> presets();

/// \throw UsageError if there is none of that name
const Preset& preset_of(const std::string& name);

/// All of them, each with its text.
std::string presets_in_words();

}  // namespace vdb_offset::tool
