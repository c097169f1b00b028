// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "document/append_values.h"
#include "document/format_readers.h"

namespace vdb_offset::io {
namespace {

/// A name as a line of OBJ can hold it: other formats' names may end the line, go on in the next one, or begin a
/// comment.
std::string obj_name(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
    if (c == '#') c = '_';
  }
  while (name.ends_with('\\') || name.ends_with(' ')) name.pop_back();
  name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
  return name;
}

/// Appends a `usemtl` line if the face's material differs from that of the face before.
void append_material(std::string& text, const Materials& materials, std::size_t f) {
  if (materials.of_face.empty()) return;
  const std::uint32_t material = materials.of_face[f], before = f > 0 ? materials.of_face[f - 1] : kNoNormal;
  if (material == before) return;
  if (const std::string name = obj_name(materials.names[material]); !name.empty()) text += "usemtl " + name + "\n";
  // A material holds until another one follows: this is the name for none.
  else if (f > 0) text += "usemtl none\n";
}

void append_obj_face(std::string& text, const Content& content, std::size_t f) {
  const PolygonView& mesh = content.mesh;
  const Attributes& with = content.with;
  const auto face = mesh.face(f);
  append_material(text, content.materials, f);
  text += 'f';
  for (std::size_t k = 0; k < face.size(); ++k) {
    const std::size_t corner = mesh.face_begin[f] + k;
    const std::uint64_t texture = with.texture.empty() ? kNoNormal : with.texture.index(corner, face[k]);
    text += ' ';
    append_integer(text, std::uint64_t{face[k]} + 1);
    const std::uint64_t normal = with.normals.empty() ? kNoNormal : with.normals.index(corner, face[k]);
    if (texture != kNoNormal || normal != kNoNormal) text += '/';
    if (texture != kNoNormal) append_integer(text, texture + 1);
    if (normal == kNoNormal) continue;
    text += '/';
    append_integer(text, normal + 1);
  }
  text += '\n';
}

}  // namespace

Pieces to_obj(const SharedContent& content) {
  const auto append_vertex = [content](std::string& text, std::size_t v) {
    const Attributes& with = content->with;
    text += "v ";
    append_point(text, content->mesh.positions[v], content->precision);
    for (std::size_t k = 0; !with.colours.empty() && k < (with.has_alpha ? 4 : 3); ++k) {
      text += ' ';
      append_number(text, with.colours[v][k], {Rounding::Kind::Single});
    }
    text += '\n';
  };
  const auto append_texture = [content](std::string& text, std::size_t i) {
    text += "vt";
    append_values(text, content->with.texture.value[i]);
    text += '\n';
  };
  const auto append_normal = [content](std::string& text, std::size_t i) {
    text += "vn";
    append_values(text, content->with.normals.value[i]);
    text += '\n';
  };
  std::vector<Section> sections = {{content->mesh.positions.size(), append_vertex},
                                   {content->with.texture.value.size(), append_texture},
                                   {content->with.normals.value.size(), append_normal}};
  std::size_t first = 0;
  for (const Part& part : content->parts) {
    sections.push_back({1, [line = "g " + part.name + "\n"](std::string& text, std::size_t) { text += line; }});
    sections.push_back(
        {part.faces, [=](std::string& text, std::size_t f) { append_obj_face(text, *content, first + f); }});
    first += part.faces;
  }
  const std::size_t others = content->mesh.face_count() - first;
  sections.push_back({others, [=](std::string& text, std::size_t f) { append_obj_face(text, *content, first + f); }});
  std::string header;
  for (const std::string& library : content->materials.libraries) header += "mtllib " + library + "\n";
  return in_sections(header, std::move(sections));
}

}  // namespace vdb_offset::io
