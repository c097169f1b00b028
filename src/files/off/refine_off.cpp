// SPDX-License-Identifier: Apache-2.0
// Writes an OFF file, text or binary, with the faces of a refinement. The counts are replaced, that of edges by 0. An
// added vertex has its position, a unit normal between those at its origin, and the other numbers interpolated by its
// shares, as whole numbers in a text where colours are bytes. Where one of these numbers is not finite, that of the
// nearest vertex counts. The pieces of a face have its colour, and what stood behind the face's line in a text follows
// the last piece. Everything else keeps its bytes: vertices, faces that are not split, comments, and what stands at the
// end.
#include <algorithm>
#include <cmath>

#include "bytes/append_number.h"
#include "derived/interpolate.h"
#include "derived/refine_writers.h"
#include "off/off_binary.h"
#include "off/off_document.h"
#include "off/off_rows.h"

// The source's rows as they are; those of added vertices behind the others, and those of pieces in the place of their
// face.
namespace vdb_offset::io {
namespace {

class BinaryOffRefiner {
 public:
  explicit BinaryOffRefiner(const SharedRefined& content)
      : content_(content),
        source_(content->source),
        layout_(off::layout_of(source_)),
        face_at_(off::face_offsets(source_)) {}

  /// All up to the added vertices.
  std::string start() const {
    const std::size_t counts = *off::binary_begin(source_), vertices = rows_of(source_).position_at[0].at[0];
    std::string bytes(source_.text().substr(0, counts));
    off::append_count(bytes, content_->refined().positions.size());
    off::append_count(bytes, content_->refined().face_count());
    off::append_count(bytes, 0);
    return bytes += source_.text().substr(vertices, face_at_.front() - vertices);
  }
  void append_vertex(std::string& bytes, std::size_t added) const {
    const VertexOrigin& origin = content_->refinement.added[added];
    const Vec3d& position = content_->added_position(added);
    for (int k = 0; k < 3; ++k) off::append_float(bytes, position[k]);
    for (std::size_t i = 3; i < layout_.width; ++i) {
      if (layout_.normal > 0 && i == layout_.normal) {
        append_normal(bytes, origin);
        i += 2;
        continue;
      }
      const double value = interpolated(origin, at_origin(origin, [&](auto v) { return number(v, i); }));
      off::append_float(bytes, std::isfinite(value) ? value : number(origin.vertex[nearest(origin)], i));
    }
  }
  /// Appends the pieces of a face, with its colour.
  void append_faces(std::string& bytes, std::size_t f) const {
    const std::uint64_t colour = face_at_[f] + 4 * (1 + content_->mesh().face(f).size());
    for (std::uint32_t piece = content_->first_piece[f]; piece < content_->first_piece[f + 1]; ++piece) {
      off::append_corners(bytes, content_->refined().face(piece));
      bytes += source_.text().substr(colour, face_at_[f + 1] - colour);
    }
  }
  void append_rest(std::string& bytes) const { bytes += source_.text().substr(face_at_.back()); }

 private:
  double number(std::uint32_t v, std::size_t i) const {
    return off::number_at(source_, rows_of(source_).position_at[v].at[0] + 4 * i);
  }
  Vec3d normal(std::uint32_t v) const {
    return {number(v, layout_.normal), number(v, layout_.normal + 1), number(v, layout_.normal + 2)};
  }
  void append_normal(std::string& bytes, const VertexOrigin& origin) const {
    const Vec3d between = interpolated_normal(origin, at_origin(origin, [&](auto v) { return normal(v); }));
    const Vec3d& known = between.isFinite() ? between : normal(origin.vertex[nearest(origin)]);
    for (int k = 0; k < 3; ++k) off::append_float(bytes, known[k]);
  }

  SharedRefined content_;
  const MeshFile& source_;
  off::Layout layout_;
  std::vector<std::uint64_t> face_at_;
};

class TextOffRefiner {
 public:
  explicit TextOffRefiner(const SharedRefined& content)
      : content_(content), source_(content->source), rows_(source_), behind_vertices_(find_end_of_vertices()) {
    // Texture coordinates are the last two numbers; those in front of them are colours.
    std::size_t colours = 0;
    for (Scanner words = tail(0); !words.at_line_end(); words.token()) ++colours;
    const auto& extras = source_.extras;
    if (std::find(extras.begin(), extras.end(), "texture coordinates") != extras.end())
      colours -= std::min<std::size_t>(colours, 2);
    ByteColours bytes;
    for (std::size_t v = 0; colours > 0 && v < content->mesh().positions.size(); ++v) bytes.look_at(tail(v), colours);
    if (bytes.are_bytes()) byte_colours_ = colours;
  }

  /// All up to the added vertices.
  std::string start() const {
    std::string text = rows_.start(content_->refined().positions.size(), content_->refined().face_count());
    const std::size_t first = rows_.first_of_vertex(0);
    return text += source_.text().substr(first, behind_vertices_ - first);
  }
  void append_vertex(std::string& text, std::size_t added) const {
    const VertexOrigin& origin = content_->refinement.added[added];
    const Vec3d& position = content_->added_position(added);
    for (int k = 0; k < 3; ++k) {
      if (k > 0) text += ' ';
      append_number(text, position[k], source_.precision);
    }
    if (!rows_of(source_).normal_at.empty())
      append_interpolated_normal(text, origin, at_origin(origin, [&](auto v) { return normal(v); }));
    append_interpolated_words(text, origin, at_origin(origin, [&](auto v) { return tail(v); }), byte_colours_);
    text += rows_.line_end();
  }
  /// What stands between vertices and faces.
  void append_gap(std::string& text) const {
    text += source_.text().substr(behind_vertices_, rows_.faces().front() - behind_vertices_);
  }
  /// Appends the pieces of a face, with its colour, and what stands behind its line.
  void append_faces(std::string& text, std::size_t f) const {
    if (!content_->is_split(f)) {
      text += rows_.face(f);
      return;
    }
    for (std::uint32_t piece = content_->first_piece[f]; piece < content_->first_piece[f + 1]; ++piece)
      rows_.append_face(text, content_->refined().face(piece), f);
    Scanner words = rows_.behind_corners(f);
    std::size_t behind = words.position();
    for (; !words.at_line_end(); behind = words.position()) words.token();
    text.resize(text.size() - rows_.line_end().size());  // the last line ends as that of the face
    text += source_.text().substr(behind, rows_.faces()[f + 1] - behind);
  }

 private:
  std::size_t find_end_of_vertices() const {
    Scanner scanner = tail(static_cast<std::uint32_t>(content_->mesh().positions.size() - 1));
    scanner.next_line();
    return scanner.position();
  }
  Scanner tail(std::size_t v) const { return rows_.words(rows_.end_of_numbers(v)); }
  std::array<std::string_view, 3> normal(std::uint32_t v) const {
    const NumberTriple at = rows_of(source_).normal_at[v];
    return {rows_.words(at.at[0]).token(), rows_.words(at.at[1]).token(), rows_.words(at.at[2]).token()};
  }

  SharedRefined content_;
  const MeshFile& source_;
  off::TextRows rows_;
  std::size_t behind_vertices_;
  std::size_t byte_colours_ = 0;  // how many of the numbers behind a vertex's coordinates and normal are whole
};

}  // namespace

Pieces OffRows::refined(const std::shared_ptr<const RefinedContent>& content, std::vector<std::string>&) const {
  const std::size_t added = content->refinement.added.size(), faces = content->mesh().face_count();
  if (content->source.encoding != Encoding::Ascii) {
    const auto refiner = std::make_shared<const BinaryOffRefiner>(content);
    return in_sections(refiner->start(),
                       {{added, [=](std::string& bytes, std::size_t v) { refiner->append_vertex(bytes, v); }},
                        {faces, [=](std::string& bytes, std::size_t f) { refiner->append_faces(bytes, f); }},
                        {1, [=](std::string& bytes, std::size_t) { refiner->append_rest(bytes); }}});
  }
  const auto refiner = std::make_shared<const TextOffRefiner>(content);
  return in_sections(refiner->start(),
                     {{added, [=](std::string& text, std::size_t v) { refiner->append_vertex(text, v); }},
                      {1, [=](std::string& text, std::size_t) { refiner->append_gap(text); }},
                      {faces, [=](std::string& text, std::size_t f) { refiner->append_faces(text, f); }}});
}

}  // namespace vdb_offset::io
