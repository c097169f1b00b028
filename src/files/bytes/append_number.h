// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

#include "ground/numbers/rounding.h"

namespace vdb_offset::io {

/// Appends a number, with the digits that the precision asks for or, by default, the fewest that read back to the same
/// number of its type.
inline void append_number(std::string& text, double value, const Rounding& precision = {}) {
  char digits[40];
  char* const first = std::begin(digits);
  char* const last = std::end(digits);
  const auto result = precision.kind == Rounding::Kind::Double ? std::to_chars(first, last, value)
                      : precision.kind == Rounding::Kind::Single
                          ? std::to_chars(first, last, static_cast<float>(value))
                          : std::to_chars(first, last, value, std::chars_format::general, precision.digits);
  text.append(first, result.ptr);
}

inline void append_integer(std::string& text, std::uint64_t value) {
  char digits[24];
  text.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
}

/// Appends a line, with a line end if it has none.
inline void append_line(std::string& text, std::string_view line) {
  text += line;
  if (!line.ends_with('\n')) text += '\n';
}

/// Appends the bytes of a number as this machine holds it: little-endian.
template <class T>
void append_binary(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

}  // namespace vdb_offset::io
