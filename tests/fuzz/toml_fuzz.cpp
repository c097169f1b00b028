// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for files of options: whatever the bytes are, they are refused with UsageError or are options that
// have a name, a line and values. What else is thrown ends the process, as do the sanitizers.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "request/config_file.h"
#include "request/request.h"

using namespace vdb_offset::tool;

namespace {

/// Not an assert: it must hold in every build.
void require(bool holds, const char* rule) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", rule);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<ConfigEntry> entries;
  try {
    entries = parse_config("fuzz.toml", {reinterpret_cast<const char*>(data), size});
  } catch (const UsageError&) {
    return 0;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ConfigEntry& entry = entries[i];
    ::require(entry.place.starts_with("fuzz.toml:"), "an option has a line");
    ::require(!entry.is_switch || entry.values.empty(), "a switch has no value");
    ::require(i == 0 || entries[i - 1].name < entry.name, "an option is there once");
  }
  return 0;
}
