// SPDX-License-Identifier: Apache-2.0
#pragma once

// The lines of OBJ files, for all readers of them: a keyword and words behind it. `#` starts a comment, and a backslash
// at the end of a line joins it to the next one, unless it stands in a comment.

#include <cstring>
#include <string>
#include <string_view>

#include "bytes/line_records.h"
#include "bytes/scanner.h"
#include "ground/system/assert.h"

namespace vdb_offset::io {

/// A line of an OBJ file, with those that backslashes join to it.
struct ObjLine {
  const std::string& path;
  std::string_view text;     ///< The text that the line is part of.
  std::string_view whole;    ///< The line and its end.
  std::string_view keyword;  ///< Its first word; empty in blank lines and comments.
  FastCursor cursor;         ///< Behind the keyword; at a backslash, which is no plain form, if there is one before.

  /// Whether the keyword is this one. As an array its length is known to the compiler, which spares a call.
  template <std::size_t kSize>
  bool is(const char (&word)[kSize]) const {
    return keyword.size() == kSize - 1 && std::memcmp(keyword.data(), word, kSize - 1) == 0;
  }

  std::size_t begin() const { return static_cast<std::size_t>(whole.data() - text.data()); }

  /// Walks over the words behind the keyword, and says where one of them is wrong.
  Scanner words() const {
    const char* const at = keyword.empty() ? whole.data() : keyword.data() + keyword.size();
    return {path, text, static_cast<std::size_t>(at - text.data()), true, '#'};
  }
};

/// The end of a line: behind its line end, or behind that of the last line that backslashes join to it.
inline const char* obj_line_end(const char* line, const char* end) {
  const char* at = line;
  for (;;) {
    const char* const part = at;
    const auto* newline = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    if (!newline) return end;
    at = newline + 1;
    const char* last = newline != line && newline[-1] == '\r' ? newline - 1 : newline;
    if (last == line || last[-1] != '\\') return at;
    // A comment ends with its line. Each joined line is searched once, so that the cost does not grow with their
    // square.
    if (std::memchr(part, '#', static_cast<std::size_t>(newline - part))) return at;
    if (at == end) return end;
  }
}

/// Calls visit(ObjLine) for the lines of a text from byte `begin` to byte `end`, both of which are at the start of a
/// line or at the end of the text. The path is for messages; lines refer to it and to the text.
template <class Visit>
void for_each_obj_line(const std::string& path, std::string_view text, std::size_t begin, std::size_t end,
                       Visit&& visit) {
  VDB_OFFSET_ASSERT(begin <= end && end <= text.size());
  const char* const last = text.data() + end;
  for (const char* line = text.data() + begin; line != last;) {
    const char* const next = obj_line_end(line, last);
    FastCursor cursor(line, next);
    cursor.skip_blanks();
    const char* const word = cursor.position();
    // Nearly all keywords are one letter, and stand in front of a blank.
    if (next - word > 1 && word[1] == ' ' && *word > '#' && *word != '\\') cursor = FastCursor(word + 1, next);
    else cursor.skip_word();
    std::string_view keyword(word, static_cast<std::size_t>(cursor.position() - word));
    // A keyword behind a backslash, or with one in it, is left to a Scanner.
    if (FastCursor ahead = cursor; ahead.take('\\'))
      keyword = Scanner(path, text, static_cast<std::size_t>(line - text.data()), true, '#').token();
    visit(ObjLine{path, text, {line, static_cast<std::size_t>(next - line)}, keyword, cursor});
    line = next;
  }
}

/// Calls visit(ObjLine) for all lines of a text, without its byte order mark.
template <class Visit>
void for_each_obj_line(const std::string& path, std::string_view text, Visit&& visit) {
  for_each_obj_line(path, text, byte_order_mark(text), text.size(), visit);
}

/// The words of a line that have not been read, with single blanks between them.
inline std::string rest_of_line(Scanner& scanner) {
  std::string rest;
  while (!scanner.at_line_end()) {
    if (!rest.empty()) rest += ' ';
    rest += scanner.token();
  }
  return rest;
}
inline std::string rest_of_line(const ObjLine& line) {
  Scanner words = line.words();
  return rest_of_line(words);
}

}  // namespace vdb_offset::io
