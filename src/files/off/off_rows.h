// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/scanner.h"
#include "document/rows.h"
#include "vdb_offset/io/mesh_file.h"

/// The rows of an OFF file, for those who write other rows of the same kind.
namespace vdb_offset::io::off {

/// Appends a number of four bytes, as binary files have them.
void append_float(std::string& bytes, double value);
void append_count(std::string& bytes, std::size_t value);
/// Appends a face without the colour behind it.
void append_corners(std::string& bytes, std::span<const std::uint32_t> face);

/// Where the rows of a text are. Refers to the file.
class TextRows {
 public:
  /// \throw InvalidInput if the file has changed since it was read
  explicit TextRows(const MeshFile& source);

  /// The text in front of the first vertex, with other counts. The number of edges becomes 0, which is to say that
  /// they are not counted.
  std::string start(std::size_t vertices, std::size_t faces) const;
  std::size_t first_of_vertex(std::size_t v) const { return rows_of(source_).position_at[v].at[0]; }
  /// The byte behind a vertex's coordinates and its normal, if it has one.
  std::size_t end_of_numbers(std::size_t v) const;
  /// Where each face begins, and the end of the text: what stands behind the last face belongs to it.
  const std::vector<std::uint64_t>& faces() const { return face_row_; }
  /// A face's line with all that follows it.
  std::string_view face(std::size_t f) const {
    return source_.text().substr(face_row_[f], face_row_[f + 1] - face_row_[f]);
  }
  /// Walks over the words of a line from a byte on.
  Scanner words(std::size_t at) const { return {source_.path, source_.text(), at, false, '#'}; }
  /// The words of a face behind its corners: its colour.
  Scanner behind_corners(std::size_t f) const;
  /// Appends a face of other corners, with the colour of face f, and the end of its line.
  void append_face(std::string& text, std::span<const std::uint32_t> corners, std::size_t f) const;

  /// Appends the words that have not been read, each behind a blank, and the end of the line.
  void append_words(std::string& text, Scanner words) const;
  std::string_view line_end() const { return line_end_; }

 private:
  void find_counts();
  void find_faces();

  const MeshFile& source_;
  std::string_view line_end_;
  std::size_t counts_begin_ = 0, counts_end_ = 0;
  std::vector<std::uint64_t> face_row_;
};

}  // namespace vdb_offset::io::off
