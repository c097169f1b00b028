// SPDX-License-Identifier: Apache-2.0
#include "off/off_document.h"

#include "document/columns.h"
#include "off/off_binary.h"

namespace vdb_offset::io {
namespace {

/// The value of white: 255 or 1, as some programs write colours as 0 .. 255 and some as 0 .. 1.
double white_of(const Columns& columns, std::size_t width) {
  for (std::size_t i = 0; i < columns.number.size(); ++i)
    if (i % columns.width < width && columns.number[i] > 1) return 255;
  return 1;
}

/// Whether any face's line goes on behind its corners: with a colour.
bool has_face_colours(const MeshFile& source) {
  const PolygonView mesh = source.polygons.view();
  Scanner scanner = scanner_at(source, rows_of(source).position_at[rows_of(source).position_at.size() - 1].at[2]);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    scanner.next_line();
    scanner.at_text_end();
    for (std::size_t word = 0; word <= mesh.face(f).size(); ++word) scanner.token();
    if (!scanner.at_line_end()) return true;
  }
  return false;
}

constexpr const char *kOffColours = "vertex colours", *kOffTexture = "texture coordinates";

/// Reads colours, of four numbers, and texture coordinates of a binary file.
void read_binary_off(const MeshFile& source, Attributes& attributes) {
  const off::Layout layout = off::layout_of(source);
  const auto columns_of = [&](std::size_t first, std::size_t width) {
    Columns columns{width, {}};
    for (std::size_t v = 0; v < rows_of(source).position_at.size(); ++v)
      for (std::size_t k = 0; k < width; ++k)
        columns.number.push_back(off::number_at(source, rows_of(source).position_at[v].at[0] + 4 * (first + k)));
    return columns;
  };
  if (layout.colour && take_colours(columns_of(layout.colour, 4), 4, 1, attributes)) is_kept(attributes, kOffColours);
  if (layout.texture && take_texture(columns_of(layout.texture, 2), 0, attributes)) is_kept(attributes, kOffTexture);
  const std::uint64_t counts = source.polygons.corners.size() + 2 * source.polygons.face_count();
  const std::vector<std::uint64_t> offsets = off::face_offsets(source);
  if (offsets.back() - offsets.front() > 4 * counts) attributes.lost.emplace_back("face colours");
}

}  // namespace

void OffRows::read_attributes(const MeshFile& source, Attributes& attributes) const {
  read_normals_of_rows(source, attributes);
  if (source.encoding != Encoding::Ascii) return read_binary_off(source, attributes);
  constexpr const char *kColours = kOffColours, *kTexture = kOffTexture;
  if (has_face_colours(source)) attributes.lost.emplace_back("face colours");
  const auto tails = read_tails(source, normal_at.empty() ? position_at : normal_at);
  const std::size_t textures = has_extra(source, kTexture) ? 2 : 0;
  const bool has_colours = has_extra(source, kColours);
  if (!tails || tails->width < textures || (!has_colours && tails->width > textures)) {
    if (!has_colours && textures == 0) attributes.lost.emplace_back("numbers behind the coordinates");
    return;
  }
  const std::size_t width = tails->width - textures;
  if (has_colours && take_colours(*tails, width, white_of(*tails, width), attributes)) is_kept(attributes, kColours);
  if (textures > 0 && take_texture(*tails, width, attributes)) is_kept(attributes, kTexture);
}

}  // namespace vdb_offset::io
