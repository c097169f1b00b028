// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "document/append_values.h"
#include "document/format_readers.h"

namespace vdb_offset::io {
namespace {

/// How PLY stores the texture coordinates of corners.
struct TextureLists {
  bool exist, single, wide;

  explicit TextureLists(const Content& content)
      : exist(!content.with.texture.of_corner.empty()), single(content.with.texture.single), wide(false) {
    if (!exist) return;
    const auto& value = content.with.texture.value;
    // Most programs expect floats, so that doubles are written only where floats would lose digits.
    single = single || std::all_of(value.begin(), value.end(),
                                   [](const Vec2d& uv) { return fits_float(uv[0]) && fits_float(uv[1]); });
    for (std::size_t f = 0; f < content.mesh.face_count(); ++f) wide = wide || 2 * content.mesh.face(f).size() > 255;
  }

  void append(std::string& bytes, const Content& content, std::size_t f) const {
    const auto& texture = content.with.texture;
    const auto first = texture.of_corner.begin() + content.mesh.face_begin[f],
               last = texture.of_corner.begin() + content.mesh.face_begin[f + 1];
    const std::size_t length =
        std::find(first, last, kNoNormal) == last ? 2 * static_cast<std::size_t>(last - first) : 0;
    if (wide) append_binary(bytes, static_cast<std::uint32_t>(length));
    else append_binary(bytes, static_cast<std::uint8_t>(length));
    for (auto t = first; length > 0 && t != last; ++t) append_values(bytes, texture.value[*t], single);
  }
};

bool has_byte_parts(const Content& content) { return content.parts.size() <= 256; }

std::string ply_header(const Content& content, const TextureLists& lists) {
  const auto& [mesh, precision, with, parts, materials, unit, triangles] = content;
  std::string header = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.size());
  const auto add = [&](const char* type, std::initializer_list<const char*> names) {
    for (const char* name : names) header += fmt::format("property {} {}\n", type, name);
  };
  const auto floating = [](bool single) { return single ? "float" : "double"; };
  add("double", {"x", "y", "z"});
  if (!with.normals.empty()) add(floating(with.normals.single), {"nx", "ny", "nz"});
  if (!with.colours.empty()) add("uchar", {"red", "green", "blue"});
  if (with.has_alpha) add("uchar", {"alpha"});
  if (!with.texture.empty() && !lists.exist) add(floating(with.texture.single), {"s", "t"});
  header += fmt::format("element face {}\nproperty list uint uint vertex_indices\n", mesh.face_count());
  if (lists.exist)
    header += fmt::format("property list {} {} texcoord\n", lists.wide ? "uint" : "uchar", floating(lists.single));
  if (!parts.empty()) add(has_byte_parts(content) ? "uchar" : "uint", {"part"});
  return header + "end_header\n";
}

/// Appends the part that a face is of, in a byte where that holds them all.
void append_part(std::string& bytes, const Content& content, std::span<const std::size_t> part_ends, std::size_t f) {
  const auto part = std::upper_bound(part_ends.begin(), part_ends.end(), f) - part_ends.begin();
  if (has_byte_parts(content)) append_binary(bytes, static_cast<std::uint8_t>(part));
  else append_binary(bytes, static_cast<std::uint32_t>(part));
}

}  // namespace

Pieces to_ply(const SharedContent& content) {
  const TextureLists lists(*content);
  std::vector<std::size_t> part_ends;
  for (const Part& part : content->parts) part_ends.push_back(part.faces + (part_ends.empty() ? 0 : part_ends.back()));
  const auto append_vertex = [=](std::string& bytes, std::size_t v) {
    const auto& with = content->with;
    append_values(bytes, content->mesh.positions[v], false);
    if (!with.normals.empty()) append_values(bytes, with.normals.value[v], with.normals.single);
    for (std::size_t k = 0; !with.colours.empty() && k < (with.has_alpha ? 4 : 3); ++k)
      append_binary(bytes, colour_byte(with.colours[v][k]));
    if (!with.texture.empty() && !lists.exist) append_values(bytes, with.texture.value[v], with.texture.single);
  };
  const auto append_face = [=](std::string& bytes, std::size_t f) {
    const auto face = content->mesh.face(f);
    append_binary(bytes, static_cast<std::uint32_t>(face.size()));
    for (const auto v : face) append_binary(bytes, v);
    if (lists.exist) lists.append(bytes, *content, f);
    if (!content->parts.empty()) append_part(bytes, *content, part_ends, f);
  };
  return in_sections(ply_header(*content, lists),
                     {{content->mesh.positions.size(), append_vertex}, {content->mesh.face_count(), append_face}});
}

}  // namespace vdb_offset::io
