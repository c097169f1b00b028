// SPDX-License-Identifier: Apache-2.0
// Reads a PLY file, text or binary in either byte order: the mesh comes out, with the places of all coordinates and
// normals, and the names of everything else. The usual layouts are read in parallel: binary vertices without lists,
// binary faces with no list but their corners, and texts with a row a line. Any other layout, and a file in which
// something is wrong, is read number by number, which gives the message. Strips of triangles become triangles. Numbers
// of a text are rounded to the type that the header declares. Memory is asked for before arrays are made, no more than
// the file's bytes can fill, and in the end all vertex numbers are checked. Colours and texture coordinates are read
// later (ply_document.cpp).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "bytes/line_records.h"
#include "document/require_format.h"
#include "ground/numbers/rounding.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "ply/ply_document.h"
#include "ply/ply_header.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace ply {
namespace {

// Bytes of the shortest line of a vertex, "0 0 0" and a line end.
constexpr std::size_t kLeastPlyVertexLine = 6;

class PlyParser {
 public:
  PlyParser(MeshFile& file, PlyRows& rows)
      : file_(file), rows_(rows), header_(read_header(file)), body_(file, header_) {}

  void run() {
    file_.encoding = header_.encoding;
    rows_.has_strips = find_strips(header_) != nullptr;
    if (!find(header_, "vertex")) missing("an element 'vertex'");
    const Element *const faces = find_faces(header_), *const strips = find_strips(header_);
    if (!faces && !strips) missing("an element 'face' or 'tristrips' with a list 'vertex_indices'");
    for (const Element& element : header_.elements) {
      if (find(header_, element.name) != &element) missing("each element once");
      if (element.properties.empty()) continue;  // rows without properties take no bytes, however many there are
      if (element.name == "vertex") read_vertices(element);
      else if (&element == faces) read_faces(element);
      else if (&element == strips) read_strips(element);
      else {
        for (std::size_t i = 0; i < element.count; ++i)
          for (const Property& property : element.properties) body_.skip(property);
        file_.extras.push_back("element '" + element.name + "'");
      }
    }
    if (file_.polygons.face_count() == 0) missing("at least one face");
    check_indices();
  }

 private:
  [[noreturn]] void missing(const char* what) const {
    throw InvalidInput(fmt::format("{}, header: expected {}, got none", file_.path, what));
  }

  void read_vertices(const Element& element) {
    const VertexLayout layout = vertex_layout(element);
    const bool plain =
        file_.encoding == Encoding::Ascii ? read_vertex_lines(element, layout) : read_vertex_records(element, layout);
    if (!plain) read_vertices_one_by_one(element, layout);
    if (layout.normals) file_.extras.emplace_back("normals");
    if (rows_.position_bytes == 4) file_.precision = {Rounding::Kind::Single};
    if (file_.encoding == Encoding::Ascii) rows_.position_bytes = rows_.normal_bytes = 0;
  }

  /// For each property, which component it is: 0 .. 2 of the position, 3 .. 5 of the normal, -1 of neither.
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
      std::uint8_t& bytes = component < 3 ? rows_.position_bytes : rows_.normal_bytes;
      if (bytes != 0 && bytes != p.type.bytes) missing("one type for all coordinates");
      bytes = p.type.bytes;
    }
    if ((found & 7) != 7) missing("vertex properties x, y and z");
    layout.normals = (found & 56) == 56;
    return layout;
  }

  /// Reads binary vertices without lists, which all take the same number of bytes. Returns false if they have lists.
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
    const ByteOffsets offsets(count, begin, size, offset[0]);
    const Type type{'f', rows_.position_bytes};
    std::atomic<bool> finite = true;
    require_memory(count * sizeof(Vec3d), file_.path);
    file_.polygons.positions.resize(count);
    for_each_index(count, [&](std::size_t v) {
      const NumberTriple triple = offsets[v];
      Vec3d& p = file_.polygons.positions[v];
      for (int k = 0; k < 3; ++k) p[k] = binary_number(file_.text().data() + triple.at[k], type, file_.encoding);
      if (!p.isFinite()) finite = false;
    });
    rows_.position_at = offsets;
    if (layout.normals) rows_.normal_at = ByteOffsets(count, begin, size, offset[1]);
    if (finite) body_.go_to(begin + count * size);
    return finite;
  }

  /// Reads vertices of a text that fill a line each. Returns false if they do not.
  bool read_vertex_lines(const Element& element, const VertexLayout& layout) {
    for (const Property& p : element.properties)
      if (p.count) return false;
    const LineRecords lines(file_.text(), body_.position(), element.count);
    if (!lines.complete() || element.count > file_.text().size() / kLeastPlyVertexLine) return false;
    std::vector<NumberTriple> at[2];
    require_memory(element.count * (sizeof(Vec3d) + sizeof(NumberTriple) * (layout.normals ? 2 : 1)), file_.path);
    at[0].resize(element.count);
    if (layout.normals) at[1].resize(element.count);
    file_.polygons.positions.resize(element.count);
    const bool plain = lines.for_each([&](std::size_t v, FastCursor& cursor) {
      for (const int c : layout.component) {
        cursor.skip_blanks();
        const auto byte = static_cast<std::uint64_t>(cursor.position() - file_.text().data());
        double value = 0;
        if (c < 0 || c >= 3 ? !cursor.skip_word() : !cursor.number(value)) return false;
        if (c >= 0 && c < 3) file_.polygons.positions[v][c] = as_declared({'f', rows_.position_bytes}, value);
        if (c >= 0 && (c < 3 || layout.normals)) at[c / 3][v].at[c % 3] = byte;
      }
      return file_.polygons.positions[v].isFinite();
    });
    if (!plain) return false;
    rows_.position_at = ByteOffsets(std::move(at[0]));
    rows_.normal_at = ByteOffsets(std::move(at[1]));
    body_.go_to(lines.end());
    return true;
  }

  void read_vertices_one_by_one(const Element& element, const VertexLayout& layout) {
    file_.polygons.positions.clear();
    std::vector<NumberTriple> position_at, normal_at;
    MemoryWatch held(file_.path, sizeof(Vec3d) + sizeof(NumberTriple) * (layout.normals ? 2 : 1));
    for (std::size_t v = 0; v < element.count; ++v) {
      Vec3d position(0.0);
      NumberTriple at[2] = {};
      for (std::size_t i = 0; i < layout.component.size(); ++i) {
        const Property& property = element.properties[i];
        if (layout.component[i] < 0) {
          body_.skip(property);
          continue;
        }
        const auto c = static_cast<std::size_t>(layout.component[i]);
        if (c >= 3) {
          at[1].at[c - 3] = body_.skip_number(property.type, "a component of a normal");
          continue;
        }
        const double value = body_.take(property.type, "a coordinate", at[0].at[c]);
        if (!std::isfinite(value)) body_.fail("a finite coordinate", fmt::format("{}", value), at[0].at[c]);
        position[static_cast<int>(c)] = value;
      }
      held.add();
      file_.polygons.positions.push_back(position);
      position_at.push_back(at[0]);
      if (layout.normals) normal_at.push_back(at[1]);
    }
    rows_.position_at = ByteOffsets(std::move(position_at));
    rows_.normal_at = ByteOffsets(std::move(normal_at));
  }

  /// Reads the first list of corners that each row has, and skips the rest.
  template <class Read>
  void read_lists(const Element& element, Read&& read) {
    for (std::size_t row = 0; row < element.count; ++row) {
      bool found = false;
      for (const Property& property : element.properties) {
        if (found || !is_corner_list(property)) body_.skip(property);
        else read(property, row), found = true;
      }
    }
  }

  void read_strips(const Element& element) {
    for (const Property& p : element.properties)
      if (!is_corner_list(p)) file_.extras.push_back("property '" + p.name + "' of triangle strips");
    file_.extras.emplace_back("triangle strips (the triangles are there)");
    read_lists(element, [&](const Property& property, std::size_t) { read_strip(property); });
  }
  /// Reads a strip of triangles. Three corners of which two are equal make no triangle: writers use them to go on
  /// elsewhere.
  void read_strip(const Property& property) {
    // In a list of unsigned numbers, -1, which ends a strip, is the largest number, unless that is a vertex.
    const double largest = std::ldexp(1.0, 8 * property.type.bytes) - 1;
    const bool largest_ends =
        property.type.kind == 'u' && static_cast<double>(find(header_, "vertex")->count) <= largest;
    std::array<std::uint32_t, 3> last{};
    std::uint64_t at = 0;
    for (std::size_t left = body_.take_length(property), length = 0; left > 0; --left) {
      const double v = body_.take(property.type, "a vertex index or -1", at);
      if (v == -1 || (largest_ends && v == largest)) {
        length = 0;
        continue;
      }
      if (v < 0 || v > static_cast<double>(kMostVertices))
        body_.fail("a vertex index, or -1 at the end of a strip", fmt::format("{}", v), at);
      last = {last[1], last[2], static_cast<std::uint32_t>(v)};
      if (++length >= 3) add_triangle(last, length % 2 == 0, at);
    }
  }
  void add_triangle(const std::array<std::uint32_t, 3>& corners, bool turned, std::uint64_t at) {
    const auto [a, b, c] = corners;
    if (a == b || b == c || c == a) return;
    if (file_.polygons.corners.size() + 3 > kMostVertices)
      body_.fail("fewer than 2^32 corners of triangles", "more", at);
    if (turned) file_.polygons.add_face({b, a, c});
    else file_.polygons.add_face({a, b, c});
  }

  void read_faces(const Element& element) {
    if (element.count == 0) return;  // the file may have strips instead
    for (const Property& p : element.properties)
      if (!is_corner_list(p)) file_.extras.push_back("face property '" + p.name + "'");
    const auto lists = std::count_if(element.properties.begin(), element.properties.end(),
                                     [](const Property& p) { return p.count.has_value(); });
    const bool plain =
        lists == 1 && (file_.encoding == Encoding::Ascii ? read_face_lines(element) : read_face_records(element));
    if (!plain) read_faces_one_by_one(element);
  }

  /// Reads binary faces whose only list is that of their corners. Returns false if there are other lists, or for
  /// malformed faces.
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
    require_memory(element.count * sizeof(std::uint32_t), file_.path);
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
    require_memory(corners * sizeof(std::uint32_t), file_.path);
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

  /// Reads faces of a text that fill a line each: first their numbers of corners, then the corners. Returns false if
  /// they do not.
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
    require_memory(all * sizeof(std::uint32_t), file_.path);
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
    read_lists(element, [&](const Property& property, std::size_t f) { read_corners(property, f); });
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
  PlyRows& rows_;
  Header header_;
  BodyReader body_;
};

}  // namespace
}  // namespace ply

void parse_ply(MeshFile& file) {
  const auto rows = std::make_shared<PlyRows>();
  file.document = rows;
  ply::PlyParser(file, *rows).run();
  file.normal_count = rows->normal_at.size();
}

}  // namespace vdb_offset::io
