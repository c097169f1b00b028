// SPDX-License-Identifier: Apache-2.0
// Writes an OFF file, text or binary, over a mesh that is made of its own. The counts are replaced, that of edges by 0.
// The source's vertices keep all but the numbers that change, and those that were added follow them: a copy has what
// its vertex has; another one a unit normal between those at its origin, and the other numbers interpolated by its
// shares, as whole numbers in a text where colours are bytes. Where one of these numbers is not finite, that of the
// nearest vertex counts. Faces have the colour of their parent. In a text, what stood behind the line of a face follows
// the last face in its place, and all lines that do not change keep their bytes, comments and what stands at the end
// included.
#include <algorithm>
#include <cmath>

#include "bytes/append_number.h"
#include "derived/derived_mesh.h"
#include "derived/interpolate.h"
#include "document/convert.h"
#include "off/off_binary.h"
#include "off/off_document.h"
#include "off/off_rows.h"

namespace vdb_offset::io {
namespace {

class BinaryOffDeriver {
 public:
  explicit BinaryOffDeriver(SharedDerived derived)
      : derived_(std::move(derived)),
        source_(derived_->source()),
        layout_(off::layout_of(source_)),
        face_at_(off::face_offsets(source_)) {}

  std::string start() const {
    std::string bytes(source_.text().substr(0, *off::binary_begin(source_)));
    off::append_count(bytes, derived_->mesh().positions.size());
    off::append_count(bytes, derived_->face_count());
    off::append_count(bytes, 0);
    return bytes;
  }
  std::pair<std::size_t, std::size_t> vertices() const {
    return {rows_of(source_).position_at[0].at[0], face_at_.front()};
  }
  void append_vertex(std::string& bytes, std::size_t added) const {
    const auto v = static_cast<std::uint32_t>(derived_->source_vertices() + added);
    const VertexOrigin origin = derived_->origin(v);
    const std::size_t start = bytes.size();
    bytes +=
        source_.text().substr(rows_of(source_).position_at[origin.vertex[nearest(origin)]].at[0], 4 * layout_.width);
    const auto put = [&](std::size_t at, double number) {
      std::string raw;
      off::append_float(raw, number);
      bytes.replace(start + 4 * at, raw.size(), raw);
    };
    for (std::size_t i = 3; i < layout_.width && !derived_->is_copy(v); ++i) {
      const double value = interpolated(origin, at_origin(origin, [&](auto of) { return number(of, i); }));
      if (std::isfinite(value) && !(layout_.normal > 0 && i < layout_.normal + 3 && i >= layout_.normal)) put(i, value);
    }
    const auto put_all = [&](std::size_t at, const std::optional<Vec3d>& numbers) {
      for (std::size_t k = 0; numbers && k < 3; ++k) put(at + k, (*numbers)[static_cast<int>(k)]);
    };
    put_all(0, derived_->new_position(v));
    if (layout_.normal > 0)
      put_all(layout_.normal, derived_->vertex_normal(v, at_origin(origin, [&](auto of) { return normal(of); })));
  }
  void append_face(std::string& bytes, std::uint32_t f) const {
    const std::uint32_t parent = derived_->parent(f);
    off::append_corners(bytes, derived_->mesh().face(f));
    const std::uint64_t colour = face_at_[parent] + 4 * (1 + derived_->source_mesh().face(parent).size());
    bytes += source_.text().substr(colour, face_at_[parent + 1] - colour);
  }
  void append_rest(std::string& bytes) const { bytes += source_.text().substr(face_at_.back()); }

 private:
  double number(std::uint32_t v, std::size_t i) const {
    return off::number_at(source_, rows_of(source_).position_at[v].at[0] + 4 * i);
  }
  Vec3d normal(std::uint32_t v) const {
    return {number(v, layout_.normal), number(v, layout_.normal + 1), number(v, layout_.normal + 2)};
  }

  SharedDerived derived_;
  const MeshFile& source_;
  off::Layout layout_;
  std::vector<std::uint64_t> face_at_;
};

class TextOffDeriver {
 public:
  explicit TextOffDeriver(SharedDerived derived)
      : derived_(std::move(derived)), source_(derived_->source()), rows_(source_) {
    if (derived_->is_shell()) return;
    // Texture coordinates are the last two numbers; those in front of them are colours.
    std::size_t colours = 0;
    for (Scanner words = tail(0); !words.at_line_end(); words.token()) ++colours;
    const auto& extras = source_.extras;
    if (std::find(extras.begin(), extras.end(), "texture coordinates") != extras.end())
      colours -= std::min<std::size_t>(colours, 2);
    ByteColours bytes;
    for (std::uint32_t v = 0; colours > 0 && v < derived_->source_vertices(); ++v) bytes.look_at(tail(v), colours);
    if (bytes.are_bytes()) byte_colours_ = colours;
  }

  std::string start() const { return rows_.start(derived_->mesh().positions.size(), derived_->face_count()); }
  std::pair<std::size_t, std::size_t> vertices() const {
    Scanner scanner = tail(derived_->source_vertices() - 1);
    scanner.next_line();
    return {rows_.first_of_vertex(0), scanner.position()};
  }
  void append_vertex(std::string& text, std::size_t added) const {
    const auto v = static_cast<std::uint32_t>(derived_->source_vertices() + added);
    const VertexOrigin origin = derived_->origin(v);
    std::string numbers;
    derived_->append_position(numbers, v);
    if (!rows_of(source_).normal_at.empty())
      for (const std::string& word : derived_->vertex_normal_words(v)) (numbers += ' ') += word;
    text.append(numbers, 1);
    append_interpolated_words(text, origin, at_origin(origin, [&](auto of) { return tail(of); }), byte_colours_);
    text += rows_.line_end();
  }
  /// What stands between vertices and faces.
  void append_gap(std::string& text) const {
    const std::size_t end = vertices().second;
    text += source_.text().substr(end, rows_.faces().front() - end);
  }
  /// Appends the faces in the place of one of the source's, and what stands behind its line.
  void append_faces(std::string& text, std::uint32_t of) const {
    const FaceRange pieces = derived_->pieces_of(of);
    if (pieces.size() == 0) return;
    if (derived_->is_kept(of)) {
      text += rows_.face(of);
    } else {
      for (std::uint32_t f = pieces.begin; f < pieces.end; ++f) append_face(text, f);
      Scanner words = rows_.behind_corners(of);
      std::size_t behind = words.position();
      for (; !words.at_line_end(); behind = words.position()) words.token();
      text.resize(text.size() - rows_.line_end().size());  // the last line ends as that of the face
      text += source_.text().substr(behind, rows_.faces()[of + 1] - behind);
    }
    if (derived_->other_faces().size() > 0 && !text.ends_with('\n')) text += rows_.line_end();
  }
  void append_face(std::string& text, std::uint32_t f) const {
    rows_.append_face(text, derived_->mesh().face(f), derived_->parent(f));
  }

 private:
  Scanner tail(std::uint32_t v) const { return rows_.words(rows_.end_of_numbers(v)); }

  SharedDerived derived_;
  const MeshFile& source_;
  off::TextRows rows_;
  std::size_t byte_colours_ = 0;  // how many of the numbers behind a vertex's coordinates and normal are whole
};

}  // namespace

WrittenDocument OffRows::derive(const SharedDerived& derived, const std::string&) const {
  WrittenDocument written;
  if (derived->is_shell()) written.lost.emplace_back(kShellParts);
  const FaceRange others = derived->other_faces();
  const auto number = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  const auto put_together = [&](const auto& deriver, Section before_faces, Section faces, Section behind) {
    const auto [begin, end] = deriver->vertices();
    const auto append_vertex = [=](std::string& bytes, std::size_t v) { deriver->append_vertex(bytes, v); };
    const auto append_other = [=](std::string& bytes, std::size_t i) {
      deriver->append_face(bytes, others.begin + number(i));
    };
    written.file = in_a_row({in_sections(deriver->start(), {}), derived->rows_in_place(begin, end),
                             in_sections({}, {{derived->added_vertices(), append_vertex},
                                              std::move(before_faces),
                                              std::move(faces),
                                              {others.size(), append_other},
                                              std::move(behind)})});
  };
  if (derived->source().encoding == Encoding::Ascii) {
    const auto deriver = std::make_shared<const TextOffDeriver>(derived);
    put_together(deriver, {1, [=](std::string& text, std::size_t) { deriver->append_gap(text); }},
                 {derived->source_mesh().face_count(),
                  [=](std::string& text, std::size_t f) { deriver->append_faces(text, number(f)); }},
                 {});
  } else {
    const auto deriver = std::make_shared<const BinaryOffDeriver>(derived);
    put_together(deriver, {},
                 {others.begin, [=](std::string& bytes, std::size_t f) { deriver->append_face(bytes, number(f)); }},
                 {1, [=](std::string& bytes, std::size_t) { deriver->append_rest(bytes); }});
  }
  return written;
}

}  // namespace vdb_offset::io
