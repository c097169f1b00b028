// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "document/document.h"
#include "document/face_labels.h"
#include "ground/system/parallel.h"
#include "off/off_binary.h"
#include "ply/ply_header.h"
#include "stl/stl_layout.h"
#include "vdb_offset/error.h"

namespace vdb_offset::io {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Scanner scanner_at(const MeshFile& source, std::uint64_t byte) {
  return {source.path, source.text(), byte, source.format == Format::Obj, source.format == Format::Ply ? '\0' : '#'};
}

/// Removes an extra from the list of what would be lost. Returns whether it was listed.
bool is_kept(Attributes& attributes, const std::string& extra) { return std::erase(attributes.lost, extra) > 0; }

bool has_extra(const MeshFile& source, std::string_view extra) {
  return std::find(source.extras.begin(), source.extras.end(), extra) != source.extras.end();
}

bool all_finite(const std::vector<Vec2d>& points) {
  return std::all_of(points.begin(), points.end(), [](const Vec2d& p) { return p.isFinite(); });
}

bool any_named(const std::vector<std::uint32_t>& of_corner) {
  return std::any_of(of_corner.begin(), of_corner.end(), [](auto n) { return n != kNoNormal; });
}

void read_normals(const MeshFile& source, Attributes& attributes) {
  if (source.normal_at.empty() || source.format == Format::Stl) return;
  if (source.format == Format::Obj && !any_named(source.corner_normal)) return;
  auto& [value, of_corner, single] = attributes.normals;
  value.resize(source.normal_at.size());
  of_corner = source.corner_normal;
  single = source.normal_bytes == 4;
  for_each_index(value.size(), [&normals = value, &source](std::size_t n) {
    const NumberTriple triple = source.normal_at[n];
    for (int k = 0; k < 3; ++k)
      normals[n][k] =
          source.encoding == Encoding::Ascii
              ? number_or_nan(scanner_at(source, triple.at[k]).token())
              : ply::binary_number(source.text().data() + triple.at[k], {'f', source.normal_bytes}, source.encoding);
  });
  is_kept(attributes, "normals");
}

/// Numbers that stand with vertices, `width` for each.
struct Columns {
  std::size_t width = 0;
  std::vector<double> number;
};

/// Takes the first `width` columns, three or four, as colours, with `white` as the largest value. Returns false, and
/// takes nothing, if a value is out of range or there are no such columns.
bool take_colours(const Columns& columns, std::size_t width, double white, Attributes& attributes) {
  if (width != 3 && width != 4) return false;
  std::vector<std::array<double, 4>> colours(columns.number.size() / columns.width, {0, 0, 0, 1});
  for (std::size_t v = 0; v < colours.size(); ++v)
    for (std::size_t k = 0; k < width; ++k) {
      colours[v][k] = columns.number[v * columns.width + k] / white;
      if (!(colours[v][k] >= 0 && colours[v][k] <= 1)) return false;
    }
  attributes.colours = std::move(colours);
  attributes.has_alpha = width == 4;
  return true;
}

/// Takes two columns, from `first` on, as texture coordinates of vertices.
bool take_texture(const Columns& columns, std::size_t first, Attributes& attributes) {
  std::vector<Vec2d> texture;
  for (std::size_t at = first; at + 1 < columns.number.size(); at += columns.width)
    texture.emplace_back(columns.number[at], columns.number[at + 1]);
  if (!all_finite(texture)) return false;
  attributes.texture.value = std::move(texture);
  return true;
}

/// The words behind the coordinates (and normals) of a text's vertices, as numbers; NaN for a word that is no number.
/// None if the vertices have different numbers of words, or more than are known to mean anything.
std::optional<Columns> read_tails(const MeshFile& source) {
  constexpr std::size_t kMost = 6;  // words: a colour of four numbers and two texture coordinates
  const ByteOffsets& last =
      source.format == Format::Off && !source.normal_at.empty() ? source.normal_at : source.position_at;
  const auto tail = [&](std::size_t v) {
    Scanner scanner = scanner_at(source, last[v].at[2]);
    scanner.token();
    return scanner;
  };
  Columns columns;
  for (Scanner first = tail(0); !first.at_line_end(); first.token())
    if (++columns.width > kMost) return std::nullopt;
  columns.number.resize(last.size() * columns.width);
  std::atomic<bool> same = true;
  for_each_index(last.size(), [&](std::size_t v) {
    Scanner scanner = tail(v);
    for (std::size_t k = 0; k < columns.width; ++k)
      columns.number[v * columns.width + k] = number_or_nan(scanner.token());
    if (!scanner.at_line_end()) same = false;
  });
  if (!same) return std::nullopt;
  return columns;
}

/// Finds which texture coordinates a corner v/vt.. names, kNoNormal for none. Negative numbers count back from the
/// `so_far` ones that have been read. Returns false for a word that is no index.
bool texture_of(std::string_view corner, std::size_t so_far, std::uint32_t& texture) {
  texture = kNoNormal;
  const std::size_t slash =
      std::min(corner.find('/'), corner.size() - 1);  // without a slash: the last character, so that no digits follow
  const std::string_view digits = corner.substr(slash + 1, corner.find('/', slash + 1) - slash - 1);
  if (digits.empty()) return true;
  std::int64_t index = 0;
  if (!parse_integer(digits, index)) return false;
  if (index < 0) index += static_cast<std::int64_t>(so_far) + 1;
  if (index < 1 || index >= kNoNormal) return false;
  texture = static_cast<std::uint32_t>(index - 1);
  return true;
}

/// Reads `vt` lines, and which of them the corners of faces name. Returns false if one of them is malformed.
bool read_obj_texture(const MeshFile& source, CornerValues<Vec2d>& texture, bool& has_depth) {
  bool are_indices = true;
  for_each_obj_line(source.path, source.text(), [&](const ObjLine& line) {
    if (line.is("vt")) {
      double uvw[3] = {kNaN, 0, 0};
      Scanner words = line.words();
      for (double* number = uvw; number != std::end(uvw) && !words.at_line_end(); ++number)
        *number = number_or_nan(words.token());
      texture.value.emplace_back(uvw[0], uvw[1]);
      has_depth |= uvw[2] != 0;
    } else if (line.is("f") && are_indices) {
      for (Scanner words = line.words(); are_indices && !words.at_line_end();)
        are_indices = texture_of(words.token(), texture.value.size(), texture.of_corner.emplace_back());
    }
  });
  if (!are_indices) return false;
  return all_finite(texture.value) && texture.of_corner.size() == source.polygons.corners.size() &&
         any_named(texture.of_corner) && std::all_of(texture.of_corner.begin(), texture.of_corner.end(), [&](auto t) {
           return t == kNoNormal || t < texture.value.size();
         });
}

void read_obj(const MeshFile& source, Attributes& attributes) {
  constexpr const char *kVertexData = "vertex weights or colours", *kTexture = "texture coordinates";
  if (has_extra(source, kVertexData))
    if (const auto tails = read_tails(source); tails && take_colours(*tails, tails->width, 1, attributes))
      is_kept(attributes, kVertexData);
  CornerValues<Vec2d> texture;
  bool has_depth = false;
  if (!has_extra(source, kTexture) || !read_obj_texture(source, texture, has_depth)) return;
  attributes.texture = std::move(texture);
  is_kept(attributes, kTexture);
  if (has_depth) attributes.lost.emplace_back("third texture coordinates");
}

/// The value of white: 255 or 1, as some programs write colours as 0 .. 255 and some as 0 .. 1.
double white_of(const Columns& columns, std::size_t width) {
  for (std::size_t i = 0; i < columns.number.size(); ++i)
    if (i % columns.width < width && columns.number[i] > 1) return 255;
  return 1;
}

/// Whether any face's line goes on behind its corners: with a colour.
bool has_face_colours(const MeshFile& source) {
  const PolygonView mesh = source.polygons.view();
  Scanner scanner = scanner_at(source, source.position_at[source.position_at.size() - 1].at[2]);
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
    for (std::size_t v = 0; v < source.position_at.size(); ++v)
      for (std::size_t k = 0; k < width; ++k)
        columns.number.push_back(off::number_at(source, source.position_at[v].at[0] + 4 * (first + k)));
    return columns;
  };
  if (layout.colour && take_colours(columns_of(layout.colour, 4), 4, 1, attributes)) is_kept(attributes, kOffColours);
  if (layout.texture && take_texture(columns_of(layout.texture, 2), 0, attributes)) is_kept(attributes, kOffTexture);
  const std::uint64_t counts = source.polygons.corners.size() + 2 * source.polygons.face_count();
  const std::vector<std::uint64_t> offsets = off::face_offsets(source);
  if (offsets.back() - offsets.front() > 4 * counts) attributes.lost.emplace_back("face colours");
}

void read_off(const MeshFile& source, Attributes& attributes) {
  if (source.encoding != Encoding::Ascii) return read_binary_off(source, attributes);
  constexpr const char *kColours = kOffColours, *kTexture = kOffTexture;
  if (has_face_colours(source)) attributes.lost.emplace_back("face colours");
  const auto tails = read_tails(source);
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

using Names = std::vector<std::string>;

/// Reads the values of the properties with these names in every row of an element.
/// \throw InvalidInput for a value that is not a finite number
Columns read_columns(const MeshFile& source, const ply::Header& header, const ply::Element& wanted,
                     const Names& names) {
  Columns columns{names.size(), std::vector<double>(names.size() * wanted.count)};
  ply::BodyReader body(source, header);
  body.skip_to(wanted, header);
  std::uint64_t ignored = 0;
  for (std::size_t row = 0; row < wanted.count; ++row)
    for (const ply::Property& property : wanted.properties) {
      const auto name = std::find(names.begin(), names.end(), property.name);
      if (name == names.end()) body.skip(property);
      else
        columns.number[row * columns.width + static_cast<std::size_t>(name - names.begin())] =
            body.take(property.type, "a number", ignored);
    }
  return columns;
}

/// The common type of the properties with these names. None unless each name occurs once, and all are single numbers of
/// one type.
std::optional<ply::Type> common_type(const ply::Element& element, const Names& names) {
  std::optional<ply::Type> type;
  for (const std::string& name : names) {
    const auto is_named = [&](const ply::Property& p) { return p.name == name; };
    if (std::count_if(element.properties.begin(), element.properties.end(), is_named) != 1) return std::nullopt;
    const auto p = std::find_if(element.properties.begin(), element.properties.end(), is_named);
    if (p->count || (type && (type->kind != p->type.kind || type->bytes != p->type.bytes))) return std::nullopt;
    type = p->type;
  }
  return type;
}

void read_ply_colours(const MeshFile& source, const ply::Header& header, Attributes& attributes) {
  const ply::Element& vertices = *ply::find(header, "vertex");
  for (const Names& names : {Names{"red", "green", "blue", "alpha"}, Names{"red", "green", "blue"}}) {
    const auto type = common_type(vertices, names);
    if (!type || (type->kind != 'f' && !(type->kind == 'u' && type->bytes == 1))) continue;
    const Columns columns = read_columns(source, header, vertices, names);
    if (!take_colours(columns, names.size(), type->kind == 'f' ? 1 : 255, attributes)) continue;
    for (const std::string& name : names) is_kept(attributes, "vertex property '" + name + "'");
    return;
  }
}

void read_ply_texture(const MeshFile& source, const ply::Header& header, Attributes& attributes) {
  const ply::Element& vertices = *ply::find(header, "vertex");
  for (const Names& names : {Names{"s", "t"}, Names{"u", "v"}, Names{"texture_u", "texture_v"}}) {
    const auto type = common_type(vertices, names);
    if (!attributes.texture.empty() || !type || type->kind != 'f') continue;
    if (!take_texture(read_columns(source, header, vertices, names), 0, attributes)) continue;
    attributes.texture.single = type->bytes == 4;
    for (const std::string& name : names) is_kept(attributes, "vertex property '" + name + "'");
  }
}

/// Gives equal texture coordinates one index.
class TextureIndex {
 public:
  explicit TextureIndex(std::vector<Vec2d>& value) : value_(value) {}
  std::uint32_t operator()(const Vec2d& uv) {
    const auto [known, is_new] = index_.try_emplace({uv[0], uv[1]}, static_cast<std::uint32_t>(value_.size()));
    if (is_new) value_.push_back(uv);
    return known->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const std::pair<double, double>& uv) const {
      return std::hash<double>()(uv.first) * 31 + std::hash<double>()(uv.second);
    }
  };
  std::vector<Vec2d>& value_;
  std::unordered_map<std::pair<double, double>, std::uint32_t, Hash> index_;
};

/// Reads the lists `texcoord` of faces, which have two numbers for each corner, or are empty.
void read_ply_texture_lists(const MeshFile& source, const ply::Header& header, Attributes& attributes) {
  if (!ply::find_faces(header) || ply::find_strips(header)) return;
  const ply::Element& faces = *ply::find_faces(header);
  const auto is_texture = [](const ply::Property& p) { return p.name == "texcoord" && p.count && p.type.kind == 'f'; };
  if (std::count_if(faces.properties.begin(), faces.properties.end(), is_texture) != 1) return;
  CornerValues<Vec2d> texture;
  TextureIndex index_of(texture.value);
  ply::BodyReader body(source, header);
  body.skip_to(faces, header);
  std::uint64_t ignored = 0;
  for (std::size_t f = 0; f < faces.count; ++f)
    for (const ply::Property& property : faces.properties) {
      if (!is_texture(property)) {
        body.skip(property);
        continue;
      }
      texture.single = property.type.bytes == 4;
      const std::size_t length = body.take_length(property), corners = source.polygons.view().face(f).size();
      if (length != 0 && length != 2 * corners) return;
      for (std::size_t k = 0; k < length / 2; ++k) {
        const double u = body.take(property.type, "a number", ignored);
        texture.of_corner.push_back(index_of({u, body.take(property.type, "a number", ignored)}));
      }
      if (length == 0) texture.of_corner.insert(texture.of_corner.end(), corners, kNoNormal);
    }
  if (!any_named(texture.of_corner) || !all_finite(texture.value)) return;
  attributes.texture = std::move(texture);
  is_kept(attributes, "face property 'texcoord'");
}

void read_ply(const MeshFile& source, Attributes& attributes) {
  const ply::Header header = ply::read_header(source);
  const ply::Element *vertices = ply::find(header, "vertex"), *faces = ply::find_faces(header);
  // This fails only if the file has changed since it was read; then nothing will be written.
  if (!vertices || vertices->count != source.polygons.positions.size() ||
      (!ply::find_strips(header) && (!faces || faces->count != source.polygons.face_count())))
    return;
  for (const auto read : {read_ply_colours, read_ply_texture_lists, read_ply_texture}) {
    try {
      read(source, header, attributes);
    } catch (const InvalidInput&) {
      // A malformed attribute is not read, and stays listed as lost.
    }
  }
}

/// Lists what only STL can hold, and other formats lose: the header's text, and the facets' attribute bytes.
void read_stl(const MeshFile& source, Attributes& attributes) {
  const std::string_view bytes = source.text();
  if (source.encoding == Encoding::Ascii) {
    Scanner scanner(source.path, bytes);
    scanner.first_word();
    if (!scanner.at_line_end()) attributes.lost.emplace_back("the name of the solid");
    return;
  }
  const auto is_filled = [](char c) { return c != '\0' && c != ' '; };
  if (std::any_of(bytes.begin(), bytes.begin() + stl::kHeader, is_filled))
    attributes.lost.emplace_back("the header's text");
  const std::size_t facets = source.polygons.face_count();
  for (std::size_t f = 1; f <= facets; ++f) {
    const std::size_t behind = stl::kFirst + f * stl::kFacet;
    if (bytes[behind - 2] == '\0' && bytes[behind - 1] == '\0') continue;
    attributes.lost.emplace_back("attribute bytes");
    break;
  }
  if (bytes.size() > stl::kFirst + facets * stl::kFacet) attributes.lost.emplace_back("bytes behind the last facet");
}

}  // namespace

Attributes read_attributes(const MeshFile& source) {
  Attributes attributes;
  attributes.lost = source.extras;
  if (source.document) {
    source.document->read_attributes(source, attributes);
    return attributes;
  }
  read_normals(source, attributes);
  switch (source.format) {
    case Format::Obj:
      read_obj(source, attributes);
      break;
    case Format::Off:
      read_off(source, attributes);
      break;
    case Format::Ply:
      read_ply(source, attributes);
      break;
    case Format::Stl:
      read_stl(source, attributes);
      break;
    default:
      break;
  }
  return attributes;
}

Materials read_materials(const MeshFile& source) {
  Materials materials;
  if (source.document) {
    FaceNames names = source.document->face_names();
    return {std::move(names.materials), std::move(names.material_of), {}, std::move(names.colours)};
  }
  if (source.format != Format::Obj || !has_extra(source, "materials")) return materials;
  std::unordered_map<std::string, std::uint32_t> index_of;
  std::string name;
  for_each_obj_line(source.path, source.text(), [&](const ObjLine& line) {
    if (line.is("usemtl")) name = rest_of_line(line);
    else if (line.is("mtllib")) materials.libraries.push_back(rest_of_line(line));
    if (!line.is("f")) return;
    const auto [known, is_new] = index_of.try_emplace(name, static_cast<std::uint32_t>(materials.names.size()));
    if (is_new) materials.names.push_back(name);
    materials.of_face.push_back(known->second);
  });
  const bool any = materials.names.size() > 1 || (materials.names.size() == 1 && !materials.names[0].empty());
  if (!any || materials.of_face.size() != source.polygons.face_count()) return {};
  return materials;
}

std::vector<Vec2d> vertex_texture(const MeshFile& source) {
  const CornerValues<Vec2d> texture = read_attributes(source).texture;
  if (texture.empty())
    throw InvalidInput(source.path + ": expected texture coordinates, which the distance uses (u, v), found none");
  const Polygons& mesh = source.polygons;
  std::vector<Vec2d> of_vertex(mesh.positions.size(), Vec2d(0.0));
  std::vector<std::uint8_t> has_value(of_vertex.size(), 0);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::uint32_t v = mesh.corners[c], t = texture.index(c, v);
    if (has_value[v]) continue;
    has_value[v] = t != kNoNormal;
    of_vertex[v] = t == kNoNormal ? Vec2d(kNaN) : texture.value[t];
  }
  return of_vertex;
}

}  // namespace vdb_offset::io
