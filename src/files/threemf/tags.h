// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// Tags of XML where they stand in a text whose form expat has checked, for those who write some of them anew.
namespace vdb_offset::io {

inline bool is_xml_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The name of the element whose tag begins at a byte, with its prefix.
inline std::string_view tag_name(std::string_view text, std::size_t at) {
  return text.substr(at + 1, text.find_first_of(" \t\n\r/>", at) - at - 1);
}

/// Calls visit(name, value) for the attributes of the tag that begins at a byte; returns where its last `>` or `/>` is.
template <class Visit>
std::size_t for_each_attribute(std::string_view text, std::size_t at, Visit&& visit) {
  at += 1 + tag_name(text, at).size();
  for (;;) {
    while (is_xml_space(text[at])) ++at;
    if (text[at] == '>' || text[at] == '/') return at;
    const std::size_t name = at;
    while (text[at] != '=' && !is_xml_space(text[at])) ++at;
    const std::string_view word = text.substr(name, at - name);
    while (text[at] != '"' && text[at] != '\'') ++at;
    const std::size_t value = at + 1, end = text.find(text[at], value);
    at = end + 1;
    visit(word, text.substr(value, end - value));
  }
}

/// Appends the tag that begins at a byte, up to its last `>` or `/>`, which is returned. visit(name, value) appends
/// another value to the text, and returns true, where there is one.
template <class Replace>
std::size_t append_tag(std::string& to, std::string_view text, std::size_t at, Replace&& replace) {
  std::size_t copied = at;
  const std::size_t stop = for_each_attribute(text, at, [&](std::string_view name, std::string_view value) {
    const auto begin = static_cast<std::size_t>(value.data() - text.data());
    std::string other;
    if (!replace(name, value, other)) return;
    (to += text.substr(copied, begin - copied)) += other;
    copied = begin + value.size();
  });
  to += text.substr(copied, stop - copied);
  return stop;
}

/// Behind the tag that begins at a byte.
inline std::size_t tag_end(std::string_view text, std::size_t at) {
  return text.find('>', for_each_attribute(text, at, [](auto, auto) {})) + 1;
}

/// Behind the element whose tag begins at a byte, which holds no other of its name.
inline std::size_t element_end(std::string_view text, std::size_t at) {
  const std::size_t end = tag_end(text, at);
  if (text[end - 2] == '/') return end;
  return text.find('>', text.find("</" + std::string(tag_name(text, at)), end)) + 1;
}

/// The blanks and line ends in front of a byte.
inline std::string_view space_before(std::string_view text, std::size_t at) {
  std::size_t begin = at;
  while (begin > 0 && is_xml_space(text[begin - 1])) --begin;
  return text.substr(begin, at - begin);
}

}  // namespace vdb_offset::io
