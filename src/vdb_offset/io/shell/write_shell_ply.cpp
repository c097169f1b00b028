// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "vdb_offset/error.h"
#include "vdb_offset/io/base/append_number.h"
#include "vdb_offset/io/base/line_records.h"
#include "vdb_offset/io/mesh/read/ply_header.h"
#include "vdb_offset/io/shell/shell_writers.h"

// The rows of both skins, and of the rim, are the source's rows with some numbers replaced.
namespace vdb_offset::io {
namespace ply {
namespace {

template <class T>
void append_in_order(std::string& bytes, T value, Encoding encoding) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (encoding == Encoding::BigEndian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

/// Appends the bytes of a number as a type. \pre the type can hold it
void append_binary_as(std::string& bytes, double value, Type type, Encoding encoding) {
  const auto append = [&](auto number) { append_in_order(bytes, number, encoding); };
  if (type.kind == 'f') return type.bytes == 4 ? append(static_cast<float>(value)) : append(value);
  // A whole number that both a signed and an unsigned type can hold has the same bytes in both.
  const auto whole = static_cast<std::int64_t>(value);
  if (type.bytes == 1) append(static_cast<std::uint8_t>(whole));
  else if (type.bytes == 2) append(static_cast<std::uint16_t>(whole));
  else append(static_cast<std::uint32_t>(whole));
}

/// The largest vertex number that a list's type can hold.
std::uint64_t largest(Type type) {
  const int bits = 8 * type.bytes - (type.kind == 'i' ? 1 : 0);
  return (std::uint64_t{1} << bits) - 1;
}

/// A word of a text or the bytes of a number, and where the next one begins.
struct Cell {
  std::string_view raw;
  std::size_t end;
};

class PlyShellWriter {
 public:
  explicit PlyShellWriter(const SharedShell& content)
      : content_(content),
        source_(content->source),
        shell_(content->shell),
        header_(read_header(source_)),
        vertices_(element("vertex", source_.polygons.positions.size())),
        faces_(element("face", source_.polygons.face_count())) {
    corner_list_ = std::find_if(faces_.properties.begin(), faces_.properties.end(), is_corner_list);
    index_type_ = corner_list_->type;
    const std::uint64_t last = shell_.polygons.positions.size() - 1;
    if (last > largest(index_type_)) index_type_ = last > largest({'i', 4}) ? Type{'u', 4} : Type{'i', 4};
    adds_part_ = std::none_of(faces_.properties.begin(), faces_.properties.end(),
                              [](const Property& p) { return p.name == "part"; });
    find_rows();
  }

  bool adds_part() const { return adds_part_; }

  /// The pieces of the file: all elements, in their order.
  static Pieces pieces(const std::shared_ptr<const PlyShellWriter>& writer) {
    std::vector<Section> sections;
    for (std::size_t i = 0; i < writer->header_.elements.size(); ++i) {
      const Element& element = writer->header_.elements[i];
      if (&element == &writer->vertices_) {
        sections.push_back({writer->shell_.polygons.positions.size(),
                            [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, v); }});
      } else if (&element == &writer->faces_) {
        sections.push_back({writer->shell_.polygons.face_count(),
                            [=](std::string& bytes, std::size_t f) { writer->append_face(bytes, f); }});
      } else {
        sections.push_back({1, [=](std::string& bytes, std::size_t) { writer->append_element(bytes, i); }});
      }
    }
    sections.push_back({1, [=](std::string& bytes, std::size_t) { writer->append_rest(bytes); }});
    return in_sections(writer->header(), std::move(sections));
  }

  /// The source's header with other numbers of vertices and faces, and with new properties of these.
  std::string header() const {
    const std::string_view lines = source_.text().substr(0, header_.end);
    std::string text;
    bool of_faces = false, list_found = false;
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t newline = std::min(lines.find(header_.line_end, at), lines.size() - 1);
      const std::string_view line = lines.substr(at, newline + 1 - at);
      Scanner words(source_.path, line);
      const std::string_view keyword = words.token();
      if ((keyword == "element" || keyword == "end_header") && of_faces && adds_part_)
        text += "property uchar part" + line_end(line);
      if (keyword == "element") {
        const std::string_view what = words.token();
        of_faces = what == "face";
        text += element_line(line, what);
      } else if (keyword == "property" && of_faces && !list_found && is_widened() && words.token() == "list") {
        const std::string_view count_type = words.token();
        words.token();
        const std::string_view list = words.token();
        list_found = list == corner_list_->name;
        if (list_found) text += list_line(count_type) + line_end(line);
        else text += line;
      } else {
        text += line;
      }
      at = newline + 1;
    }
    return text;
  }

  void append_vertex(std::string& bytes, std::size_t vertex) const {
    constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
    const auto& [skin, v] = content_->vertex(static_cast<std::uint32_t>(vertex));
    std::size_t at = vertex_row_[skin.source_of(v)];
    const std::size_t start = bytes.size();
    for (const Property& property : vertices_.properties) {
      const auto* const known =
          property.count ? std::end(kNames) : std::find(std::begin(kNames), std::end(kNames), property.name);
      if (known == std::end(kNames)) {
        at = append_as_it_is(bytes, start, property, at);
        continue;
      }
      const int k = static_cast<int>(known - kNames) % 3;
      const bool is_normal = known - kNames >= 3;
      const Cell cell = cell_at(property.type, at);
      at = cell.end;
      separate(bytes, start);
      if (is_normal && source_.normal_at.empty()) bytes += cell.raw;
      else if (is_text() && is_normal) skin.append_normal_component(bytes, v, k, cell.raw);
      else if (is_text()) skin.append_coordinate(bytes, v, k, cell.raw);
      else append_vertex_number(bytes, skin, v, k, is_normal, property.type, cell.raw);
    }
    end_row(bytes);
  }

  void append_face(std::string& bytes, std::size_t f) const {
    std::size_t at = face_row_[shell_.source_face(f)];
    const std::size_t start = bytes.size();
    for (auto property = faces_.properties.begin(); property != faces_.properties.end(); ++property) {
      if (property == corner_list_) {
        append_corners(bytes, start, f);
        at = end_of(*property, at);
      } else if (property->name == "texcoord" && property->count) {
        at = append_texture(bytes, start, *property, at, f);
      } else {
        at = append_as_it_is(bytes, start, *property, at);
      }
    }
    if (adds_part_) append_number_of(bytes, start, static_cast<double>(shell_.part(f)), {'u', 1});
    end_row(bytes);
  }

 private:
  const Element& element(const char* name, std::size_t count) const {
    const Element* const found = find(header_, name);
    if (!found || found->count != count)
      throw InvalidInput(fmt::format("{}, header: expected {} elements '{}', got others (the file has changed)",
                                     source_.path, count, name));
    return *found;
  }
  bool is_text() const { return header_.encoding == Encoding::Ascii; }
  bool is_widened() const {
    return index_type_.kind != corner_list_->type.kind || index_type_.bytes != corner_list_->type.bytes;
  }
  std::string line_end(std::string_view line) const {
    return line.ends_with("\r\n") ? "\r\n" : std::string(1, header_.line_end);
  }

  std::string element_line(std::string_view line, std::string_view what) const {
    if (what != "vertex" && what != "face") return std::string(line);
    const std::size_t count = what == "vertex" ? shell_.polygons.positions.size() : shell_.polygons.face_count();
    return fmt::format("element {} {}", what, count) + line_end(line);
  }
  std::string list_line(std::string_view count_type) const {
    return fmt::format("property list {} {} {}", count_type, index_type_.kind == 'i' ? "int" : "uint",
                       corner_list_->name);
  }

  /// Finds where each row of vertices and faces, and each other element, starts.
  void find_rows() {
    BodyReader body(source_, header_);
    for (const Element& element : header_.elements) {
      element_begin_.push_back(body.position());
      std::vector<std::uint64_t>* const rows = &element == &vertices_ ? &vertex_row_
                                               : &element == &faces_  ? &face_row_
                                                                      : nullptr;
      if (rows) rows->reserve(element.count);
      for (std::size_t row = 0; row < element.count && !element.properties.empty(); ++row) {
        if (rows) rows->push_back(body.position());
        for (const Property& property : element.properties) body.skip(property);
      }
    }
    element_begin_.push_back(body.position());
  }

  Cell cell_at(Type type, std::size_t at) const {
    if (!is_text()) return {source_.text().substr(at, type.bytes), at + type.bytes};
    Scanner scanner(source_.path, source_.text(), at);
    const std::string_view word = scanner.token_anywhere("a number");
    return {word, scanner.position()};
  }
  std::size_t length_in(const Cell& cell, Type type) const {
    if (!is_text()) return static_cast<std::size_t>(binary_number(cell.raw.data(), type, header_.encoding));
    std::int64_t length = 0;
    parse_integer(cell.raw, length);
    return static_cast<std::size_t>(length);
  }
  std::size_t end_of(const Property& property, std::size_t at) const {
    std::string ignored;
    return append_as_it_is(ignored, 0, property, at);
  }

  // In a text, the numbers of a row are separated by blanks, and a line end follows.
  void separate(std::string& bytes, std::size_t start) const {
    if (is_text() && bytes.size() > start) bytes += ' ';
  }
  void end_row(std::string& bytes) const {
    if (is_text()) bytes += header_.line_end;
  }
  void append_cell(std::string& bytes, std::size_t start, const Cell& cell) const {
    separate(bytes, start);
    bytes += cell.raw;
  }
  void append_number_of(std::string& bytes, std::size_t start, double value, Type type) const {
    separate(bytes, start);
    if (is_text()) append_integer(bytes, static_cast<std::uint64_t>(value));
    else append_binary_as(bytes, value, type, header_.encoding);
  }
  /// Copies a property of a row. Returns where the next property begins.
  std::size_t append_as_it_is(std::string& bytes, std::size_t start, const Property& property, std::size_t at) const {
    Cell cell = cell_at(property.count.value_or(property.type), at);
    append_cell(bytes, start, cell);
    for (std::size_t left = property.count ? length_in(cell, *property.count) : 0; left > 0; --left) {
      cell = cell_at(property.type, cell.end);
      append_cell(bytes, start, cell);
    }
    return cell.end;
  }

  void append_vertex_number(std::string& bytes, const Skin& skin, std::size_t v, int k, bool is_normal, Type type,
                            std::string_view raw) const {
    if (const auto value = is_normal ? skin.new_normal(v) : skin.new_position(v))
      append_binary_as(bytes, (*value)[k], type, header_.encoding);
    else if (is_normal && skin.is_reversed())
      append_binary_as(bytes, 0.0 - binary_number(raw.data(), type, header_.encoding), type, header_.encoding);
    else bytes += raw;
  }

  void append_corners(std::string& bytes, std::size_t start, std::size_t f) const {
    const auto face = shell_.polygons.view().face(f);
    append_number_of(bytes, start, static_cast<double>(face.size()), *corner_list_->count);
    for (const auto v : face) append_number_of(bytes, start, v, index_type_);
  }

  /// Appends a list of texture coordinates: if it has two numbers for each corner, in the order of the new corners;
  /// else as it is. Returns where the next property begins.
  std::size_t append_texture(std::string& bytes, std::size_t start, const Property& list, std::size_t at,
                             std::size_t f) const {
    const PolygonView mesh = source_.polygons.view();
    const std::uint32_t of_mesh = shell_.source_face(f), begin = mesh.face_begin[of_mesh];
    Cell cell = cell_at(*list.count, at);
    if (length_in(cell, *list.count) != 2 * mesh.face(of_mesh).size()) return append_as_it_is(bytes, start, list, at);
    std::vector<std::string_view> numbers;
    for (std::size_t i = 0; i < 2 * mesh.face(of_mesh).size(); ++i) {
      cell = cell_at(list.type, cell.end);
      numbers.push_back(cell.raw);
    }
    const std::size_t corners = shell_.polygons.view().face(f).size();
    append_number_of(bytes, start, static_cast<double>(2 * corners), *list.count);
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t i = 0; i < 2; ++i) {
        separate(bytes, start);
        bytes += numbers[2 * (shell_.source_corner(mesh, f, k) - begin) + i];
      }
    return cell.end;
  }

  /// Appends an element other than vertices and faces. In a text, line ends before it are left out.
  void append_element(std::string& bytes, std::size_t i) const {
    std::string_view all = source_.text().substr(element_begin_[i], element_begin_[i + 1] - element_begin_[i]);
    if (is_text()) all.remove_prefix(std::min(all.find_first_not_of(" \t\r\n\v\f"), all.size()));
    if (all.empty()) return;
    bytes += all;
    end_row(bytes);
  }
  void append_rest(std::string& bytes) const {
    std::string_view rest = source_.text().substr(element_begin_.back());
    if (is_text()) rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n\v\f"), rest.size()));
    bytes += rest;
  }

  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  Header header_;
  const Element &vertices_, &faces_;
  std::vector<Property>::const_iterator corner_list_;
  Type index_type_{};
  bool adds_part_ = true;
  std::vector<std::uint64_t> vertex_row_, face_row_;
  std::vector<std::size_t> element_begin_;
};

}  // namespace
}  // namespace ply

Pieces shell_to_ply(const SharedShell& content, std::vector<std::string>& lost) {
  const auto writer = std::make_shared<const ply::PlyShellWriter>(content);
  if (!writer->adds_part()) lost.emplace_back("the parts of the shell (the face property 'part' is taken)");
  return ply::PlyShellWriter::pieces(writer);
}

}  // namespace vdb_offset::io
