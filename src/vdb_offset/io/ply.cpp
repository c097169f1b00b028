#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "vdb_offset/error.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"

namespace vdb_offset::io {
namespace {

struct Type {
  char kind;  // 'i' signed, 'u' unsigned, 'f' floating
  std::uint8_t bytes;
};

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

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

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::size_t end = 0;  // first byte of the body
};

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

Header read_header(const MeshFile& file) {
  Scanner scanner(file.path, file.bytes);
  if (scanner.token() != "ply") scanner.fail("the keyword ply", 0);
  Header header;
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
      // A row of one byte is the least there is; a row without properties takes none and is of no use.
      if (count < 0 || static_cast<std::uint64_t>(count) > file.bytes.size())
        scanner.fail(
            fmt::format("a number of '{}' that {} bytes can hold, not {},", element.name, file.bytes.size(), count));
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

/// Takes numbers of either kind off the body, one after the other.
class Body {
 public:
  Body(const MeshFile& file, const Header& header)
      : file_(file), text_(file.path, file.bytes, header.end), at_(header.end), encoding_(header.encoding) {}

  /// `at` receives the number's first byte. Numbers above 2^53 do not occur in what is used.
  double take(Type type, const char* what, std::uint64_t& at) {
    if (encoding_ == Encoding::Ascii) {
      if (text_.at_text_end()) text_.fail(what);
      Scanner before = text_;
      const std::string_view word = before.token();
      at = before.position() - word.size();
      return type.kind == 'f' ? text_.number(what) : static_cast<double>(text_.integer(what));
    }
    at = at_;
    return take_binary(type, what);
  }
  /// First byte of a number whose value does not matter: a normal, which may be a NaN.
  std::uint64_t place(Type type, const char* what) {
    if (encoding_ == Encoding::Ascii) {
      text_.token_anywhere(what);
      return text_.last_token();
    }
    skip(type, 1, what);
    return at_ - type.bytes;
  }
  void skip(Type type, std::size_t count, const char* what) {
    if (encoding_ == Encoding::Ascii) {
      for (std::size_t i = 0; i < count; ++i) text_.token_anywhere(what);
      return;
    }
    if (count > (file_.bytes.size() - at_) / type.bytes) truncated(what);
    at_ += count * type.bytes;
  }
  [[noreturn]] void fail(const std::string& expected, const std::string& found, std::uint64_t at) const {
    if (encoding_ == Encoding::Ascii) text_.fail_with(expected, found, at);
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", file_.path, at, expected, found));
  }

 private:
  double take_binary(Type type, const char* what) {
    if (file_.bytes.size() - at_ < type.bytes) truncated(what);
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), file_.bytes.data() + at_, type.bytes);
    if (encoding_ == Encoding::BigEndian) std::reverse(raw.begin(), raw.begin() + type.bytes);
    at_ += type.bytes;
    if (type.kind == 'f') return type.bytes == 4 ? load<float>(raw) : load<double>(raw);
    if (type.kind == 'u')
      return type.bytes == 1   ? load<std::uint8_t>(raw)
             : type.bytes == 2 ? load<std::uint16_t>(raw)
                               : load<std::uint32_t>(raw);
    return type.bytes == 1   ? load<std::int8_t>(raw)
           : type.bytes == 2 ? load<std::int16_t>(raw)
                             : load<std::int32_t>(raw);
  }
  template <class T>
  static double load(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return static_cast<double>(value);
  }
  [[noreturn]] void truncated(const char* what) const {
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got the end of the file", file_.path, at_, what));
  }

  const MeshFile& file_;
  Scanner text_;
  std::size_t at_;
  Encoding encoding_;
};

class PlyParser {
 public:
  explicit PlyParser(MeshFile& file) : file_(file), header_(read_header(file)), body_(file, header_) {}

  void run() {
    file_.encoding = header_.encoding;
    if (!find("vertex")) missing("an element 'vertex'");
    const Element* faces = find("face");
    if (!faces || std::none_of(faces->properties.begin(), faces->properties.end(), is_corner_list))
      missing("an element 'face' with a list 'vertex_indices'");
    for (const Element& element : header_.elements) {
      if (element.name == "vertex") read_vertices(element);
      else if (element.name == "face") read_faces(element);
      else {
        for (std::size_t i = 0; i < element.count; ++i)
          for (const Property& property : element.properties) skip(property);
        file_.extras.push_back("element '" + element.name + "'");
      }
    }
    if (file_.polygons.face_count() == 0) missing("at least one face");
    check_indices();
  }

 private:
  static bool is_corner_list(const Property& p) {
    return p.count && p.type.kind != 'f' && (p.name == "vertex_indices" || p.name == "vertex_index");
  }
  const Element* find(std::string_view name) const {
    for (const Element& element : header_.elements)
      if (element.name == name) return &element;
    return nullptr;
  }
  [[noreturn]] void missing(const char* what) const {
    throw InvalidInput(fmt::format("{}, header: expected {}, got none", file_.path, what));
  }

  void skip(const Property& property) {
    std::uint64_t at = 0;
    if (!property.count) return body_.skip(property.type, 1, "a property");
    const double count = body_.take(*property.count, "the length of a list", at);
    if (count < 0) body_.fail("a list length from 0 on", fmt::format("{}", count), at);
    body_.skip(property.type, static_cast<std::size_t>(count), "an item of a list");
  }

  void read_vertices(const Element& element) {
    // Which component, 0..2 of the position and 3..5 of the normal, each property is; -1 for none.
    constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
    std::vector<int> component;
    int found = 0;
    for (const Property& p : element.properties) {
      const auto* name = p.count ? std::end(kNames) : std::find(std::begin(kNames), std::end(kNames), p.name);
      component.push_back(name == std::end(kNames) ? -1 : static_cast<int>(name - kNames));
      if (component.back() < 0) file_.extras.push_back("vertex property '" + p.name + "'");
      else found |= 1 << component.back();
      if (component.back() >= 0 && p.type.kind != 'f') missing("floating-point coordinates and normals");
      if (component.back() == 0) file_.position_bytes = p.type.bytes;
      if (component.back() == 3) file_.normal_bytes = p.type.bytes;
    }
    if ((found & 7) != 7) missing("vertex properties x, y and z");
    for (std::size_t i = 0; i < component.size(); ++i)
      if (component[i] >= 0 &&
          element.properties[i].type.bytes != (component[i] < 3 ? file_.position_bytes : file_.normal_bytes))
        missing("one type for all coordinates");
    const bool normals = (found & 56) == 56;
    if (normals) file_.extras.emplace_back("normals");
    for (std::size_t v = 0; v < element.count; ++v) {
      Vec3d position(0.0);
      NumberTriple at[2] = {};
      for (std::size_t i = 0; i < component.size(); ++i) {
        if (component[i] < 0) {
          skip(element.properties[i]);
          continue;
        }
        const auto c = static_cast<std::size_t>(component[i]);
        if (c >= 3) {
          at[1].at[c - 3] = body_.place(element.properties[i].type, "a component of a normal");
          continue;
        }
        const double value = body_.take(element.properties[i].type, "a coordinate", at[0].at[c]);
        if (!std::isfinite(value)) body_.fail("a finite coordinate", fmt::format("{}", value), at[0].at[c]);
        position[static_cast<int>(c)] = value;
      }
      file_.polygons.positions.push_back(position);
      file_.position_at.push_back(at[0]);
      if (normals) file_.normal_at.push_back(at[1]);
    }
    if (file_.encoding == Encoding::Ascii) file_.position_bytes = file_.normal_bytes = 0;
  }

  void read_faces(const Element& element) {
    for (const Property& p : element.properties)
      if (!is_corner_list(p)) file_.extras.push_back("face property '" + p.name + "'");
    for (std::size_t f = 0; f < element.count; ++f) {
      bool read = false;
      for (const Property& property : element.properties) {
        if (read || !is_corner_list(property)) {
          skip(property);
          continue;
        }
        read_corners(property, f);
        read = true;
      }
    }
  }
  void read_corners(const Property& property, std::size_t f) {
    std::uint64_t at = 0;
    const double count = body_.take(*property.count, "the number of a face's corners", at);
    if (count < 3) body_.fail(fmt::format("at least 3 corners in face {}", f), fmt::format("{}", count), at);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const double v = body_.take(property.type, "a vertex index", at);
      if (v < 0 || v > static_cast<double>(kMostVertices)) body_.fail("a vertex index", fmt::format("{}", v), at);
      file_.polygons.corners.push_back(static_cast<std::uint32_t>(v));
    }
    file_.polygons.close_face();
  }
  void check_indices() const {
    for (std::size_t f = 0; f < file_.polygons.face_count(); ++f)
      for (const auto v : file_.polygons.view().face(f))
        if (v >= file_.polygons.positions.size())
          throw InvalidInput(fmt::format("{}, face {}: expected vertex indices below {}, got {}", file_.path, f,
                                         file_.polygons.positions.size(), v));
  }

  MeshFile& file_;
  Header header_;
  Body body_;
};

}  // namespace

void parse_ply(MeshFile& file) { PlyParser(file).run(); }

}  // namespace vdb_offset::io
