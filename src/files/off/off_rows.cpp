// SPDX-License-Identifier: Apache-2.0
#include "off/off_rows.h"

#include <algorithm>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/line_records.h"

namespace vdb_offset::io::off {
namespace {

template <class T>
void append_big(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

}  // namespace

void append_float(std::string& bytes, double value) { append_big(bytes, static_cast<float>(value)); }
void append_count(std::string& bytes, std::size_t value) { append_big(bytes, static_cast<std::int32_t>(value)); }

void append_corners(std::string& bytes, std::span<const std::uint32_t> face) {
  append_count(bytes, face.size());
  for (const auto v : face) append_count(bytes, v);
}

TextRows::TextRows(const MeshFile& source) : source_(source), line_end_(line_end_of(source.text())) {
  find_counts();
  find_faces();
}

/// Finds the counts behind the keyword: of vertices, of faces and, if it is there, of edges.
void TextRows::find_counts() {
  Scanner scanner = words(byte_order_mark(source_.text()));
  scanner.token_anywhere("the keyword OFF");
  scanner.token_anywhere("a number of vertices");
  counts_begin_ = scanner.last_token();
  const bool a_line_each = scanner.at_line_end();
  scanner.token_anywhere("a number of faces");
  counts_end_ = scanner.position();
  if (!a_line_each && scanner.at_line_end()) return;
  scanner.token_anywhere("a number of edges");
  counts_end_ = scanner.position();
}

void TextRows::find_faces() {
  Scanner scanner = words(end_of_numbers(source_.polygons.positions.size() - 1));
  const std::size_t faces = source_.polygons.face_count();
  face_row_.reserve(faces + 1);
  for (std::size_t f = 0; f < faces; ++f) {
    scanner.next_line();
    if (scanner.at_text_end()) scanner.fail("a face");
    face_row_.push_back(scanner.position());
  }
  face_row_.push_back(source_.text().size());
}

std::string TextRows::start(std::size_t vertices, std::size_t faces) const {
  std::string text(source_.text().substr(0, counts_begin_));
  append_integer(text, vertices);
  append_integer(text += ' ', faces);
  text += " 0";
  return text += source_.text().substr(counts_end_, first_of_vertex(0) - counts_end_);
}

std::size_t TextRows::end_of_numbers(std::size_t v) const {
  const ByteOffsets& last =
      rows_of(source_).normal_at.empty() ? rows_of(source_).position_at : rows_of(source_).normal_at;
  Scanner scanner = words(last[v].at[2]);
  scanner.token();
  return scanner.position();
}

Scanner TextRows::behind_corners(std::size_t f) const {
  Scanner scanner = words(face_row_[f]);
  for (std::size_t k = 0; k <= source_.polygons.view().face(f).size(); ++k) scanner.token_anywhere("a face");
  return scanner;
}

void TextRows::append_face(std::string& text, std::span<const std::uint32_t> corners, std::size_t f) const {
  append_integer(text, corners.size());
  for (const auto v : corners) append_integer(text += ' ', v);
  append_words(text, behind_corners(f));
}

void TextRows::append_words(std::string& text, Scanner words) const {
  while (!words.at_line_end()) (text += ' ') += words.token();
  text += line_end_;
}

}  // namespace vdb_offset::io::off
