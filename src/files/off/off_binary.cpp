// SPDX-License-Identifier: Apache-2.0
#include "off/off_binary.h"

#include <algorithm>
#include <cstring>

#include "bytes/scanner.h"
#include "document/binary_number.h"

namespace vdb_offset::io::off {
Layout layout_of(const MeshFile& file) {
  const auto holds = [&](const char* what) {
    return std::find(file.extras.begin(), file.extras.end(), what) != file.extras.end();
  };
  Layout layout;
  const auto take = [&](const char* what, std::size_t& offset, std::size_t width) {
    if (!holds(what)) return;
    offset = layout.width;
    layout.width += width;
  };
  take("normals", layout.normal, 3);
  take("vertex colours", layout.colour, 4);
  take("texture coordinates", layout.texture, 2);
  return layout;
}

std::optional<std::size_t> binary_begin(const MeshFile& file) {
  const std::string_view text = file.text();
  constexpr std::size_t kLongestLine = 80;  // bytes; the longest first line, "STCN4OFF BINARY", has 15
  const std::size_t end = text.substr(0, kLongestLine).find_first_of("\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  Scanner words(file.path, text.substr(0, end));
  words.token();
  if (!is_word(words.token(), "binary") || !words.at_line_end()) return std::nullopt;
  return end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
}

double number_at(const MeshFile& file, std::uint64_t at) {
  return binary_number(file.text().data() + at, {'f', 4}, Encoding::BigEndian);
}

std::int64_t integer_at(const MeshFile& file, std::uint64_t at) {
  return static_cast<std::int64_t>(binary_number(file.text().data() + at, {'i', 4}, Encoding::BigEndian));
}

std::vector<std::uint64_t> face_offsets(const MeshFile& file) {
  const std::size_t vertices = file.polygons.positions.size();
  std::vector<std::uint64_t> offsets{*binary_begin(file) + 12 + 4 * layout_of(file).width * vertices};
  for (std::size_t f = 0; f < file.polygons.face_count(); ++f) {
    const std::uint64_t colours = offsets.back() + 4 * (1 + file.polygons.view().face(f).size());
    offsets.push_back(colours + 4 * (1 + static_cast<std::uint64_t>(integer_at(file, colours))));
  }
  return offsets;
}

}  // namespace vdb_offset::io::off
