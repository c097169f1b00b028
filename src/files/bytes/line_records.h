// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "ground/system/assert.h"

namespace vdb_offset::io {

/// Whether a character separates words within a line.
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// How the lines of a text end, by the first one: with a line feed, or a carriage return and a line feed.
inline std::string_view line_end_of(std::string_view text) {
  const std::size_t newline = text.find('\n');
  return newline != std::string_view::npos && newline > 0 && text[newline - 1] == '\r' ? "\r\n" : "\n";
}

/// Longest word, in bytes, that is read as a number. No program writes longer ones: the largest double, written out,
/// has 309 digits.
inline constexpr std::size_t kLongestNumber = 330;

/// Cuts a text into runs of whole lines of about half a MiB: boundaries from `begin` to its end. A line that a
/// backslash joins to the next one is not cut.
std::vector<std::size_t> cut_at_lines(std::string_view text, std::size_t begin);

/// A fast path: reads the plain forms that nearly all lines have. Anything else, mistakes included, is left to a
/// Scanner.
class FastCursor {
 public:
  FastCursor(const char* at, const char* end) : at_(at), end_(end) {}

  const char* position() const { return at_; }

  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }
  /// Skips blanks. Returns whether the end of the line or of the text follows.
  bool at_line_end() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n';
  }
  /// Whether a word ends here. Characters that may start a comment or join lines end it, too: such lines are then left
  /// to a Scanner.
  bool at_word_end() const { return at_ == end_ || *at_ == '\n' || is_blank(*at_) || *at_ == '#' || *at_ == '\\'; }
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  /// Reads a finite number that is a whole word.
  bool number(double& value) {
    skip_blanks();
    const auto [after, error] = std::from_chars(at_, end_, value);
    if (error != std::errc() || !std::isfinite(value) || static_cast<std::size_t>(after - at_) > kLongestNumber)
      return false;
    at_ = after;
    return at_word_end();
  }
  /// Reads an integer of up to nine digits.
  bool digits(std::uint32_t& value) {
    const char* const begin = at_;
    value = 0;
    for (; at_ != end_ && static_cast<unsigned char>(*at_ - '0') < 10; ++at_)
      value = value * 10 + static_cast<std::uint32_t>(*at_ - '0');
    return at_ != begin && at_ - begin < 10;
  }
  void skip_line() {
    const void* const newline = std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
    at_ = newline ? static_cast<const char*>(newline) : end_;
  }
  bool skip_word() {
    skip_blanks();
    const char* const begin = at_;
    while (!at_word_end()) ++at_;
    return at_ != begin;
  }

 private:
  const char *at_, *end_;
};

/// Records of a text that fill a line each.
class LineRecords {
 public:
  /// Finds the `count` lines from `begin` on. If there are fewer, records do not fill a line each: see complete().
  LineRecords(std::string_view text, std::size_t begin, std::size_t count);

  bool complete() const { return first_.back() >= count_; }
  /// First byte behind the last record's line. \pre complete()
  std::size_t end() const {
    VDB_OFFSET_ASSERT(complete());
    return cuts_.back();
  }

  /// Calls read(i, cursor) in parallel for every record i, with a FastCursor at its start. Returns
  /// false if read() did, or did not stop at the end of the line; then not all records need have been read.
  template <class Read>
  bool for_each(Read&& read) const;

 private:
  std::string_view text_;
  std::size_t count_;
  std::vector<std::size_t> cuts_, first_;  // of each run of lines: where it starts, and its first record
};

template <class Read>
bool LineRecords::for_each(Read&& read) const {
  std::atomic<bool> plain = true;
  tbb::parallel_for(std::size_t{0}, cuts_.size() - 1, [&](std::size_t run) {
    const char* const end = text_.data() + cuts_[run + 1];
    FastCursor cursor(text_.data() + cuts_[run], end);
    for (std::size_t i = first_[run]; i < first_[run + 1]; ++i) {
      if (!plain.load(std::memory_order_relaxed)) return;
      if (!read(i, cursor) || !cursor.at_line_end()) plain = false;
      cursor.take('\n');
    }
  });
  return plain;
}

}  // namespace vdb_offset::io
