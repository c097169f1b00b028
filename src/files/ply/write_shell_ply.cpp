// SPDX-License-Identifier: Apache-2.0
// Writes a shell of a PLY file, text or binary, in the source's own header and elements. A vertex of the shell has the
// row of the source's vertex that it comes from; position and normal are replaced where they changed, and the normal of
// an inner vertex that keeps it gets the other sign. A face has the row of its source's face with other corners, and
// texture coordinates in the order of these. Faces get a property for the part that they are of, unless one of that
// name is there, which is named as a loss. The type of vertex numbers widens only if they do not fit. All other
// properties are copied, and so are other elements and what stands behind them, once. Comments of the header stay.
#include <algorithm>
#include <iterator>

#include "derived/shell_writers.h"
#include "ply/ply_document.h"
#include "ply/ply_rows.h"

// The rows of both skins, and of the rim, are the source's rows with some numbers replaced.
namespace vdb_offset::io {
namespace ply {
namespace {

class PlyShellWriter {
 public:
  explicit PlyShellWriter(const SharedShell& content)
      : content_(content),
        source_(content->source),
        shell_(content->shell),
        rows_(source_),
        index_type_(ply::index_type(rows_.corner_list(), shell_.polygons.positions.size() - 1)) {
    const auto& properties = rows_.faces().properties;
    adds_part_ = std::none_of(properties.begin(), properties.end(), [](const Property& p) { return p.name == "part"; });
  }

  bool adds_part() const { return adds_part_; }

  /// The pieces of the file: all elements, in their order.
  static Pieces pieces(const std::shared_ptr<const PlyShellWriter>& writer) {
    std::vector<Section> sections;
    for (std::size_t i = 0; i < writer->rows_.elements().size(); ++i) {
      const Element& element = writer->rows_.elements()[i];
      if (&element == &writer->rows_.vertices()) {
        sections.push_back({writer->shell_.polygons.positions.size(),
                            [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, v); }});
      } else if (&element == &writer->rows_.faces()) {
        sections.push_back({writer->shell_.polygons.face_count(),
                            [=](std::string& bytes, std::size_t f) { writer->append_face(bytes, f); }});
      } else {
        sections.push_back({1, [=](std::string& bytes, std::size_t) { writer->append_element(bytes, i); }});
      }
    }
    sections.push_back({1, [=](std::string& bytes, std::size_t) { writer->append_rest(bytes); }});
    return in_sections(writer->header(), std::move(sections));
  }

  std::string header() const {
    return rows_.header_with(
        {shell_.polygons.positions.size(), shell_.polygons.face_count(), index_type_, adds_part_ ? "part" : nullptr});
  }

  void append_vertex(std::string& bytes, std::size_t vertex) const {
    constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
    const auto& [skin, v] = content_->vertex(static_cast<std::uint32_t>(vertex));
    std::size_t at = rows_.vertex_rows()[skin.source_of(v)];
    const std::size_t start = bytes.size();
    for (const Property& property : rows_.vertices().properties) {
      const auto* const known =
          property.count ? std::end(kNames) : std::find(std::begin(kNames), std::end(kNames), property.name);
      if (known == std::end(kNames)) {
        at = rows_.append_as_it_is(bytes, start, property, at);
        continue;
      }
      const int k = static_cast<int>(known - kNames) % 3;
      const bool is_normal = known - kNames >= 3;
      const Cell cell = rows_.cell_at(property.type, at);
      at = cell.end;
      rows_.separate(bytes, start);
      if (is_normal && rows_of(source_).normal_at.empty()) bytes += cell.raw;
      else if (rows_.is_text() && is_normal) skin.append_normal_component(bytes, v, k, cell.raw);
      else if (rows_.is_text()) skin.append_coordinate(bytes, v, k, cell.raw);
      else append_vertex_number(bytes, skin, v, k, is_normal, property.type, cell.raw);
    }
    end_row(bytes);
  }

  void append_face(std::string& bytes, std::size_t f) const {
    std::size_t at = rows_.face_rows()[shell_.source_face(f)];
    const std::size_t start = bytes.size();
    for (const Property& property : rows_.faces().properties) {
      if (&property == &rows_.corner_list()) {
        rows_.append_corners(bytes, start, shell_.polygons.view().face(f), index_type_);
        at = rows_.end_of(property, at);
      } else if (property.name == "texcoord" && property.count) {
        at = append_texture(bytes, start, property, at, f);
      } else {
        at = rows_.append_as_it_is(bytes, start, property, at);
      }
    }
    if (adds_part_) rows_.append_whole_number(bytes, start, static_cast<double>(shell_.part(f)), {'u', 1});
    end_row(bytes);
  }

 private:
  void end_row(std::string& bytes) const {
    if (rows_.is_text()) bytes += rows_.line_end();
  }

  void append_vertex_number(std::string& bytes, const Skin& skin, std::size_t v, int k, bool is_normal, Type type,
                            std::string_view raw) const {
    if (const auto value = is_normal ? skin.new_normal(v) : skin.new_position(v))
      append_binary_as(bytes, (*value)[k], type, rows_.encoding());
    else if (is_normal && skin.is_reversed())
      append_binary_as(bytes, 0.0 - binary_number(raw.data(), type, rows_.encoding()), type, rows_.encoding());
    else bytes += raw;
  }

  /// Appends a list of texture coordinates: if it has two numbers for each corner, in the order of the new corners;
  /// else as it is. Returns where the next property begins.
  std::size_t append_texture(std::string& bytes, std::size_t start, const Property& list, std::size_t at,
                             std::size_t f) const {
    const PolygonView mesh = source_.polygons.view();
    const std::uint32_t of_mesh = shell_.source_face(f), begin = mesh.face_begin[of_mesh];
    const Cell length = rows_.cell_at(*list.count, at);
    if (rows_.length_in(length, *list.count) != 2 * mesh.face(of_mesh).size())
      return rows_.append_as_it_is(bytes, start, list, at);
    const std::vector<std::string_view> numbers = rows_.items_of(list, length, at);
    const std::size_t corners = shell_.polygons.view().face(f).size();
    rows_.append_whole_number(bytes, start, static_cast<double>(2 * corners), *list.count);
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t i = 0; i < 2; ++i) {
        rows_.separate(bytes, start);
        bytes += numbers[2 * (shell_.source_corner(mesh, f, k) - begin) + i];
      }
    return at;
  }

  /// Appends an element other than vertices and faces. In a text, line ends before it are left out.
  void append_element(std::string& bytes, std::size_t i) const {
    std::string_view all = rows_.of_element(i);
    if (rows_.is_text()) all.remove_prefix(std::min(all.find_first_not_of(" \t\r\n\v\f"), all.size()));
    if (all.empty()) return;
    bytes += all;
    end_row(bytes);
  }
  void append_rest(std::string& bytes) const {
    std::string_view rest = rows_.rest();
    if (rows_.is_text()) rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n\v\f"), rest.size()));
    bytes += rest;
  }

  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  Rows rows_;
  Type index_type_;
  bool adds_part_ = true;
};

}  // namespace
}  // namespace ply

Pieces PlyRows::with_shell(const std::shared_ptr<const ShellContent>& content, std::vector<std::string>& lost) const {
  const auto writer = std::make_shared<const ply::PlyShellWriter>(content);
  if (!writer->adds_part()) lost.emplace_back("the parts of the shell (the face property 'part' is taken)");
  return ply::PlyShellWriter::pieces(writer);
}

}  // namespace vdb_offset::io
