// SPDX-License-Identifier: Apache-2.0
// Writes a PLY file, text or binary, with the faces of a refinement. An added vertex has a row of its own, made
// property by property: its position, a unit normal between those at its origin, floating numbers and colours
// interpolated by its shares, and of everything else the value of the nearest vertex. The pieces of a face have its row
// with other corners; lists of texture coordinates and colours of corners are interpolated, and all else is copied.
// Rows of vertices, faces that are not split and other elements keep their bytes, but for faces of a binary file whose
// vertex numbers need a wider type. Strips of triangles have been replaced by faces before (ply_without_strips.cpp).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "bytes/append_number.h"
#include "derived/interpolate.h"
#include "derived/refine_writers.h"
#include "ply/ply_document.h"
#include "ply/ply_rows.h"

// The source's rows as they are; those of added vertices behind the others, and those of pieces in the place of their
// face.
namespace vdb_offset::io {
namespace ply {
namespace {

bool names_texture(std::string_view name) { return name.find("tex") != std::string_view::npos || name == "uv"; }

bool names_colour(std::string_view name) {
  constexpr std::string_view kColours[] = {"r",    "g",     "b",      "a",         "gray",
                                           "grey", "color", "colour", "intensity", "luminance"};
  constexpr std::string_view kEndings[] = {"red", "green", "blue", "alpha"};
  return std::find(std::begin(kColours), std::end(kColours), name) != std::end(kColours) ||
         std::any_of(std::begin(kEndings), std::end(kEndings), [&](auto ending) { return name.ends_with(ending); });
}

/// How a property of vertices is made for an added one.
enum class Blend { Position, Normal, Number, Colour, Nearest };

struct Rule {
  Blend blend;
  int component;  // of a position or a normal
};

Rule rule_of(const Property& property, bool has_normals) {
  constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
  if (property.count) return {Blend::Nearest, 0};
  const auto* const name = std::find(std::begin(kNames), std::end(kNames), property.name);
  const int component = static_cast<int>(name - kNames);
  if (component < 3) return {Blend::Position, component};
  if (component < 6 && has_normals) return {Blend::Normal, component - 3};
  if (property.type.kind == 'f') return {Blend::Number, 0};
  return {property.type.bytes <= 2 && names_colour(property.name) ? Blend::Colour : Blend::Nearest, 0};
}

class PlyRefiner {
 public:
  explicit PlyRefiner(const SharedRefined& content)
      : content_(content),
        source_(content->source),
        rows_(source_),
        index_type_(ply::index_type(rows_.corner_list(), content->refined().positions.size() - 1)),
        is_widened_(index_type_.kind != rows_.corner_list().type.kind ||
                    index_type_.bytes != rows_.corner_list().type.bytes) {
    for (const Property& property : rows_.vertices().properties)
      rules_.push_back(rule_of(property, !rows_of(source_).normal_at.empty()));
  }

  /// The pieces of the file: all elements, in their order.
  static Pieces pieces(const std::shared_ptr<const PlyRefiner>& refiner) {
    std::vector<Section> sections;
    const auto add_bytes = [&](std::string_view bytes) {
      sections.push_back({1, [bytes](std::string& text, std::size_t) { text += bytes; }});
    };
    const Rows& rows = refiner->rows_;
    for (std::size_t i = 0; i < rows.elements().size(); ++i) {
      if (&rows.elements()[i] == &rows.faces()) {
        sections.push_back({refiner->content_->mesh().face_count(),
                            [=](std::string& bytes, std::size_t f) { refiner->append_faces(bytes, f); }});
        continue;
      }
      add_bytes(rows.of_element(i));
      if (&rows.elements()[i] == &rows.vertices())
        sections.push_back({refiner->content_->refinement.added.size(),
                            [=](std::string& bytes, std::size_t v) { refiner->append_vertex(bytes, v); }});
    }
    add_bytes(rows.rest());
    const PolygonView refined = refiner->content_->refined();
    const std::string header =
        rows.header_with({refined.positions.size(), refined.face_count(), refiner->index_type_, nullptr});
    return in_sections(header, std::move(sections));
  }

 private:
  using Cells = std::array<Cell, 3>;
  using Words = std::array<std::string_view, 3>;
  static Words raw_of(const Cells& cells) { return {cells[0].raw, cells[1].raw, cells[2].raw}; }

  std::array<double, 3> numbers(const Words& raw, Type type) const {
    return {binary_number(raw[0].data(), type, rows_.encoding()), binary_number(raw[1].data(), type, rows_.encoding()),
            binary_number(raw[2].data(), type, rows_.encoding())};
  }

  /// Begins a row of a text, on a line of its own.
  void begin_row(std::string& bytes) const {
    if (rows_.is_text()) bytes += rows_.line_end();
  }

  void append_vertex(std::string& bytes, std::size_t added) const {
    const VertexOrigin& origin = content_->refinement.added[added];
    std::array<std::size_t, 3> at = at_origin(origin, [&](auto v) { return std::size_t{rows_.vertex_rows()[v]}; });
    const std::array<std::string, 3> normal = normal_of(origin);
    begin_row(bytes);
    const std::size_t start = bytes.size();
    for (std::size_t i = 0; i < rules_.size(); ++i) {
      const Property& property = rows_.vertices().properties[i];
      if (rules_[i].blend == Blend::Nearest) {
        rows_.append_as_it_is(bytes, start, property, at[nearest(origin)]);
        for (std::size_t& place : at) place = rows_.end_of(property, place);
        continue;
      }
      Cells cells;
      for (std::size_t k = 0; k < 3; ++k) {
        cells[k] = rows_.cell_at(property.type, at[k]);
        at[k] = cells[k].end;
      }
      rows_.separate(bytes, start);
      if (rules_[i].blend == Blend::Position)
        append_number_as(bytes, content_->added_position(added)[rules_[i].component], property.type);
      else if (rules_[i].blend == Blend::Normal) bytes += normal[static_cast<std::size_t>(rules_[i].component)];
      else append_between(bytes, origin, raw_of(cells), property.type);
    }
  }

  void append_number_as(std::string& bytes, double value, Type type) const {
    if (!rows_.is_text()) return append_binary_as(bytes, value, type, rows_.encoding());
    append_number(bytes, value, {type.bytes == 4 ? Rounding::Kind::Single : Rounding::Kind::Double});
  }

  /// Appends the number between three numbers of a type.
  void append_between(std::string& bytes, const VertexOrigin& origin, const Words& raw, Type type) const {
    if (rows_.is_text()) {
      const Digits digits = type.kind != 'f' ? Digits::Whole : type.bytes == 4 ? Digits::Single : Digits::Double;
      return append_interpolated(bytes, origin, raw, digits);
    }
    const double value = interpolated(origin, numbers(raw, type));
    if (!std::isfinite(value)) bytes += raw[nearest(origin)];
    else append_binary_as(bytes, type.kind == 'f' ? value : std::round(value), type, rows_.encoding());
  }

  /// The three numbers of an added vertex's normal, as the file has them; the nearest one if it has no direction. None
  /// if there are no normals.
  std::array<std::string, 3> normal_of(const VertexOrigin& origin) const {
    if (rows_of(source_).normal_at.empty()) return {};
    const Type type{'f', rows_.is_text() ? std::uint8_t{4} : rows_of(source_).normal_bytes};
    std::array<Words, 3> raw;  // of each vertex
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        raw[k][i] = rows_.cell_at(type, rows_of(source_).normal_at[origin.vertex[k]].at[i]).raw;
    std::array<std::string, 3> normal;
    if (rows_.is_text()) {
      std::string words;
      append_interpolated_normal(words, origin, raw);
      Scanner scanner(source_.path, words);
      for (std::string& word : normal) word = scanner.token();
      return normal;
    }
    std::array<Vec3d, 3> known;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [x, y, z] = numbers(raw[k], type);
      known[k] = Vec3d(x, y, z);
    }
    const Vec3d between = interpolated_normal(origin, known);
    for (std::size_t i = 0; i < 3; ++i) {
      if (between.isFinite()) append_binary_as(normal[i], between[static_cast<int>(i)], type, rows_.encoding());
      else normal[i] = raw[nearest(origin)][i];
    }
    return normal;
  }

  /// Appends the pieces of a face, or its row as it is.
  void append_faces(std::string& bytes, std::size_t f) const {
    const std::string_view row = rows_.bytes(rows_.face_rows()[f], rows_.face_rows()[f + 1]);
    if (!content_->is_split(f) && !(is_widened_ && !rows_.is_text())) {
      bytes += row;
      return;
    }
    CornerFinder finder(content_->mesh());
    for (std::uint32_t piece = content_->first_piece[f]; piece < content_->first_piece[f + 1]; ++piece) {
      if (rows_.is_text() && piece == content_->first_piece[f])
        bytes += row.substr(0, row.find_first_not_of(" \t\r\n\v\f"));
      else begin_row(bytes);
      append_piece(bytes, f, piece, finder);
    }
  }

  void append_piece(std::string& bytes, std::size_t f, std::uint32_t piece, CornerFinder& finder) const {
    const std::size_t start = bytes.size();
    std::size_t at = rows_.face_rows()[f];
    for (const Property& property : rows_.faces().properties) {
      if (&property == &rows_.corner_list()) {
        rows_.append_corners(bytes, start, content_->refined().face(piece), index_type_);
        at = rows_.end_of(property, at);
      } else if (const std::size_t width = width_of(property, f, at); width > 0) {
        at = append_list(bytes, start, property, at, f, piece, width, finder);
      } else {
        at = rows_.append_as_it_is(bytes, start, property, at);
      }
    }
  }

  /// How many numbers of a list belong to each corner of a face; 0 if it is no list of texture coordinates or colours
  /// of corners.
  std::size_t width_of(const Property& property, std::size_t f, std::size_t at) const {
    const bool is_texture = names_texture(property.name);
    if (!property.count || property.type.kind != 'f' || !(is_texture || names_colour(property.name))) return 0;
    const std::size_t length = rows_.length_in(rows_.cell_at(*property.count, at), *property.count);
    const std::size_t corners = content_->mesh().face(f).size(), width = length / corners;
    if (length % corners != 0) return 0;
    return is_texture ? (width == 2 || width == 3 ? width : 0) : (width == 3 || width == 4 ? width : 0);
  }

  /// Appends a list of numbers of corners for a piece. Returns where the next property begins.
  std::size_t append_list(std::string& bytes, std::size_t start, const Property& list, std::size_t at, std::size_t f,
                          std::uint32_t piece, std::size_t width, CornerFinder& finder) const {
    const std::vector<std::string_view> numbers = rows_.items_of(list, rows_.cell_at(*list.count, at), at);
    const auto face = content_->refined().face(piece);
    rows_.append_whole_number(bytes, start, static_cast<double>(width * face.size()), *list.count);
    for (std::size_t corner = 0; corner < face.size(); ++corner) {
      const VertexOrigin origin = origin_of(face[corner], f);
      std::array<std::size_t, 3> first{};
      for (std::size_t k = 0; k < 3; ++k)
        if (origin.share[k] > 0) first[k] = width * (finder.at(f, origin.vertex[k]) - content_->mesh().face_begin[f]);
      for (std::size_t i = 0; i < width; ++i) {
        rows_.separate(bytes, start);
        append_between(bytes, origin, {numbers[first[0] + i], numbers[first[1] + i], numbers[first[2] + i]}, list.type);
      }
    }
    return at;
  }
  /// Where a vertex lies; a vertex of the source with all of the share.
  VertexOrigin origin_of(std::uint32_t v, std::size_t face) const {
    const std::size_t first = content_->refinement.source_vertices();
    if (v >= first) return content_->refinement.added[v - first];
    return {static_cast<std::uint32_t>(face), {v, v, v}, {1, 0, 0}};
  }

  SharedRefined content_;
  const MeshFile& source_;
  Rows rows_;
  Type index_type_;
  bool is_widened_;
  std::vector<Rule> rules_;  // of vertices' properties
};

}  // namespace
}  // namespace ply

Pieces PlyRows::refined(const std::shared_ptr<const RefinedContent>& content, std::vector<std::string>&) const {
  return ply::PlyRefiner::pieces(std::make_shared<const ply::PlyRefiner>(content));
}

}  // namespace vdb_offset::io
