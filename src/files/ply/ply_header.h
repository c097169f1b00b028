// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/scanner.h"
#include "document/binary_number.h"
#include "vdb_offset/io/mesh_file.h"

/// The header of a PLY file, and the numbers behind it.
namespace vdb_offset::io::ply {

using Type = NumberType;

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // the type of a list's length; none for a single number
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::size_t end = 0;   // first byte of the body
  char line_end = '\n';  // of the header's lines: a carriage return if no line feed follows the first one
};

/// The first element with a name, or none.
const Element* find(const Header& header, std::string_view element);

/// Whether a property is the list of a face's corners, or of those of strips of triangles.
bool is_corner_list(const Property& property);

/// The element 'face', if its rows have corners.
const Element* find_faces(const Header& header);
/// Strips of triangles instead of faces: each three corners in a row are a triangle, every other one turned round,
/// and -1 ends a strip. None if there are faces.
const Element* find_strips(const Header& header);

/// Reads the header of a file. \throw InvalidInput
Header read_header(const MeshFile& file);

/// Rounds a number of a text to its declared type: other programs read no more digits.
inline double as_declared(Type type, double value) {
  return type.bytes == 4 ? static_cast<double>(static_cast<float>(value)) : value;
}

/// Reads the numbers of a file's body, text or binary, one after the other. Refers to `file`.
class BodyReader {
 public:
  BodyReader(const MeshFile& file, const Header& header)
      : file_(file), text_(file.path, file.text(), header.end), at_(header.end), encoding_(header.encoding) {}

  /// Reads a number; `at` receives its first byte. Integers above 2^53 are rounded, and do not occur where they matter.
  double take(Type type, const char* what, std::uint64_t& at);
  /// The length of a list, from 0 on.
  std::size_t take_length(const Property& list);
  /// Skips a number, such as one of a normal, which may be a NaN. Returns its first byte.
  std::uint64_t skip_number(Type type, const char* what);
  void skip(Type type, std::size_t count, const char* what);
  void skip(const Property& property);
  /// Goes from the start of the body to an element's first row.
  void skip_to(const Element& element, const Header& header);

  std::size_t position() const { return encoding_ == Encoding::Ascii ? text_.position() : at_; }
  void go_to(std::size_t at);
  [[noreturn]] void fail(const std::string& expected, const std::string& found, std::uint64_t at) const;

 private:
  double take_binary(Type type, const char* what);
  [[noreturn]] void truncated(const char* what) const;

  const MeshFile& file_;
  Scanner text_;
  std::size_t at_;
  Encoding encoding_;
};

}  // namespace vdb_offset::io::ply
