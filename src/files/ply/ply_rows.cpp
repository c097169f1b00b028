// SPDX-License-Identifier: Apache-2.0
// Finds the rows of a PLY file again, and copies or writes their cells, for shells and refinements in the same format.
// One walk over the body notes where each element, and each row of vertices and faces, begins. A cell is a word of a
// text or the bytes of a number; whoever writes a row copies cells that stay and appends others by their type and byte
// order. The header is copied line by line with other counts, a wider type for vertex numbers if they ask for it, and
// at most one more property of faces. Whatever is copied keeps its bytes. A file with other counts than the mesh that
// was read from it has changed, and is refused. Numbers are not interpreted here but for the lengths of lists.
#include "ply/ply_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/line_records.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io::ply {
namespace {

template <class T>
void append_in_order(std::string& bytes, T value, Encoding encoding) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (encoding == Encoding::BigEndian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

/// The largest vertex number that a list's type can hold.
std::uint64_t largest(Type type) {
  const int bits = 8 * type.bytes - (type.kind == 'i' ? 1 : 0);
  return (std::uint64_t{1} << bits) - 1;
}

bool is_same(Type a, Type b) { return a.kind == b.kind && a.bytes == b.bytes; }

}  // namespace

void append_binary_as(std::string& bytes, double value, Type type, Encoding encoding) {
  const auto append = [&](auto number) { append_in_order(bytes, number, encoding); };
  if (type.kind == 'f') return type.bytes == 4 ? append(static_cast<float>(value)) : append(value);
  // A whole number that both a signed and an unsigned type can hold has the same bytes in both.
  const auto whole = static_cast<std::int64_t>(value);
  if (type.bytes == 1) append(static_cast<std::uint8_t>(whole));
  else if (type.bytes == 2) append(static_cast<std::uint16_t>(whole));
  else append(static_cast<std::uint32_t>(whole));
}

Type index_type(const Property& list, std::uint64_t last) {
  if (last <= largest(list.type)) return list.type;
  return last > largest({'i', 4}) ? Type{'u', 4} : Type{'i', 4};
}

Rows::Rows(const MeshFile& source)
    : source_(source),
      header_(read_header(source)),
      vertices_(&element("vertex", source.polygons.positions.size())),
      faces_(&element("face", source.polygons.face_count())),
      corner_list_(&*std::find_if(faces_->properties.begin(), faces_->properties.end(), is_corner_list)),
      line_end_(header_.line_end == '\r' ? "\r" : line_end_of(source.text())) {
  find_rows();
}

const Element& Rows::element(const char* name, std::size_t count) const {
  const Element* const found = find(header_, name);
  if (!found || found->count != count)
    throw InvalidInput(fmt::format("{}, header: expected {} elements '{}', got others (the file has changed)",
                                   source_.path, count, name));
  return *found;
}

void Rows::find_rows() {
  BodyReader body(source_, header_);
  for (const Element& element : header_.elements) {
    element_begin_.push_back(body.position());
    std::vector<std::uint64_t>* const rows = &element == vertices_ ? &vertex_row_
                                             : &element == faces_  ? &face_row_
                                                                   : nullptr;
    if (rows) rows->reserve(element.count + 1);
    for (std::size_t row = 0; row < element.count && !element.properties.empty(); ++row) {
      if (rows) rows->push_back(body.position());
      for (const Property& property : element.properties) body.skip(property);
    }
    if (rows) rows->push_back(body.position());
  }
  element_begin_.push_back(body.position());
}

std::string Rows::header_with(const HeaderChanges& changes) const {
  const std::string_view lines = source_.text().substr(0, header_.end);
  const bool widens = !is_same(changes.index_type, corner_list_->type);
  std::string text;
  bool of_faces = false, list_found = false;
  for (std::size_t at = 0; at < lines.size();) {
    const std::size_t newline = std::min(lines.find(header_.line_end, at), lines.size() - 1);
    const std::string_view line = lines.substr(at, newline + 1 - at);
    const std::string end = line.ends_with("\r\n") ? "\r\n" : std::string(1, header_.line_end);
    Scanner words(source_.path, line);
    const std::string_view keyword = words.token();
    if ((keyword == "element" || keyword == "end_header") && of_faces && changes.face_property)
      text += fmt::format("property uchar {}{}", changes.face_property, end);
    if (keyword == "element") {
      const std::string_view what = words.token();
      of_faces = what == "face";
      if (what == "vertex" || of_faces)
        text += fmt::format("element {} {}{}", what, of_faces ? changes.faces : changes.vertices, end);
      else text += line;
    } else if (keyword == "property" && of_faces && !list_found && widens && words.token() == "list") {
      const std::string_view count_type = words.token();
      words.token();
      list_found = words.token() == corner_list_->name;
      if (list_found)
        text += fmt::format("property list {} {} {}{}", count_type, changes.index_type.kind == 'i' ? "int" : "uint",
                            corner_list_->name, end);
      else text += line;
    } else {
      text += line;
    }
    at = newline + 1;
  }
  return text;
}

Cell Rows::cell_at(Type type, std::size_t at) const {
  if (!is_text()) return {source_.text().substr(at, type.bytes), at + type.bytes};
  Scanner scanner(source_.path, source_.text(), at);
  const std::string_view word = scanner.token_anywhere("a number");
  return {word, scanner.position()};
}

std::size_t Rows::length_in(const Cell& cell, Type type) const {
  if (!is_text()) return static_cast<std::size_t>(binary_number(cell.raw.data(), type, header_.encoding));
  std::int64_t length = 0;
  parse_integer(cell.raw, length);
  return static_cast<std::size_t>(length);
}

std::vector<std::string_view> Rows::items_of(const Property& list, const Cell& length, std::size_t& at) const {
  std::vector<std::string_view> items;
  at = length.end;
  for (std::size_t left = length_in(length, *list.count); left > 0; --left) {
    const Cell cell = cell_at(list.type, at);
    items.push_back(cell.raw);
    at = cell.end;
  }
  return items;
}

void Rows::append_whole_number(std::string& bytes, std::size_t start, double value, Type type) const {
  separate(bytes, start);
  if (is_text()) append_integer(bytes, static_cast<std::uint64_t>(value));
  else append_binary_as(bytes, value, type, header_.encoding);
}

void Rows::append_corners(std::string& bytes, std::size_t start, std::span<const std::uint32_t> face,
                          Type index) const {
  append_whole_number(bytes, start, static_cast<double>(face.size()), *corner_list_->count);
  for (const auto v : face) append_whole_number(bytes, start, v, index);
}

std::size_t Rows::append_as_it_is(std::string& bytes, std::size_t start, const Property& property,
                                  std::size_t at) const {
  Cell cell = cell_at(property.count.value_or(property.type), at);
  append_cell(bytes, start, cell);
  for (std::size_t left = property.count ? length_in(cell, *property.count) : 0; left > 0; --left) {
    cell = cell_at(property.type, cell.end);
    append_cell(bytes, start, cell);
  }
  return cell.end;
}

std::size_t Rows::end_of(const Property& property, std::size_t at) const {
  std::string ignored;
  return append_as_it_is(ignored, 0, property, at);
}

}  // namespace vdb_offset::io::ply
