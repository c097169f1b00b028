// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bytes/append_number.h"
#include "bytes/scanner.h"

// The corners of faces in OBJ files, v, v/vt, v//vn or v/vt/vn, for those who write other faces in the place of a
// file's.
namespace vdb_offset::io {

/// The number, from 1 on, of the texture coordinates that a corner v/vt.. names; 0 for none. `so_far` is the number of
/// texture coordinates that have been read.
inline std::uint64_t texture_number(std::string_view corner, std::size_t so_far) {
  const std::size_t slash = corner.find('/');
  if (slash == std::string_view::npos) return 0;
  std::int64_t number = 0;
  if (!parse_integer(corner.substr(slash + 1, corner.find('/', slash + 1) - slash - 1), number)) return 0;
  if (number < 0) number += static_cast<std::int64_t>(so_far) + 1;
  return number > 0 ? static_cast<std::uint64_t>(number) : 0;
}

/// Appends a corner behind a blank; texture coordinates and normals are 0 where it has none.
inline void append_corner(std::string& text, std::uint64_t vertex, std::uint64_t texture, std::uint64_t normal) {
  text += ' ';
  append_integer(text, vertex);
  if (texture > 0 || normal > 0) text += '/';
  if (texture > 0) append_integer(text, texture);
  if (normal == 0) return;
  text += '/';
  append_integer(text, normal);
}

}  // namespace vdb_offset::io
