// SPDX-License-Identifier: Apache-2.0
#include "document/encode.h"

#include <algorithm>
#include <cmath>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "document/format_table.h"

namespace vdb_offset::io {

Pieces encode(Format format, const SharedContent& content) { return row_of(format).encode(format, content); }

bool is_gltf(Format format) { return format == Format::Gltf || format == Format::Glb; }
bool is_text(Format format) { return row_of(format).is_text; }
bool is_single(Format format) { return row_of(format).is_single; }
bool is_of_triangles(Format format) { return row_of(format).is_of_triangles; }
bool holds_colours(Format format) { return row_of(format).holds_colours; }
bool holds_texture(Format format) { return row_of(format).holds_texture; }
bool holds_normals(Format format) { return row_of(format).holds_texture; }
bool holds_corners(Format format) { return row_of(format).holds_corners; }

bool fits_float(double value) {
  const auto narrow = static_cast<float>(value);
  std::string digits;
  append_number(digits, value, {Rounding::Kind::Single});
  double back = 0;
  return static_cast<double>(narrow) == value || (parse_double(digits, back) && back == value);
}

bool are_bytes(const std::vector<std::array<double, 4>>& colours) {
  const auto is_byte = [](double colour) { return std::abs(colour - colour_byte(colour) / 255.0) <= 0.0005; };
  return std::all_of(colours.begin(), colours.end(),
                     [&](const auto& colour) { return std::all_of(colour.begin(), colour.end(), is_byte); });
}

std::uint8_t colour_byte(double colour) { return static_cast<std::uint8_t>(std::lround(colour * 255)); }

}  // namespace vdb_offset::io
