// SPDX-License-Identifier: Apache-2.0
#include "bytes/nearest_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace vdb_offset::io {
namespace {

// kHandful: names in a message that are most similar to a wanted one. kFew: the longest list that is shown whole.
constexpr std::size_t kHandful = 5, kFew = 12;
// Bytes of a name that are compared and shown, and of all names in a message together: messages are to fit into a line
// or two.
constexpr std::size_t kLongestShown = 48;
constexpr std::size_t kLongestPhrase = 160;

/// The number of letters to insert, remove or replace to make one word of the other (Levenshtein), regardless of case.
std::size_t edits(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t across = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = across + (lower(a[i]) != lower(b[j]));
      across = std::exchange(row[j + 1], std::min({changed, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

std::string shown(std::string_view name, std::size_t longest) {
  std::string text(name.substr(0, longest));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); }, '?');
  return name.size() > longest ? text + "..." : text;
}

}  // namespace

std::string nearest_names(std::string_view wanted, const std::vector<std::string>& known) {
  std::vector<std::pair<std::size_t, std::size_t>> by_edits(known.size());
  for (std::size_t i = 0; i < known.size(); ++i)
    by_edits[i] = {edits(wanted.substr(0, kLongestShown), std::string_view(known[i]).substr(0, kLongestShown)), i};
  const std::size_t count = std::min(known.size(), kHandful);
  std::partial_sort(by_edits.begin(), by_edits.begin() + static_cast<std::ptrdiff_t>(count), by_edits.end());
  if (known.size() <= kHandful)
    std::sort(by_edits.begin(), by_edits.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + shown(known[by_edits[i].second], kLongestShown);
  return known.size() <= kHandful ? text : fmt::format("{} and {} more", text, known.size() - count);
}

std::string first_names(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kFew); ++i)
    text += (i > 0 ? ", " : "") + shown(names[i], kLongestPhrase);
  return names.size() <= kFew ? text : fmt::format("{} and {} more", text, names.size() - kFew);
}

}  // namespace vdb_offset::io
