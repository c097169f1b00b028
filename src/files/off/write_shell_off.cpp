// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bytes/append_number.h"
#include "derived/shell_writers.h"
#include "off/off_binary.h"
#include "off/off_document.h"
#include "off/off_rows.h"

// The file is the source's text up to its faces, with the positions of the outer skin and other counts; then all other
// vertices; the source's faces; all other faces.
namespace vdb_offset::io {
namespace {

/// Writes a binary file: the source's records with some numbers replaced.
class BinaryShellWriter {
 public:
  explicit BinaryShellWriter(const SharedShell& content)
      : content_(content),
        source_(content->source),
        shell_(content->shell),
        layout_(off::layout_of(source_)),
        face_at_(off::face_offsets(source_)) {}

  std::string start() const {
    std::string bytes(source_.text().substr(0, *off::binary_begin(source_)));
    off::append_count(bytes, shell_.polygons.positions.size());
    off::append_count(bytes, shell_.polygons.face_count());
    off::append_count(bytes, 0);
    return bytes;
  }
  void append_vertex(std::string& bytes, ShellPart part, std::size_t v) const {
    const Skin& skin = content_->skin(part);
    const std::uint64_t begin = rows_of(source_).position_at[v].at[0];
    const std::size_t start = bytes.size();
    bytes += source_.text().substr(begin, 4 * layout_.width);
    const auto put = [&](std::size_t first, const Vec3d& numbers) {
      std::string raw;
      for (int k = 0; k < 3; ++k) off::append_float(raw, numbers[k]);
      bytes.replace(start + 4 * first, raw.size(), raw);
    };
    if (const auto position = skin.new_position(v)) put(0, *position);
    if (layout_.normal == 0) return;
    const std::uint64_t at = begin + 4 * layout_.normal;
    if (const auto normal = skin.new_normal(v)) put(layout_.normal, *normal);
    else if (skin.is_reversed())
      put(layout_.normal, Vec3d(0.0) - Vec3d(off::number_at(source_, at), off::number_at(source_, at + 4),
                                             off::number_at(source_, at + 8)));
  }
  /// Appends a face, with the colour of the source's face.
  void append_face(std::string& bytes, std::size_t f) const {
    off::append_corners(bytes, shell_.polygons.view().face(f));
    const std::uint32_t of_mesh = shell_.source_face(f);
    const std::uint64_t colour = face_at_[of_mesh] + 4 * (1 + source_.polygons.view().face(of_mesh).size());
    bytes += source_.text().substr(colour, face_at_[of_mesh + 1] - colour);
  }

 private:
  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  off::Layout layout_;
  std::vector<std::uint64_t> face_at_;
};

Pieces shell_to_binary(const SharedShell& content) {
  const auto writer = std::make_shared<const BinaryShellWriter>(content);
  const std::size_t vertices = content->shell.source_vertices();
  return in_sections(
      writer->start(),
      {{vertices, [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, ShellPart::Outer, v); }},
       {vertices, [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, ShellPart::Inner, v); }},
       {content->shell.polygons.face_count(),
        [=](std::string& bytes, std::size_t f) { writer->append_face(bytes, f); }}});
}

class OffShellWriter {
 public:
  explicit OffShellWriter(const SharedShell& content)
      : content_(content), source_(content->source), shell_(content->shell), rows_(source_) {}

  /// The text up to the faces, without the inner skin.
  std::string start() const { return rows_.start(shell_.polygons.positions.size(), shell_.polygons.face_count()); }
  /// Appends a vertex of the outer skin, with the rest of its line and the comments after it.
  void append_outer_vertex(std::string& text, std::size_t v) const {
    append_numbers(text, content_->outer, v);
    const std::size_t begin = rows_.end_of_numbers(v),
                      end = v + 1 < shell_.source_vertices() ? rows_.first_of_vertex(v + 1) : rows_.faces().front();
    append_line(text, source_.text().substr(begin, end - begin));
  }
  /// Appends a vertex of the inner skin or a split.
  void append_other_vertex(std::string& text, std::size_t i) const {
    const auto [skin, v] = content_->vertex(static_cast<std::uint32_t>(shell_.source_vertices() + i));
    append_numbers(text, skin, v);
    rows_.append_words(text, rows_.words(rows_.end_of_numbers(skin.source_of(v))));
  }
  void append_outer_face(std::string& text, std::size_t f) const {
    const std::uint32_t row = shell_.source_face(f);
    if (!std::ranges::equal(shell_.polygons.view().face(f), source_.polygons.view().face(row)))
      append_new_face(text, f);
    else append_line(text, rows_.face(row));
  }
  /// Appends a face of the inner skin or the rim.
  void append_other_face(std::string& text, std::size_t i) const { append_new_face(text, shell_.skin_faces() + i); }

 private:
  void append_new_face(std::string& text, std::size_t f) const {
    rows_.append_face(text, shell_.polygons.view().face(f), shell_.source_face(f));
  }

  static void append_numbers(std::string& text, const Skin& skin, std::size_t v, bool has_normals) {
    std::string numbers;
    skin.append_position(numbers, v);
    if (has_normals) skin.append_normal(numbers, v);
    text.append(numbers, 1);
  }
  void append_numbers(std::string& text, const Skin& skin, std::size_t v) const {
    append_numbers(text, skin, v, !rows_of(source_).normal_at.empty());
  }

  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  off::TextRows rows_;
};

}  // namespace

Pieces OffRows::with_shell(const std::shared_ptr<const ShellContent>& content, std::vector<std::string>& lost) const {
  lost.emplace_back(kShellParts);
  if (content->source.encoding != Encoding::Ascii) return shell_to_binary(content);
  const auto writer = std::make_shared<const OffShellWriter>(content);
  const Shell& shell = content->shell;
  return in_sections(
      writer->start(),
      {{shell.source_vertices(), [=](std::string& text, std::size_t v) { writer->append_outer_vertex(text, v); }},
       {shell.source_vertices() + shell.splits.size(),
        [=](std::string& text, std::size_t i) { writer->append_other_vertex(text, i); }},
       {shell.skin_faces(), [=](std::string& text, std::size_t f) { writer->append_outer_face(text, f); }},
       {shell.polygons.face_count() - shell.skin_faces(),
        [=](std::string& text, std::size_t i) { writer->append_other_face(text, i); }}});
}

}  // namespace vdb_offset::io
