// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace vdb_offset::tool {

/// A text of at most so many bytes: what is longer loses its middle, never a part of a character.
std::string shortened(std::string_view text, std::size_t most);

/// What a noun ends in where there are so many.
constexpr const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

/// Bytes as text on one line: those that are no text, and control characters, as `\xff`.
std::string as_text(std::string_view bytes);

/// A message as a terminal can show it, whatever names and values are in it: on one line, bytes that are no text as
/// `\xff`, words and the whole of a length that can be read.
std::string readable(std::string_view message);

/// A word as a shell takes it, in quotes where it has other characters than names and numbers.
std::string shell_word(std::string_view word);

/// Prints `vdb_offset: MESSAGE` on standard error. If that is closed or full, the message is lost.
void report_problem(std::string_view message) noexcept;

/// A text for the user, kept until it is complete, then printed on standard output or, if that is taken, on standard
/// error. require_printed() finds out whether that failed.
class Printout {
 public:
  explicit Printout(bool output_is_taken = false);
  ~Printout();
  Printout(const Printout&) = delete;
  Printout& operator=(const Printout&) = delete;
  operator std::FILE*() const { return lines_; }

 private:
  bool on_error_;
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* lines_;
};

/// \throw WriteError if anything that was printed on standard output did not get there
void require_printed();

}  // namespace vdb_offset::tool
