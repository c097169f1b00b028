// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/hosts.h"

#include <algorithm>
#include <cstddef>

namespace vdb_offset::tool {
namespace {

constexpr std::string_view kDigits = "0123456789", kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr std::size_t kMostPortDigits = 5;  // of a port, or of models at once on one machine

/// Above 0.
bool is_number(std::string_view text) {
  return !text.empty() && text.size() <= kMostPortDigits && text.find_first_not_of(kDigits) == std::string_view::npos &&
         text.find_first_not_of('0') != std::string_view::npos;
}

/// Letters, digits, and behind the first of them '.', '-' and '_'.
bool is_name(std::string_view text) {
  const auto is_in = [](std::string_view set, char c) { return set.find(c) != std::string_view::npos; };
  if (text.empty() || !(is_in(kLetters, text[0]) || is_in(kDigits, text[0]))) return false;
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_in(kLetters, c) || is_in(kDigits, c) || is_in(".-_", c); });
}

bool is_host(std::string_view text) {
  if (const std::size_t slash = text.find('/'); slash != std::string_view::npos) {
    if (!is_number(text.substr(0, slash))) return false;
    text.remove_prefix(slash + 1);
  }
  if (text == ":") return true;
  if (const std::size_t at = text.find('@'); at != std::string_view::npos) {
    if (!is_name(text.substr(0, at))) return false;
    text.remove_prefix(at + 1);
  }
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    if (!is_number(text.substr(colon + 1))) return false;
    text = text.substr(0, colon);
  }
  return is_name(text);
}

template <class IsOne>
bool all_between_commas(std::string_view list, IsOne&& is_one) {
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (!is_one(list.substr(begin, end - begin))) return false;
    if (end == list.size()) return true;
    begin = end + 1;
  }
}

}  // namespace

bool are_hosts(std::string_view list) { return all_between_commas(list, is_host); }
bool are_partitions(std::string_view list) { return all_between_commas(list, is_name); }

}  // namespace vdb_offset::tool
