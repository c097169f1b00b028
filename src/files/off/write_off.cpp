// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "document/append_values.h"
#include "document/format_readers.h"

namespace vdb_offset::io {
namespace {

void append_off_vertex(std::string& text, const Content& content, std::size_t v) {
  const Attributes& with = content.with;
  append_point(text, content.mesh.positions[v], content.precision);
  if (!with.normals.empty()) append_values(text, with.normals.value[v]);
  for (std::size_t k = 0; !with.colours.empty() && k < 4; ++k) {
    text += ' ';
    append_integer(text, colour_byte(with.colours[v][k]));
  }
  if (!with.texture.empty()) append_values(text, with.texture.value[v]);
  text += '\n';
}

}  // namespace

Pieces to_off(const SharedContent& content) {
  const PolygonView& mesh = content->mesh;
  const Attributes& with = content->with;
  const auto append_face = [content](std::string& text, std::size_t f) {
    const auto face = content->mesh.face(f);
    append_integer(text, face.size());
    for (const auto v : face) {
      text += ' ';
      append_integer(text, v);
    }
    text += '\n';
  };
  return in_sections(
      fmt::format("{}{}{}OFF\n{} {} 0\n", with.texture.empty() ? "" : "ST", with.colours.empty() ? "" : "C",
                  with.normals.empty() ? "" : "N", mesh.positions.size(), mesh.face_count()),
      {{mesh.positions.size(), [content](std::string& text, std::size_t v) { append_off_vertex(text, *content, v); }},
       {mesh.face_count(), append_face}});
}

}  // namespace vdb_offset::io
