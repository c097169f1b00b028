// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "ground/numbers/rounding.h"

namespace vdb_offset::io {

inline void append_point(std::string& text, const Vec3d& p, const Rounding& precision) {
  for (int k = 0; k < 3; ++k) {
    if (k > 0) text += ' ';
    append_number(text, p[k], precision);
  }
}

/// Appends the numbers of a point, each after a blank, with the digits of the type that they are stored in.
template <class Point>
void append_values(std::string& text, const Point& p) {
  for (int k = 0; k < Point::size; ++k) {
    const bool single = static_cast<double>(static_cast<float>(p[k])) == p[k];
    text += ' ';
    append_number(text, p[k], {single ? Rounding::Kind::Single : Rounding::Kind::Double});
  }
}

template <class Point>
void append_values(std::string& bytes, const Point& p, bool single) {
  for (int k = 0; k < Point::size; ++k)
    if (single) append_binary(bytes, static_cast<float>(p[k]));
    else append_binary(bytes, p[k]);
}

}  // namespace vdb_offset::io
