// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace vdb_offset::tool {

/// What a file says of one option.
struct ConfigEntry {
  std::string name;                 ///< The option's long name, without dashes.
  std::vector<std::string> values;  ///< As on the command line, several of an array.
  bool is_switch = false;           ///< It is true or false, and has no other value.
  bool is_on = false;               ///< Which of them.
  std::string place;                ///< FILE:LINE, for messages.
};

/// Reads options from a file in TOML: names with a string, a number, true or false, or an array of strings and numbers.
/// \throw UsageError with the line for a file that is none, or cannot be read
std::vector<ConfigEntry> read_config(const std::string& path);
/// The same from what such a file holds; `path` is for messages.
std::vector<ConfigEntry> parse_config(const std::string& path, const std::string& text);

}  // namespace vdb_offset::tool
