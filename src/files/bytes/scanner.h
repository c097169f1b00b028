// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// Walks over the text of a mesh file, token by token, and throws errors that say where something is wrong.
class Scanner {
 public:
  /// `continues`: a backslash at the end of a line joins it to the next one (OBJ).
  /// `comment`: the character that starts a comment, which counts as the end of its line; 0 for none.
  Scanner(const std::string& path, std::string_view text, std::size_t at = 0, bool continues = false, char comment = 0)
      : path_(&path), text_(text), at_(at), continues_(continues), comment_(comment) {}

  /// Has lines end with this character alone: a carriage return, where no line feed follows it.
  void end_lines_with(char line_end) { line_end_ = line_end; }

  std::size_t position() const { return at_; }
  std::size_t remaining() const { return text_.size() - at_; }
  bool at_end() const { return at_ >= text_.size(); }

  /// Skips blanks; true if nothing but the end of the line (or text) follows.
  bool at_line_end();
  /// Goes to the start of the next line.
  void next_line();
  /// Skips blanks, line ends and comments; true if there is no token left.
  bool at_text_end();

  /// The next token of this line; empty at its end.
  std::string_view token();
  /// The first five letters of the first token wherever it stands; empty at the end of the text.
  std::string_view first_word() { return at_text_end() ? std::string_view() : token().substr(0, 5); }
  /// The next token wherever it stands. \throw InvalidInput at the end of the text.
  std::string_view token_anywhere(const char* expected);

  /// A finite number that is the whole next token of this line, of no more than kLongestNumber characters. `at`
  /// receives its first byte.
  double number(const char* expected, std::uint64_t* at = nullptr);
  /// Skips three tokens of this line without reading numbers: normals, which are replaced and never used.
  void skip_triple(const char* expected, NumberTriple& at);
  std::int64_t integer(const char* expected);
  /// An integer, which may stand on a later line. \throw InvalidInput as integer()
  std::int64_t integer_anywhere(const char* expected);
  Vec3d triple(const char* expected, NumberTriple& at);

  /// First byte of the token that was taken last.
  std::size_t last_token() const { return last_token_; }

  /// \throw InvalidInput `path, line N: expected ..., got ...` about the token at `at`, or about `found`.
  [[noreturn]] void fail_with(const std::string& expected, const std::string& found, std::size_t at) const;
  [[noreturn]] void fail(const std::string& expected, std::size_t at) const;
  [[noreturn]] void fail(const std::string& expected) const { fail(expected, at_); }

 private:
  bool is_break(std::size_t at) const;
  bool is_blank_at(std::size_t at) const;
  std::size_t continuation_length(std::size_t at) const;
  void skip_blanks();

  const std::string* path_;
  std::string_view text_;
  std::size_t at_;
  std::size_t last_token_ = 0;
  bool continues_;
  char comment_;
  char line_end_ = '\n';
};

/// A token, or so many characters of it, as a message can show it: short, and without control bytes.
std::string in_short(std::string_view token, std::size_t most = 24);

/// Bytes that a UTF-8 byte order mark takes at the start of a text: 3 or 0.
inline std::size_t byte_order_mark(std::string_view text) { return text.starts_with("\xef\xbb\xbf") ? 3 : 0; }

/// True if `text` is `word` in any case; `word` is lower case.
bool is_word(std::string_view text, std::string_view word);

/// Parses a whole token as a number, which may be an infinity or a NaN; false if it is none, or too long to be one.
bool parse_double(std::string_view token, double& value);

/// The number that a whole token stands for; NaN if it is no number.
double number_or_nan(std::string_view token);

/// Parses a whole token as an integer; false if it is none or does not fit.
bool parse_integer(std::string_view token, std::int64_t& value);

}  // namespace vdb_offset::io
