// SPDX-License-Identifier: Apache-2.0
// Reads the header of a PLY file, and the numbers behind it one after the other. The header says which elements there
// are, how many of each, and the types of their properties; a header whose lines end with carriage returns alone is
// recognised by its first line. No element may have more rows than the file has bytes, so that a count cannot ask for
// memory that the file does not back. BodyReader takes or skips numbers of a text or of binary data in either byte
// order, and its errors say the line or the byte. Whether a file has faces or strips of triangles is decided here; what
// the numbers mean is up to the reader (read_ply.cpp).
#include "ply/ply_header.h"

#include <fmt/format.h>

#include "vdb_offset/run.h"

namespace vdb_offset::io::ply {
namespace {

std::optional<Type> type_of(std::string_view name) {
  constexpr std::pair<std::string_view, Type> kTypes[] = {
      {"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
      {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
      {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}},
      {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}}};
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  return std::nullopt;
}

Type read_type(Scanner& scanner) {
  const std::string_view word = scanner.token();
  const auto type = type_of(word);
  if (!type) scanner.fail("a PLY type", scanner.position() - word.size());
  return *type;
}

Property read_property(Scanner& scanner) {
  Property property;
  if (Scanner(scanner).token() == "list") {
    scanner.token();
    property.count = read_type(scanner);
    if (property.count->kind == 'f') scanner.fail("an integer type for the length of a list");
  }
  property.type = read_type(scanner);
  property.name = scanner.token();
  if (property.name.empty()) scanner.fail("the name of a property");
  return property;
}

Encoding read_encoding(Scanner& scanner) {
  const std::string_view word = scanner.token();
  if (word == "ascii") return Encoding::Ascii;
  if (word == "binary_little_endian") return Encoding::LittleEndian;
  if (word == "binary_big_endian") return Encoding::BigEndian;
  scanner.fail("ascii, binary_little_endian or binary_big_endian", scanner.position() - word.size());
}

}  // namespace

const Element* find(const Header& header, std::string_view element) {
  for (const Element& known : header.elements)
    if (known.name == element) return &known;
  return nullptr;
}

bool is_corner_list(const Property& p) {
  return p.count && p.type.kind != 'f' && (p.name == "vertex_indices" || p.name == "vertex_index");
}

namespace {

const Element* find_with_corners(const Header& header, std::string_view name) {
  const Element* const found = find(header, name);
  return found && std::any_of(found->properties.begin(), found->properties.end(), is_corner_list) ? found : nullptr;
}

}  // namespace

const Element* find_faces(const Header& header) { return find_with_corners(header, "face"); }

const Element* find_strips(const Header& header) {
  if (const Element* const faces = find_faces(header); faces && faces->count > 0) return nullptr;
  return find_with_corners(header, "tristrips");
}

Header read_header(const MeshFile& file) {
  Scanner scanner(file.path, file.text());
  if (scanner.token() != "ply") scanner.fail("the keyword ply", 0);
  Header header;
  const std::size_t first_end = file.text().find_first_of("\r\n");
  if (first_end < file.text().size() && file.text()[first_end] == '\r' &&
      !file.text().substr(first_end + 1).starts_with('\n')) {
    header.line_end = '\r';
    scanner.end_lines_with('\r');
  }
  bool has_format = false;
  for (;;) {
    scanner.next_line();
    if (scanner.at_end()) scanner.fail("a header line or 'end_header'");
    const std::string_view keyword = scanner.token();
    if (keyword == "format") {
      header.encoding = read_encoding(scanner);
      has_format = true;
    } else if (keyword == "element") {
      Element& element = header.elements.emplace_back();
      element.name = scanner.token();
      const std::int64_t count = scanner.integer("a number of elements");
      // Each row takes a byte at least, so that a file has no more rows than bytes. (Rows without properties take none,
      // but hold nothing either.)
      if (count < 0 || static_cast<std::uint64_t>(count) > file.text().size())
        scanner.fail(
            fmt::format("a number of '{}' that {} bytes can hold, not {},", element.name, file.text().size(), count));
      element.count = static_cast<std::size_t>(count);
    } else if (keyword == "property") {
      if (header.elements.empty()) scanner.fail("an element before its properties");
      header.elements.back().properties.push_back(read_property(scanner));
    } else if (keyword == "end_header") {
      break;
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      scanner.fail("a header line", scanner.position() - keyword.size());
    }
  }
  if (!has_format) scanner.fail("a 'format' line before the end of the header");
  scanner.next_line();
  header.end = scanner.position();
  return header;
}

double BodyReader::take(Type type, const char* what, std::uint64_t& at) {
  if (encoding_ == Encoding::Ascii) {
    if (text_.at_text_end()) text_.fail(what);
    Scanner before = text_;
    const std::string_view word = before.token();
    at = before.position() - word.size();
    return type.kind == 'f' ? as_declared(type, text_.number(what)) : static_cast<double>(text_.integer(what));
  }
  at = at_;
  return take_binary(type, what);
}

double BodyReader::take_binary(Type type, const char* what) {
  if (file_.text().size() - at_ < type.bytes) truncated(what);
  at_ += type.bytes;
  return binary_number(file_.text().data() + at_ - type.bytes, type, encoding_);
}

std::size_t BodyReader::take_length(const Property& list) {
  std::uint64_t at = 0;
  const double count = take(*list.count, "the length of a list", at);
  if (count < 0) fail("a list length from 0 on", fmt::format("{}", count), at);
  return static_cast<std::size_t>(count);
}

std::uint64_t BodyReader::skip_number(Type type, const char* what) {
  if (encoding_ == Encoding::Ascii) {
    text_.token_anywhere(what);
    return text_.last_token();
  }
  skip(type, 1, what);
  return at_ - type.bytes;
}

void BodyReader::skip(Type type, std::size_t count, const char* what) {
  if (encoding_ == Encoding::Ascii) {
    for (std::size_t i = 0; i < count; ++i) text_.token_anywhere(what);
    return;
  }
  if (count > (file_.text().size() - at_) / type.bytes) truncated(what);
  at_ += count * type.bytes;
}

void BodyReader::skip(const Property& property) {
  if (property.count) skip(property.type, take_length(property), "an item of a list");
  else skip(property.type, 1, "a property");
}

void BodyReader::skip_to(const Element& element, const Header& header) {
  for (auto before = header.elements.begin(); before->name != element.name; ++before)
    for (std::size_t row = 0; row < before->count && !before->properties.empty(); ++row)
      for (const Property& property : before->properties) skip(property);
}

void BodyReader::go_to(std::size_t at) {
  if (encoding_ == Encoding::Ascii) text_ = Scanner(file_.path, file_.text(), at);
  else at_ = at;
}

void BodyReader::fail(const std::string& expected, const std::string& found, std::uint64_t at) const {
  if (encoding_ == Encoding::Ascii) text_.fail_with(expected, found, at);
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", file_.path, at, expected, found));
}

void BodyReader::truncated(const char* what) const {
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got the end of the file", file_.path, at_, what));
}

}  // namespace vdb_offset::io::ply
