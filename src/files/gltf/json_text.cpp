// SPDX-License-Identifier: Apache-2.0
#include "gltf/json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace vdb_offset::io::gltf {
namespace {

bool is_one_of(char c, std::string_view characters) { return characters.find(c) != std::string_view::npos; }

}  // namespace

std::size_t JsonText::depth() const {
  std::size_t depth = 0, most = 0;
  for (std::size_t at = 0; at < text_.size(); ++at) {
    const char c = text_[at];
    if (c == '"') at = end_of_string(at) - 1;
    else if (is_one_of(c, "[{")) most = std::max(most, ++depth);
    else if (is_one_of(c, "]}") && depth > 0) --depth;
  }
  return most;
}

std::size_t JsonText::skip_blanks(std::size_t at) const {
  while (at < text_.size() && is_one_of(text_[at], " \t\r\n")) ++at;
  return at;
}

std::size_t JsonText::end_of_string(std::size_t at) const {
  for (++at; at < text_.size() && text_[at] != '"'; ++at)
    if (text_[at] == '\\') ++at;
  return std::min(at + 1, text_.size());
}

std::size_t JsonText::end_of(std::size_t value) const {
  if (value >= text_.size()) return text_.size();
  if (text_[value] == '"') return end_of_string(value);
  if (!is_one_of(text_[value], "[{")) return std::min(text_.find_first_of(",]} \t\r\n", value), text_.size());
  std::size_t depth = 0;
  for (std::size_t at = value; at < text_.size(); ++at) {
    if (text_[at] == '"') at = end_of_string(at) - 1;
    else if (is_one_of(text_[at], "[{")) ++depth;
    else if (is_one_of(text_[at], "]}") && --depth == 0) return at + 1;
  }
  return text_.size();
}

bool JsonText::is_key(std::size_t at, std::size_t end, std::string_view key) const {
  const std::string_view quoted = text_.substr(at, end - at);
  if (quoted.find('\\') == std::string_view::npos) return quoted.substr(1, quoted.size() - 2) == key;
  return nlohmann::json::parse(quoted.begin(), quoted.end()).get_ref<const std::string&>() == key;
}

std::optional<std::size_t> JsonText::member(std::size_t object, std::string_view key) const {
  std::optional<std::size_t> found;
  for (std::size_t at = skip_blanks(object + 1); at < text_.size() && text_[at] == '"';) {
    const std::size_t end = end_of_string(at), value = skip_blanks(skip_blanks(end) + 1);  // behind the colon
    if (is_key(at, end, key)) found = value;
    at = skip_blanks(end_of(value));
    if (at < text_.size() && text_[at] == ',') at = skip_blanks(at + 1);
  }
  return found;
}

std::vector<std::size_t> JsonText::elements(std::size_t array) const {
  std::vector<std::size_t> begins;
  for (std::size_t at = skip_blanks(array + 1); at < text_.size() && text_[at] != ']';) {
    begins.push_back(at);
    at = skip_blanks(end_of(at));
    if (at < text_.size() && text_[at] == ',') at = skip_blanks(at + 1);
  }
  return begins;
}

std::string replaced(std::string_view text, const std::vector<Replacement>& replacements) {
  std::string result;
  std::size_t from = 0;
  for (const Replacement& each : replacements) {
    result += text.substr(from, each.begin - from);
    result += each.text;
    from = each.end;
  }
  result += text.substr(from);
  return result;
}

}  // namespace vdb_offset::io::gltf
