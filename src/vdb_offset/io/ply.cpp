#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "vdb_offset/error.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"
#include "vdb_offset/io/text.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset::io {
namespace {

// Bytes of "0 0 0" and its line end.
constexpr std::size_t kLeastVertexLine = 6;

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
  Scanner scanner(file.path, file.text());
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

template <class T>
double load(const char* raw) {
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

double binary_number(const char* at, Type type, Encoding encoding) {
  static_assert(std::endian::native == std::endian::little, "numbers of the other order are turned round");
  char raw[8];
  if (encoding == Encoding::BigEndian) std::reverse_copy(at, at + type.bytes, raw);
  else std::memcpy(raw, at, type.bytes);
  if (type.kind == 'f') return type.bytes == 4 ? load<float>(raw) : load<double>(raw);
  if (type.kind == 'u')
    return type.bytes == 1   ? load<std::uint8_t>(raw)
           : type.bytes == 2 ? load<std::uint16_t>(raw)
                             : load<std::uint32_t>(raw);
  return type.bytes == 1 ? load<std::int8_t>(raw) : type.bytes == 2 ? load<std::int16_t>(raw) : load<std::int32_t>(raw);
}

/// Digits that a text has beyond its declared type are not there for anyone who reads it.
double as_declared(Type type, double value) {
  return type.bytes == 4 ? static_cast<double>(static_cast<float>(value)) : value;
}

/// Takes numbers of either kind off the body, one after the other.
class Body {
 public:
  Body(const MeshFile& file, const Header& header)
      : file_(file), text_(file.path, file.text(), header.end), at_(header.end), encoding_(header.encoding) {}

  /// `at` receives the number's first byte. Numbers above 2^53 do not occur in what is used.
  double take(Type type, const char* what, std::uint64_t& at) {
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
    if (count > (file_.text().size() - at_) / type.bytes) truncated(what);
    at_ += count * type.bytes;
  }
  std::size_t position() const { return encoding_ == Encoding::Ascii ? text_.position() : at_; }
  void go_to(std::size_t at) {
    if (encoding_ == Encoding::Ascii) text_ = Scanner(file_.path, file_.text(), at);
    else at_ = at;
  }
  [[noreturn]] void fail(const std::string& expected, const std::string& found, std::uint64_t at) const {
    if (encoding_ == Encoding::Ascii) text_.fail_with(expected, found, at);
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", file_.path, at, expected, found));
  }

 private:
  double take_binary(Type type, const char* what) {
    if (file_.text().size() - at_ < type.bytes) truncated(what);
    at_ += type.bytes;
    return binary_number(file_.text().data() + at_ - type.bytes, type, encoding_);
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
      if (find(element.name) != &element) missing("each element once");
      if (element.properties.empty()) continue;  // takes no bytes, however many there are
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
    const VertexLayout layout = vertex_layout(element);
    const bool plain =
        file_.encoding == Encoding::Ascii ? read_vertex_lines(element, layout) : read_vertex_records(element, layout);
    if (!plain) read_vertices_one_by_one(element, layout);
    if (layout.normals) file_.extras.emplace_back("normals");
    if (file_.position_bytes == 4) file_.precision = {Precision::Kind::Single};
    if (file_.encoding == Encoding::Ascii) file_.position_bytes = file_.normal_bytes = 0;
  }

  /// Which component, 0..2 of the position and 3..5 of the normal, each property is; -1 for none.
  struct VertexLayout {
    std::vector<int> component;
    bool normals = false;
  };

  VertexLayout vertex_layout(const Element& element) {
    constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
    VertexLayout layout;
    int found = 0;
    for (const Property& p : element.properties) {
      const auto* name = p.count ? std::end(kNames) : std::find(std::begin(kNames), std::end(kNames), p.name);
      const int component = name == std::end(kNames) ? -1 : static_cast<int>(name - kNames);
      layout.component.push_back(component);
      if (component < 0) {
        file_.extras.push_back("vertex property '" + p.name + "'");
        continue;
      }
      if (found >> component & 1) missing("each coordinate once");
      found |= 1 << component;
      if (p.type.kind != 'f') missing("floating-point coordinates and normals");
      std::uint8_t& bytes = component < 3 ? file_.position_bytes : file_.normal_bytes;
      if (bytes != 0 && bytes != p.type.bytes) missing("one type for all coordinates");
      bytes = p.type.bytes;
    }
    if ((found & 7) != 7) missing("vertex properties x, y and z");
    layout.normals = (found & 56) == 56;
    return layout;
  }

  /// Binary vertices without lists: the same number of bytes each. False if they are of another kind.
  bool read_vertex_records(const Element& element, const VertexLayout& layout) {
    std::uint64_t size = 0;
    std::array<std::uint64_t, 3> offset[2] = {};
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& p = element.properties[i];
      if (p.count) return false;
      if (const int c = layout.component[i]; c >= 0) offset[c / 3][static_cast<std::size_t>(c % 3)] = size;
      size += p.type.bytes;
    }
    const std::size_t begin = body_.position(), count = element.count;
    if (count > (file_.text().size() - begin) / size) return false;
    const Places places(count, begin, size, offset[0]);
    const Type type{'f', file_.position_bytes};
    std::atomic<bool> finite = true;
    file_.polygons.positions.resize(count);
    for_each_index(count, [&](std::size_t v) {
      const NumberTriple place = places[v];
      Vec3d& p = file_.polygons.positions[v];
      for (int k = 0; k < 3; ++k) p[k] = binary_number(file_.text().data() + place.at[k], type, file_.encoding);
      if (!p.isFinite()) finite = false;
    });
    file_.position_at = places;
    if (layout.normals) file_.normal_at = Places(count, begin, size, offset[1]);
    if (finite) body_.go_to(begin + count * size);
    return finite;
  }

  /// Vertices that fill a line each. False if they are of another kind.
  bool read_vertex_lines(const Element& element, const VertexLayout& layout) {
    for (const Property& p : element.properties)
      if (p.count) return false;
    const LineRecords lines(file_.text(), body_.position(), element.count);
    if (!lines.complete() || element.count > file_.text().size() / kLeastVertexLine) return false;
    std::vector<NumberTriple> at[2];
    at[0].resize(element.count);
    if (layout.normals) at[1].resize(element.count);
    file_.polygons.positions.resize(element.count);
    const bool plain = lines.for_each([&](std::size_t v, FastCursor& cursor) {
      for (const int c : layout.component) {
        cursor.skip_blanks();
        const auto byte = static_cast<std::uint64_t>(cursor.position() - file_.text().data());
        double value = 0;
        if (c < 0 || c >= 3 ? !cursor.skip_word() : !cursor.number(value)) return false;
        if (c >= 0 && c < 3) file_.polygons.positions[v][c] = as_declared({'f', file_.position_bytes}, value);
        if (c >= 0 && (c < 3 || layout.normals)) at[c / 3][v].at[c % 3] = byte;
      }
      return file_.polygons.positions[v].isFinite();
    });
    if (!plain) return false;
    file_.position_at = Places(std::move(at[0]));
    file_.normal_at = Places(std::move(at[1]));
    body_.go_to(lines.end());
    return true;
  }

  void read_vertices_one_by_one(const Element& element, const VertexLayout& layout) {
    file_.polygons.positions.clear();
    std::vector<NumberTriple> position_at, normal_at;
    for (std::size_t v = 0; v < element.count; ++v) {
      Vec3d position(0.0);
      NumberTriple at[2] = {};
      for (std::size_t i = 0; i < layout.component.size(); ++i) {
        const Property& property = element.properties[i];
        if (layout.component[i] < 0) {
          skip(property);
          continue;
        }
        const auto c = static_cast<std::size_t>(layout.component[i]);
        if (c >= 3) {
          at[1].at[c - 3] = body_.place(property.type, "a component of a normal");
          continue;
        }
        const double value = body_.take(property.type, "a coordinate", at[0].at[c]);
        if (!std::isfinite(value)) body_.fail("a finite coordinate", fmt::format("{}", value), at[0].at[c]);
        position[static_cast<int>(c)] = value;
      }
      file_.polygons.positions.push_back(position);
      position_at.push_back(at[0]);
      if (layout.normals) normal_at.push_back(at[1]);
    }
    file_.position_at = Places(std::move(position_at));
    file_.normal_at = Places(std::move(normal_at));
  }

  /// Reads the first list of corners that each face has, and skips the rest.
  void read_faces(const Element& element) {
    for (const Property& p : element.properties)
      if (!is_corner_list(p)) file_.extras.push_back("face property '" + p.name + "'");
    const auto lists = std::count_if(element.properties.begin(), element.properties.end(),
                                     [](const Property& p) { return p.count.has_value(); });
    const bool plain =
        lists == 1 && (file_.encoding == Encoding::Ascii ? read_face_lines(element) : read_face_records(element));
    if (!plain) read_faces_one_by_one(element);
  }

  /// Binary faces with a single list. False if something is wrong with them.
  bool read_face_records(const Element& element) {
    const auto list = std::find_if(element.properties.begin(), element.properties.end(), is_corner_list);
    std::uint64_t before = 0, around = list->count->bytes;
    for (auto p = element.properties.begin(); p != element.properties.end(); ++p) {
      if (p != list) around += p->type.bytes;
      if (p < list) before += p->type.bytes;
    }
    const char* const bytes = file_.text().data();
    const std::uint64_t begin = body_.position(), end = file_.text().size(), item = list->type.bytes;
    if (element.count > (end - begin) / around) return false;
    auto& face_begin = file_.polygons.face_begin;
    face_begin.resize(element.count + 1);
    std::uint64_t corners = 0;
    const auto record = [&](std::size_t f, std::uint64_t corner) { return begin + f * around + corner * item; };
    for (std::size_t f = 0; f < element.count; ++f) {
      const std::uint64_t at = record(f, corners);
      if (end - at < around) return false;
      const double count = binary_number(bytes + at + before, *list->count, file_.encoding);
      if (count < 3 || count * static_cast<double>(item) > static_cast<double>(end - at)) return false;
      corners += static_cast<std::uint64_t>(count);
      if (corners > kMostVertices || record(f + 1, corners) > end) return false;
      face_begin[f + 1] = static_cast<std::uint32_t>(corners);
    }
    file_.polygons.corners.resize(corners);
    std::atomic<bool> plain = true;
    for_each_index(element.count, [&](std::size_t f) {
      const char* at = bytes + record(f, face_begin[f]) + before + list->count->bytes;
      for (std::size_t c = face_begin[f]; c < face_begin[f + 1]; ++c, at += item)
        if (!set_corner(c, binary_number(at, list->type, file_.encoding))) plain = false;
    });
    if (plain) body_.go_to(record(element.count, corners));
    return plain;
  }
  bool set_corner(std::size_t c, double v) {
    file_.polygons.corners[c] = static_cast<std::uint32_t>(v >= 0 && v <= kMostVertices ? v : 0);
    return v >= 0 && v <= kMostVertices;
  }

  /// Faces that fill a line each: first their numbers of corners are read, then the corners. False if they are of
  /// another kind.
  bool read_face_lines(const Element& element) {
    const LineRecords lines(file_.text(), body_.position(), element.count);
    if (!lines.complete()) return false;
    std::vector<std::uint32_t>&corners = file_.polygons.corners, &face_begin = file_.polygons.face_begin;
    face_begin.resize(element.count + 1);
    const auto list = std::find_if(element.properties.begin(), element.properties.end(), is_corner_list);
    const auto before = list - element.properties.begin(), after = element.properties.end() - list - 1;
    const auto skip_words = [](FastCursor& cursor, std::ptrdiff_t count) {
      while (count > 0 && cursor.skip_word()) --count;
      return count == 0;
    };
    const auto read_count = [&](FastCursor& cursor, std::uint32_t& count) {
      if (!skip_words(cursor, before)) return false;
      cursor.skip_blanks();
      return cursor.digits(count) && count >= 3 && cursor.at_word_end();
    };
    bool plain = lines.for_each([&](std::size_t f, FastCursor& cursor) {
      const bool counted = read_count(cursor, face_begin[f + 1]);
      cursor.skip_line();
      return counted;
    });
    std::uint64_t all = 0;
    for (std::size_t f = 1; plain && f < face_begin.size(); ++f) {
      all += face_begin[f];
      face_begin[f] = static_cast<std::uint32_t>(all);
    }
    if (!plain || all > file_.text().size()) return false;
    corners.resize(all);
    plain = lines.for_each([&](std::size_t f, FastCursor& cursor) {
      std::uint32_t count = 0;
      if (!read_count(cursor, count) || count != face_begin[f + 1] - face_begin[f]) return false;
      for (std::size_t c = face_begin[f]; c < face_begin[f + 1]; ++c) {
        cursor.skip_blanks();
        if (!cursor.digits(corners[c]) || !cursor.at_word_end()) return false;
      }
      return skip_words(cursor, after);
    });
    if (plain) body_.go_to(lines.end());
    return plain;
  }

  void read_faces_one_by_one(const Element& element) {
    file_.polygons.corners.clear();
    file_.polygons.face_begin.assign(1, 0);
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
