// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ply/ply_header.h"

/// The rows of a PLY file, for those who write other rows of the same kind.
namespace vdb_offset::io::ply {

/// Appends the bytes of a number as a type. \pre the type can hold it
void append_binary_as(std::string& bytes, double value, Type type, Encoding encoding);

/// The type for vertex numbers up to `last`: that of the list, or else one that can hold them.
Type index_type(const Property& list, std::uint64_t last);

/// What is different in the header of another file.
struct HeaderChanges {
  std::size_t vertices, faces;
  Type index_type;            ///< Of faces' corners.
  const char* face_property;  ///< Another property of faces, behind the others: a name, and it is `uchar`; may be null.
};

/// A word of a text or the bytes of a number, and where the next one begins.
struct Cell {
  std::string_view raw;
  std::size_t end;
};

/// Finds rows and reads what they hold. Refers to the file.
class Rows {
 public:
  /// \throw InvalidInput unless the file has as many vertices and faces as the mesh that was read from it
  explicit Rows(const MeshFile& source);
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  const Element& vertices() const { return *vertices_; }
  const Element& faces() const { return *faces_; }
  const Property& corner_list() const { return *corner_list_; }
  const std::vector<Element>& elements() const { return header_.elements; }
  bool is_text() const { return header_.encoding == Encoding::Ascii; }
  Encoding encoding() const { return header_.encoding; }

  /// Where each row begins, and where the last one ends. In a text, blanks and line ends are in front of a row.
  const std::vector<std::uint64_t>& vertex_rows() const { return vertex_row_; }
  const std::vector<std::uint64_t>& face_rows() const { return face_row_; }
  /// The bytes of all rows of an element, and what stands behind all elements.
  std::string_view of_element(std::size_t i) const { return bytes(element_begin_[i], element_begin_[i + 1]); }
  std::string_view rest() const { return source_.text().substr(element_begin_.back()); }
  std::string_view bytes(std::uint64_t begin, std::uint64_t end) const {
    return source_.text().substr(begin, end - begin);
  }

  /// The source's header with other numbers of vertices and faces, and with new properties of these.
  std::string header_with(const HeaderChanges& changes) const;
  /// How the header's lines end.
  const std::string& line_end() const { return line_end_; }

  Cell cell_at(Type type, std::size_t at) const;
  std::size_t length_in(const Cell& cell, Type type) const;
  /// The items of a list whose length is in a cell. `at` becomes the place behind them.
  std::vector<std::string_view> items_of(const Property& list, const Cell& length, std::size_t& at) const;

  // A row begins at byte `start` of `bytes`. In a text, its numbers are separated by blanks.
  void separate(std::string& bytes, std::size_t start) const {
    if (is_text() && bytes.size() > start) bytes += ' ';
  }
  void append_cell(std::string& bytes, std::size_t start, const Cell& cell) const {
    separate(bytes, start);
    bytes += cell.raw;
  }
  void append_whole_number(std::string& bytes, std::size_t start, double value, Type type) const;
  void append_corners(std::string& bytes, std::size_t start, std::span<const std::uint32_t> face, Type index) const;
  /// Copies a property of a row. Returns where the next property begins.
  std::size_t append_as_it_is(std::string& bytes, std::size_t start, const Property& property, std::size_t at) const;
  std::size_t end_of(const Property& property, std::size_t at) const;

 private:
  const Element& element(const char* name, std::size_t count) const;
  void find_rows();

  const MeshFile& source_;
  Header header_;
  const Element *vertices_, *faces_;
  const Property* corner_list_;
  std::string line_end_;
  std::vector<std::uint64_t> vertex_row_, face_row_, element_begin_;
};

}  // namespace vdb_offset::io::ply
