// SPDX-License-Identifier: Apache-2.0
// Writes a PLY file, text or binary, over a mesh that is made of its own, in the source's own header and elements. The
// source's vertices keep all but the numbers that change. One that was added has a row of its own: that of its vertex,
// if it is a copy; else it is made property by property, with a unit normal between those at its origin, floating
// numbers and colours interpolated by its shares, and of everything else the value of the nearest vertex. A face has
// the row of its parent with other corners, and with lists of texture coordinates and colours of corners in their
// order. Faces of a shell get a property for the part that they are of, unless one of that name is there, which is
// named as a loss. Rows that do not change and other elements keep their bytes; the type of vertex numbers widens only
// if they do not fit. Strips of triangles have been replaced by faces before (ply_without_strips.cpp).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "derived/derived_mesh.h"
#include "derived/interpolate.h"
#include "derived/refined_corners.h"
#include "ply/ply_document.h"
#include "ply/ply_rows.h"

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
enum class Blend { Position, Normal, Number, Nearest };

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
  const bool is_colour = property.type.bytes <= 2 && names_colour(property.name);
  return {property.type.kind == 'f' || is_colour ? Blend::Number : Blend::Nearest, 0};
}

class PlyDeriver {
 public:
  explicit PlyDeriver(SharedDerived derived)
      : derived_(std::move(derived)),
        source_(derived_->source()),
        rows_(source_),
        index_type_(ply::index_type(rows_.corner_list(), derived_->mesh().positions.size() - 1)),
        is_widened_(index_type_.kind != rows_.corner_list().type.kind ||
                    index_type_.bytes != rows_.corner_list().type.bytes) {
    for (const Property& property : rows_.vertices().properties)
      rules_.push_back(rule_of(property, !rows_of(source_).normal_at.empty()));
    const auto& properties = rows_.faces().properties;
    adds_part_ = derived_->is_shell() &&
                 std::none_of(properties.begin(), properties.end(), [](const Property& p) { return p.name == "part"; });
  }

  bool adds_part() const { return adds_part_; }

  /// The pieces of the file: all elements, in their order.
  static Pieces pieces(const std::shared_ptr<const PlyDeriver>& deriver) {
    const DerivedMesh& derived = *deriver->derived_;
    const Rows& rows = deriver->rows_;
    std::vector<Pieces> parts{
        in_sections(rows.header_with({derived.mesh().positions.size(), derived.face_count(), deriver->index_type_,
                                      deriver->adds_part_ ? "part" : nullptr}),
                    {})};
    const auto add = [&](std::size_t items, const std::function<void(std::string&, std::uint32_t)>& append) {
      parts.push_back(in_sections(
          {}, {{items, [=](std::string& bytes, std::size_t i) { append(bytes, static_cast<std::uint32_t>(i)); }}}));
    };
    const auto add_bytes = [&](std::string_view bytes) {
      add(1, [=](std::string& text, std::uint32_t) { text += bytes; });
    };
    const std::uint32_t first_added = derived.source_vertices(), first_other = derived.other_faces().begin;
    for (std::size_t i = 0; i < rows.elements().size(); ++i) {
      if (&rows.elements()[i] == &rows.vertices()) {
        const std::size_t begin = rows.vertex_rows().front();
        parts.push_back(derived.rows_in_place(begin, rows.vertex_rows().back()));
        add(derived.added_vertices(),
            [=](std::string& bytes, std::uint32_t v) { deriver->append_vertex(bytes, first_added + v); });
      } else if (&rows.elements()[i] == &rows.faces()) {
        add(derived.source_mesh().face_count(),
            [=](std::string& bytes, std::uint32_t f) { deriver->append_faces(bytes, f); });
        add(derived.other_faces().size(), [=](std::string& bytes, std::uint32_t f) {
          CornerFinder finder(deriver->derived_->source_mesh());
          deriver->begin_row(bytes);
          deriver->append_face(bytes, first_other + f, finder);
        });
      } else {
        add_bytes(rows.of_element(i));
      }
    }
    add_bytes(rows.rest());
    return in_a_row(std::move(parts));
  }

 private:
  using Words = std::array<std::string_view, 3>;

  std::array<double, 3> numbers(const Words& raw, Type type) const {
    return {binary_number(raw[0].data(), type, rows_.encoding()), binary_number(raw[1].data(), type, rows_.encoding()),
            binary_number(raw[2].data(), type, rows_.encoding())};
  }

  /// Begins a row of a text, on a line of its own.
  void begin_row(std::string& bytes) const {
    if (rows_.is_text()) bytes += rows_.line_end();
  }

  void append_vertex(std::string& bytes, std::uint32_t v) const {
    const VertexOrigin origin = derived_->origin(v);
    std::array<std::size_t, 3> at = at_origin(origin, [&](auto of) { return std::size_t{rows_.vertex_rows()[of]}; });
    const std::array<std::string, 3> normal = normal_of(v, origin);
    begin_row(bytes);
    const std::size_t start = bytes.size(), own = nearest(origin);
    for (std::size_t i = 0; i < rules_.size(); ++i) {
      const Property& property = rows_.vertices().properties[i];
      if (rules_[i].blend == Blend::Nearest) {
        rows_.append_as_it_is(bytes, start, property, at[own]);
        for (std::size_t& place : at) place = rows_.end_of(property, place);
        continue;
      }
      Words raw;
      for (std::size_t k = 0; k < 3; ++k) {
        const Cell cell = rows_.cell_at(property.type, at[k]);
        raw[k] = cell.raw;
        at[k] = cell.end;
      }
      rows_.separate(bytes, start);
      if (rules_[i].blend == Blend::Position) append_coordinate(bytes, v, rules_[i].component, property.type, raw[0]);
      else if (rules_[i].blend == Blend::Normal) bytes += normal[static_cast<std::size_t>(rules_[i].component)];
      else append_between(bytes, origin, raw, property.type);
    }
  }

  void append_coordinate(std::string& bytes, std::uint32_t v, int k, Type type, std::string_view raw) const {
    if (rows_.is_text()) return derived_->append_coordinate(bytes, v, k, raw);
    if (const auto position = derived_->new_position(v))
      append_binary_as(bytes, (*position)[k], type, rows_.encoding());
    else bytes += raw;
  }

  /// Appends the number between three numbers of a type.
  void append_between(std::string& bytes, const VertexOrigin& origin, const Words& raw, Type type) const {
    if (rows_.is_text()) {
      const Digits digits = type.kind != 'f' ? Digits::Whole : type.bytes == 4 ? Digits::Single : Digits::Double;
      return append_interpolated(bytes, origin, raw, digits);
    }
    const double value = interpolated(origin, numbers(raw, type));
    if (!std::isfinite(value) || origin.share[0] == 1) bytes += raw[nearest(origin)];
    else append_binary_as(bytes, type.kind == 'f' ? value : std::round(value), type, rows_.encoding());
  }

  /// The three numbers of an added vertex's normal, as the file has them. None if there are no normals.
  std::array<std::string, 3> normal_of(std::uint32_t v, const VertexOrigin& origin) const {
    if (rows_of(source_).normal_at.empty()) return {};
    if (rows_.is_text()) return derived_->vertex_normal_words(v);
    const Type type{'f', rows_of(source_).normal_bytes};
    std::array<Words, 3> raw;  // of each vertex
    std::array<Vec3d, 3> known;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i)
        raw[k][i] = rows_.cell_at(type, rows_of(source_).normal_at[origin.vertex[k]].at[i]).raw;
      const auto [x, y, z] = numbers(raw[k], type);
      known[k] = Vec3d(x, y, z);
    }
    const std::optional<Vec3d> made = derived_->vertex_normal(v, known);
    std::array<std::string, 3> normal;
    for (std::size_t i = 0; i < 3; ++i) {
      if (made) append_binary_as(normal[i], (*made)[static_cast<int>(i)], type, rows_.encoding());
      else normal[i] = raw[nearest(origin)][i];
    }
    return normal;
  }

  /// Appends the faces in the place of one of the source's.
  void append_faces(std::string& bytes, std::uint32_t of) const {
    const std::string_view row = rows_.bytes(rows_.face_rows()[of], rows_.face_rows()[of + 1]);
    const FaceRange pieces = derived_->pieces_of(of);
    if (derived_->is_kept(of) && (!is_widened_ || rows_.is_text())) {
      append_part(bytes += row, pieces.begin);
      return;
    }
    CornerFinder finder(derived_->source_mesh());
    for (std::uint32_t f = pieces.begin; f < pieces.end; ++f) {
      if (rows_.is_text() && f == pieces.begin) bytes += row.substr(0, row.find_first_not_of(" \t\r\n\v\f"));
      else begin_row(bytes);
      append_face(bytes, f, finder);
    }
  }

  void append_face(std::string& bytes, std::uint32_t f, CornerFinder& finder) const {
    const std::size_t start = bytes.size();
    std::size_t at = rows_.face_rows()[derived_->parent(f)];
    for (const Property& property : rows_.faces().properties) {
      if (&property == &rows_.corner_list()) {
        rows_.append_corners(bytes, start, derived_->mesh().face(f), index_type_);
        at = rows_.end_of(property, at);
      } else if (const std::size_t width = width_of(property, derived_->parent(f), at); width > 0) {
        at = append_list(bytes, start, property, at, f, width, finder);
      } else {
        at = rows_.append_as_it_is(bytes, start, property, at);
      }
    }
    append_part(bytes, f);
  }
  void append_part(std::string& bytes, std::uint32_t f) const {
    if (adds_part_) rows_.append_whole_number(bytes, 0, static_cast<double>(derived_->part(f)), {'u', 1});
  }

  /// How many numbers of a list belong to each corner of a face; 0 if it is no list of texture coordinates or colours
  /// of corners.
  std::size_t width_of(const Property& property, std::uint32_t of, std::size_t at) const {
    const bool is_texture = names_texture(property.name);
    if (!property.count || property.type.kind != 'f' || !(is_texture || names_colour(property.name))) return 0;
    const std::size_t length = rows_.length_in(rows_.cell_at(*property.count, at), *property.count);
    const std::size_t corners = derived_->source_mesh().face(of).size(), width = length / corners;
    if (length % corners != 0) return 0;
    return is_texture ? (width == 2 || width == 3 ? width : 0) : (width == 3 || width == 4 ? width : 0);
  }

  /// Appends a list of numbers of corners. Returns where the next property begins.
  std::size_t append_list(std::string& bytes, std::size_t start, const Property& list, std::size_t at, std::uint32_t f,
                          std::size_t width, CornerFinder& finder) const {
    const std::vector<std::string_view> numbers = rows_.items_of(list, rows_.cell_at(*list.count, at), at);
    const std::size_t corners = derived_->mesh().face(f).size();
    const std::uint32_t first = derived_->source_mesh().face_begin[derived_->parent(f)];
    rows_.append_whole_number(bytes, start, static_cast<double>(width * corners), *list.count);
    for (std::size_t k = 0; k < corners; ++k) {
      const CornerOrigin corner = derived_->corner(f, k, finder);
      const auto number = [&](std::size_t of, std::size_t i) {
        return numbers[width * (corner.corner[of] - first) + i];
      };
      for (std::size_t i = 0; i < width; ++i) {
        rows_.separate(bytes, start);
        append_between(bytes, corner.vertex, {number(0, i), number(1, i), number(2, i)}, list.type);
      }
    }
    return at;
  }

  SharedDerived derived_;
  const MeshFile& source_;
  Rows rows_;
  Type index_type_;
  bool is_widened_, adds_part_ = false;
  std::vector<Rule> rules_;  // of vertices' properties
};

}  // namespace
}  // namespace ply

WrittenDocument PlyRows::derive(const SharedDerived& derived, const std::string&) const {
  const auto deriver = std::make_shared<const ply::PlyDeriver>(derived);
  WrittenDocument written{ply::PlyDeriver::pieces(deriver), {}, {}};
  if (derived->is_shell() && !deriver->adds_part())
    written.lost.emplace_back("the parts of the shell (the face property 'part' is taken)");
  return written;
}

}  // namespace vdb_offset::io
