// SPDX-License-Identifier: Apache-2.0
// Walks over the text of a file token by token, for all readers of texts. A line ends at a line feed, or at another
// character that a format asks for; a comment counts as the end of its line; a backslash at the end of a line joins it
// to the next one where the format has that, but not in a comment. Tokens are views of the text, which is never copied.
// A number is a whole token, with a plus sign allowed; one that is too long, or not finite where that is asked, is
// refused. Messages name the file, the line, what was expected and what was found, cut short and without control bytes.
// Lines are counted only when a message needs it. What tokens mean is up to the readers.
#include "bytes/scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "bytes/line_records.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// Skips a plus sign, which from_chars() does not accept. Returns false if another sign follows.
bool skip_plus(const char*& first, const char* last) {
  if (first == last || *first != '+') return true;
  ++first;
  return first != last && *first != '-';
}

}  // namespace

std::string in_short(std::string_view token, std::size_t most) {
  std::string text;
  for (const char c : token.substr(0, most)) text += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  return token.size() > most ? text + "..." : text;
}

bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

bool parse_double(std::string_view token, double& value) {
  const char* first = token.data();
  const char* last = first + token.size();
  if (token.size() > kLongestNumber || !skip_plus(first, last)) return false;
  const auto [end, error] = std::from_chars(first, last, value);
  if (end != last || first == last) return false;
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(first, last).c_str(), nullptr);
  return error != std::errc::invalid_argument;
}

double number_or_nan(std::string_view token) {
  double value = 0;
  return parse_double(token, value) ? value : std::numeric_limits<double>::quiet_NaN();
}

bool parse_integer(std::string_view token, std::int64_t& value) {
  const char* first = token.data();
  const char* last = first + token.size();
  if (!skip_plus(first, last)) return false;
  const auto [end, error] = std::from_chars(first, last, value);
  return error == std::errc() && end == last && first != last;
}

bool Scanner::is_break(std::size_t at) const {
  return at >= text_.size() || text_[at] == line_end_ || (comment_ && text_[at] == comment_);
}

bool Scanner::is_blank_at(std::size_t at) const { return is_blank(text_[at]) && text_[at] != line_end_; }

std::size_t Scanner::continuation_length(std::size_t at) const {
  if (!continues_ || text_[at] != '\\') return 0;
  if (at + 1 < text_.size() && text_[at + 1] == '\n') return 2;
  if (at + 2 < text_.size() && text_[at + 1] == '\r' && text_[at + 2] == '\n') return 3;
  return 0;
}

void Scanner::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank_at(at_)) ++at_;
    else if (const std::size_t length = continuation_length(at_)) at_ += length;
    else return;
  }
}

bool Scanner::at_line_end() {
  skip_blanks();
  return is_break(at_);
}

void Scanner::next_line() {
  for (bool goes_on = true; goes_on;) {
    const std::size_t begin = at_, end = std::min(text_.find(line_end_, begin), text_.size());
    at_ = std::min(end + 1, text_.size());
    std::size_t last = end;  // the end of the line, without the carriage return of a line break of two bytes
    if (last > begin && text_[last - 1] == '\r') --last;
    goes_on = last > begin && continuation_length(last - 1) > 0;
    // A comment ends with its line: a backslash at its end joins nothing.
    if (goes_on && comment_) goes_on = text_.substr(begin, end - begin).find(comment_) == std::string_view::npos;
  }
}

bool Scanner::at_text_end() {
  while (at_line_end()) {
    if (at_ >= text_.size()) return true;
    next_line();
  }
  return false;
}

std::string_view Scanner::token() {
  if (at_line_end()) return {};
  const std::size_t begin = last_token_ = at_;
  while (!is_break(at_) && !is_blank_at(at_) && !continuation_length(at_)) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view Scanner::token_anywhere(const char* expected) {
  if (at_text_end()) fail(expected);
  return token();
}

double Scanner::number(const char* expected, std::uint64_t* at) {
  const std::string_view text = token();
  const std::size_t begin = at_ - text.size();
  double value = 0;
  if (text.size() > kLongestNumber)
    fail_with(fmt::format("{} of at most {} characters", expected, kLongestNumber),
              fmt::format("'{}' of {}", in_short(text), text.size()), begin);
  if (text.empty() || !parse_double(text, value)) fail(expected, begin);
  if (!std::isfinite(value)) fail(std::string(expected) + " that is finite", begin);
  if (at) *at = begin;
  return value;
}

std::int64_t Scanner::integer(const char* expected) {
  const std::string_view text = token();
  std::int64_t value = 0;
  if (!parse_integer(text, value)) fail(expected, at_ - text.size());
  return value;
}

std::int64_t Scanner::integer_anywhere(const char* expected) {
  if (at_text_end()) fail(expected);
  return integer(expected);
}

Vec3d Scanner::triple(const char* expected, NumberTriple& at) {
  Vec3d value;
  for (int k = 0; k < 3; ++k) value[k] = number(expected, &at.at[k]);
  return value;
}

void Scanner::skip_triple(const char* expected, NumberTriple& at) {
  for (auto& byte : at.at) {
    if (token().empty()) fail(expected);
    byte = last_token_;
  }
}

void Scanner::fail(const std::string& expected, std::size_t at) const {
  at = std::min(at, text_.size());
  std::size_t end = at;
  while (!is_break(end) && !is_blank_at(end)) ++end;
  fail_with(expected,
            at >= text_.size() ? "the end of the file"
            : end == at        ? "the end of the line"
                               : fmt::format("'{}'", in_short(text_.substr(at, end - at))),
            at);
}

void Scanner::fail_with(const std::string& expected, const std::string& found, std::size_t at) const {
  const std::string_view before = text_.substr(0, std::min(at, text_.size()));
  std::size_t line = 1;
  for (std::size_t i = 0; i < before.size(); ++i)
    line += before[i] == '\n' || (before[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n'));
  throw InvalidInput(fmt::format("{}, line {}: expected {}, got {}", *path_, line, expected, found));
}

}  // namespace vdb_offset::io
