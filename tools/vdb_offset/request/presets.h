// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "request/request.h"
#include "vdb_offset/run.h"

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

/// What is wrong with options, and behind it the first of those of a preset that it names: nobody typed that.
std::string explained(std::string problem, const std::vector<PresetOption>& options);

/// Does what may find options wrong, by themselves or for an input, and explains those of a preset. \throw UsageError,
/// InvalidInput, InvalidOption
template <class Work>
auto explaining_presets(const std::vector<PresetOption>& options, Work work) {
  try {
    return work();
  } catch (const UsageError& error) {
    throw UsageError(explained(error.what(), options));
  } catch (const InvalidInput& error) {
    throw InvalidInput(explained(error.what(), options));
  } catch (const InvalidOption& error) {
    throw InvalidOption(explained(error.what(), options));
  }
}

}  // namespace vdb_offset::tool
