// SPDX-License-Identifier: Apache-2.0
#include "document/encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "document/documents.h"

namespace vdb_offset::io {
namespace {

void append_point(std::string& text, const Vec3d& p, const Rounding& precision) {
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

void append_facet(std::string& bytes, const std::array<Vec3d, 3>& corner) {
  Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  if (normal.length() > 0) normal /= normal.length();
  for (const Vec3d& row : {normal, corner[0], corner[1], corner[2]})
    for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(row[k]));
  append_binary(bytes, std::uint16_t{0});
}

Pieces to_stl(const SharedContent& content) {
  const PolygonView& mesh = content->mesh;
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  const auto made = std::make_shared<const Triangles>(mesh.triangles.empty() ? split_polygons(mesh) : Triangles());
  const std::span<const std::array<std::uint32_t, 3>> triangles = mesh.triangles.empty() ? *made : mesh.triangles;
  std::string header(80, '\0');
  append_binary(header, static_cast<std::uint32_t>(triangles.size()));
  return in_sections(header, {{triangles.size(), [content, made, triangles](std::string& bytes, std::size_t t) {
                                 const auto& at = content->mesh.positions;
                                 const Rounding single{Rounding::Kind::Single};
                                 const auto& [a, b, c] = triangles[t];
                                 append_facet(bytes, {single(at[a]), single(at[b]), single(at[c])});
                               }}});
}

}  // namespace

bool is_gltf(Format format) { return format == Format::Gltf || format == Format::Glb; }

bool fits_float(double value) {
  const auto narrow = static_cast<float>(value);
  std::string digits;
  append_number(digits, value, {Rounding::Kind::Single});
  double back = 0;
  return static_cast<double>(narrow) == value || (parse_double(digits, back) && back == value);
}

bool is_text(Format format) { return format == Format::Obj || format == Format::Off || format == Format::ThreeMf; }

bool is_single(Format format) { return format == Format::Stl || is_gltf(format); }

bool is_of_triangles(Format format) { return is_single(format) || format == Format::ThreeMf; }

bool holds_colours(Format format) { return format != Format::Stl; }

bool holds_texture(Format format) { return format != Format::Stl && format != Format::ThreeMf; }

bool holds_normals(Format format) { return holds_texture(format); }

bool holds_corners(Format format) { return format == Format::Obj || is_gltf(format); }

bool are_bytes(const std::vector<std::array<double, 4>>& colours) {
  const auto is_byte = [](double colour) { return std::abs(colour - colour_byte(colour) / 255.0) <= 0.0005; };
  return std::all_of(colours.begin(), colours.end(),
                     [&](const auto& colour) { return std::all_of(colour.begin(), colour.end(), is_byte); });
}

std::uint8_t colour_byte(double colour) { return static_cast<std::uint8_t>(std::lround(colour * 255)); }

Pieces encode(Format format, const SharedContent& content) {
  switch (format) {
    case Format::Obj:
      return to_obj(content);
    case Format::Off:
      return to_off(content);
    case Format::Ply:
      return to_ply(content);
    case Format::ThreeMf:
      return to_3mf(content);
    case Format::Gltf:
      return to_gltf(content);
    case Format::Glb:
      return to_glb(content);
    case Format::Vtp:
    case Format::Vtk:
    case Format::Vtu:
      return to_vtk(format, content);
    case Format::Stl:
    case Format::Assimp:  // these are not written
    case Format::Step:
    case Format::Iges:
    case Format::Brep:
    case Format::Vdb:
      break;
  }
  return to_stl(content);
}

}  // namespace vdb_offset::io
