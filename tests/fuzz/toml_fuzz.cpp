// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for files of options: whatever the bytes are, they are refused with UsageError or are options that
// have a name, a line and values. What else is thrown ends the process, as do the sanitizers.

#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/promise.h"
#include "request/config_file.h"
#include "request/request.h"

using vdb_offset::tool::ConfigEntry, vdb_offset::tool::parse_config, vdb_offset::tool::UsageError;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<ConfigEntry> entries;
  try {
    entries = parse_config("fuzz.toml", {reinterpret_cast<const char*>(data), size});
  } catch (const UsageError&) {
    return 0;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ConfigEntry& entry = entries[i];
    require(entry.place.starts_with("fuzz.toml:"), "an option has a line");
    require(!entry.is_switch || entry.values.empty(), "a switch has no value");
    require(i == 0 || entries[i - 1].name < entry.name, "an option is there once");
  }
  return 0;
}
