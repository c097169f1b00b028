// SPDX-License-Identifier: Apache-2.0
// Reads files of options with toml++.
#include "request/config_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>
#include <utility>

#include "request/option_values.h"
#include "request/request.h"
#include "request/toml_parser.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

// Bytes; options by hand are less, and a file of another kind is not to be read to its end.
constexpr std::size_t kLargestConfig = std::size_t{1} << 20;
// Bytes of a key; no option has so long a name.
constexpr std::size_t kLongestKey = 64;

/// \throw ReadError, UsageError
std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kLargestConfig + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) throw ReadError(path + ": expected a file of options that can be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  require(text.size() <= kLargestConfig,
          fmt::format("{}: expected a file of options (TOML), got more than {} bytes", path, kLargestConfig));
  return text;
}

/// Refuses keys of many parts, with dots between, before they are parsed: toml++ goes one level deeper for each. What
/// is in quotes is one part, whatever it holds.
/// \throw UsageError
void require_shallow_keys(std::string_view text, const std::string& path) {
  constexpr std::size_t kMostParts = 64;
  std::size_t parts = 1, line = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    line += c == '\n';
    if (c == '"' || c == '\'') {
      for (++i; i < text.size() && text[i] != c && text[i] != '\n'; ++i) i += c == '"' && text[i] == '\\';
      line += i < text.size() && text[i] == '\n';
    } else if (std::string_view("\n,=[]{}#").find(c) != std::string_view::npos) {
      parts = 1;
    } else if (c == '.' && ++parts > kMostParts) {
      throw UsageError(fmt::format("{}:{}: expected TOML: a key of at most {} parts", path, line, kMostParts));
    }
  }
}

std::string place_of(const std::string& path, const toml::source_region& source) {
  return fmt::format("{}:{}", path, source.begin.line);
}

/// A string or a number as on the command line. \throw UsageError for anything else
std::string text_of(const toml::node& node, const std::string& place) {
  if (const auto* const text = node.as_string()) {
    // Where it comes to names of files, all would end there.
    require(text->get().find('\0') == std::string::npos,
            fmt::format("{}: expected text without characters of code 0", place));
    return text->get();
  }
  if (const auto* const number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* const number = node.as_floating_point()) return fmt::format("{}", number->get());
  throw UsageError(fmt::format("{}: expected a string, a number, true, false or an array of them", place));
}

ConfigEntry entry_of(std::string_view name, const toml::node& node, const std::string& path) {
  ConfigEntry entry{.name = std::string(name), .values = {}, .place = place_of(path, node.source())};
  if (const auto* const on = node.as_boolean()) {
    entry.is_switch = true;
    entry.is_on = on->get();
  } else if (const auto* const array = node.as_array()) {
    for (const toml::node& each : *array) entry.values.push_back(text_of(each, place_of(path, each.source())));
  } else {
    entry.values.push_back(text_of(node, entry.place));
  }
  return entry;
}

}  // namespace

std::vector<ConfigEntry> read_config(const std::string& path) { return parse_config(path, read_text(path)); }

std::vector<ConfigEntry> parse_config(const std::string& path, const std::string& text) {
  require_shallow_keys(text, path);
  std::vector<ConfigEntry> entries;
  try {
    const toml::table table = toml::parse(text);
    for (const auto& [key, node] : table) {
      require(key.str().size() <= kLongestKey,
              fmt::format("{}: expected the long name of an option, got one of {} bytes", place_of(path, node.source()),
                          key.str().size()));
      entries.push_back(entry_of(key.str(), node, path));
    }
  } catch (const toml::parse_error& error) {
    throw UsageError(fmt::format("{}: expected TOML: {}", place_of(path, error.source()), error.description()));
  }
  std::sort(entries.begin(), entries.end(), [](const ConfigEntry& a, const ConfigEntry& b) { return a.name < b.name; });
  return entries;
}

}  // namespace vdb_offset::tool
