// SPDX-License-Identifier: Apache-2.0
// Reads what a PLY file holds besides positions and faces: normals, colours, texture coordinates, and any property of
// vertices by its name. Which properties these are is known by the names that programs give them; they count only if
// they are single numbers of one type, or a list of texture coordinates that fits the corners of each face. Each kind
// is read in a pass of its own over the file. Equal texture coordinates of corners share one value. An attribute that
// is malformed is not read, and stays on the list of what another format loses. A property that is asked for by its
// name has to be one of finite numbers, or is refused. Positions and faces are not read again.
#include "ply/ply_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "bytes/nearest_names.h"
#include "document/columns.h"
#include "ply/ply_header.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

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

/// The property with this name. \throw InvalidInput if there is none, or it is a list
const ply::Property& find_scalar(const MeshFile& source, const ply::Element& vertices, const std::string& name) {
  std::vector<std::string> known;
  const ply::Property* found = nullptr;
  for (const ply::Property& property : vertices.properties) {
    if (property.count) continue;
    if (property.name == name) {
      if (found)
        throw InvalidInput(fmt::format("{}: expected one vertex property '{}', found several", source.path, name));
      found = &property;
    }
    known.push_back(property.name);
  }
  if (!found)
    throw InvalidInput(fmt::format("{}: expected a vertex property '{}' of single numbers, found none (there are {})",
                                   source.path, name, nearest_names(name, known)));
  return *found;
}

/// The number of a property at a byte. \throw InvalidInput unless it is a finite number of the property's type, in a
/// text as well
double property_at(const MeshFile& source, const ply::Property& property, std::uint64_t at, std::size_t v) {
  const auto expected = [&] {
    return fmt::format("a finite number '{}' for vertex {} (counted from 0)", property.name, v);
  };
  if (source.encoding != Encoding::Ascii) {
    const double value = binary_number(source.text().data() + at, property.type, source.encoding);
    if (!std::isfinite(value))
      throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", source.path, at, expected(), value));
    return value;
  }
  Scanner scanner(source.path, source.text(), at);
  double value = 0;
  std::int64_t whole = 0;
  if (property.type.kind == 'f') {
    if (!parse_double(scanner.token(), value)) scanner.fail(expected(), at);
    value = ply::as_declared(property.type, value);
  } else {
    if (!parse_integer(scanner.token(), whole)) scanner.fail(expected(), at);
    value = static_cast<double>(whole);
  }
  if (!std::isfinite(value)) scanner.fail(expected(), at);
  return value;
}

}  // namespace

void PlyRows::read_attributes(const MeshFile& source, Attributes& attributes) const {
  read_normals_of_rows(source, attributes);
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

std::vector<double> PlyRows::vertex_numbers(const MeshFile& source, const std::string& name) const {
  const ply::Header header = ply::read_header(source);
  const ply::Element* const vertices = ply::find(header, "vertex");
  const std::size_t count = source.polygons.positions.size();
  // This fails only if the file has changed since it was read.
  if (!vertices || vertices->count != count)
    throw InvalidInput(fmt::format("{}, header: expected {} vertices, as before", source.path, count));
  const ply::Property& wanted = find_scalar(source, *vertices, name);
  ply::BodyReader body(source, header);
  body.skip_to(*vertices, header);
  std::vector<double> numbers(count);
  for (std::size_t v = 0; v < count; ++v)
    for (const ply::Property& property : vertices->properties)
      if (&property == &wanted)
        numbers[v] = property_at(source, wanted, body.skip_number(wanted.type, "a property"), v);
      else body.skip(property);
  source.bytes.require_unchanged(source.path);
  return numbers;
}

}  // namespace vdb_offset::io
