// SPDX-License-Identifier: Apache-2.0
#include "request/presets.h"

#include <fmt/format.h>

#include <algorithm>

#include "request/option_values.h"
#include "vdb_offset_presets.h"

namespace vdb_offset::tool {

std::span<const Preset> presets() { return kPresets; }

const Preset& preset_of(const std::string& name) {
  const std::span<const Preset> all = presets();
  const auto found = std::ranges::find(all, name, &Preset::name);
  if (found != all.end()) return *found;
  std::string names;
  for (const Preset& each : all) names += fmt::format("'{}', ", each.name);
  throw UsageError(fmt::format("--preset: expected {}or 'help', got '{}'", names, name));
}

std::string presets_in_words() {
  std::string text = "--preset NAME takes these options, unless the command line or --config says otherwise:\n";
  for (const Preset& each : presets()) text += fmt::format("\n[{}]\n{}", each.name, each.text);
  return text + "\nTo change one, copy it to a file of your own and give that with --config.\n";
}

std::string explained(std::string problem, const std::vector<PresetOption>& options) {
  const auto is_named = [&](const PresetOption& option) {
    // As a whole word: --fit is not part of --fit-tolerance.
    for (std::size_t at = problem.find(option.name); at != std::string::npos; at = problem.find(option.name, at + 1)) {
      const std::size_t end = at + option.name.size();
      if (end == problem.size() || std::string_view(" ,:;.)").find(problem[end]) != std::string_view::npos) return true;
    }
    return false;
  };
  const auto found = std::ranges::find_if(options, is_named);
  if (found != options.end())
    problem += fmt::format(" ({} comes from --preset {}{})", found->name, found->preset,
                           found->is_flag ? fmt::format("; without it: {}=false", found->name)
                                          : "; --preset help shows the others, to give them without it");
  return problem;
}

}  // namespace vdb_offset::tool
