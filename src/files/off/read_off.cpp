// SPDX-License-Identifier: Apache-2.0
// Reads an OFF file, text or binary as Geomview has it: the mesh comes out, with the places of all coordinates and
// normals. The keyword says what stands with each vertex. In a text, vertices and faces have a line each, and words
// behind what is needed are left alone; the number of edges may be missing, and counts may have lines of their own. In
// a binary file all numbers have four bytes, big-endian, and the keyword gives the width of a vertex. A count that the
// rest of the file cannot hold, a coordinate that is not finite, and a vertex number out of range are refused, by line
// or byte. Colours and texture coordinates are not read here but named; off_document.cpp reads them.
#include <fmt/format.h>

#include <cmath>

#include "bytes/scanner.h"
#include "document/require_format.h"
#include "ground/numbers/rounding.h"
#include "ground/system/memory.h"
#include "off/off_binary.h"
#include "off/off_document.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// Whether vertices have normals, by the keyword [ST][C][N]OFF, which says what stands behind their coordinates. 4OFF
/// and nOFF, which have other coordinates, are refused.
bool has_normals(const Scanner& scanner, std::string_view keyword, MeshFile& file) {
  std::string_view prefix = keyword;
  if (prefix.size() < 3 || prefix.substr(prefix.size() - 3) != "OFF") scanner.fail("the keyword OFF", 0);
  prefix.remove_suffix(3);
  const auto take = [&](std::string_view letters, const char* meaning) {
    if (!prefix.starts_with(letters)) return false;
    prefix.remove_prefix(letters.size());
    file.extras.emplace_back(meaning);
    return true;
  };
  take("ST", "texture coordinates");
  take("C", "vertex colours");
  const bool normals = take("N", "normals");
  if (!prefix.empty()) scanner.fail("OFF with three coordinates ([ST][C][N]OFF)", 0);
  return normals;
}

/// Reads a count. \throw InvalidInput for more items than the rest of the file can hold, at `least` bytes each
std::size_t count(Scanner& scanner, const char* what, std::size_t least) {
  const std::int64_t value = scanner.integer_anywhere(what);
  if (value < 0 || static_cast<std::uint64_t>(value) > scanner.remaining() / least + 1)
    scanner.fail(fmt::format("{} that the rest of the file ({} bytes) can hold", what, scanner.remaining()),
                 scanner.last_token());
  return static_cast<std::size_t>(value);
}

/// Parses a binary file: numbers of four bytes, big-endian, behind the first line.
class BinaryOffParser {
 public:
  BinaryOffParser(MeshFile& file, OffRows& rows, std::size_t begin) : file_(file), rows_(rows), at_(begin) {}

  void run() {
    file_.encoding = Encoding::BigEndian;
    rows_.position_bytes = 4;
    file_.precision = {Rounding::Kind::Single};
    const off::Layout layout = off::layout_of(file_);
    const std::size_t vertices = count("a number of vertices", 4 * layout.width);
    const std::size_t faces = count("a number of faces", 4 * kLeastWords);
    whole("a number of edges");
    read_vertices(vertices, layout);
    for (std::size_t f = 0; f < faces; ++f) read_face(f);
    if (faces == 0) fail("at least one face", "a count of 0", at_);
  }

 private:
  static constexpr std::size_t kLeastWords = 5;  // least number of words of a face: two counts and three corners

  void read_vertices(std::size_t count, const off::Layout& layout) {
    const std::size_t size = 4 * layout.width;
    if (count > left() / size) fail(fmt::format("{} vertices of {} bytes", count, size), "the end of the file", at_);
    rows_.position_at = ByteOffsets(count, at_, size, {0, 4, 8});
    if (layout.normal) {
      rows_.normal_bytes = 4;
      rows_.normal_at = ByteOffsets(count, at_ + 4 * layout.normal, size, {0, 4, 8});
    }
    file_.polygons.positions.resize(count);
    for (std::size_t v = 0; v < count; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint64_t at = at_ + v * size + 4 * k;
        const double value = off::number_at(file_, at);
        if (!std::isfinite(value)) fail("a finite coordinate", fmt::format("{}", value), at);
        file_.polygons.positions[v][static_cast<int>(k)] = value;
      }
    at_ += count * size;
  }
  void read_face(std::size_t f) {
    const std::uint64_t begin = at_;
    const std::int64_t corners = whole("a number of corners");
    if (corners < 3) fail(fmt::format("at least 3 corners in face {}", f), fmt::format("{}", corners), begin);
    if (static_cast<std::uint64_t>(corners) > left() / 4)
      fail(fmt::format("as many corners of face {} as the rest of the file can hold", f), fmt::format("{}", corners),
           begin);
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::int64_t v = whole("a vertex index");
      if (v < 0 || static_cast<std::size_t>(v) >= file_.polygons.positions.size())
        fail(fmt::format("a vertex index below {}", file_.polygons.positions.size()), fmt::format("{}", v), at_ - 4);
      file_.polygons.corners.push_back(static_cast<std::uint32_t>(v));
    }
    file_.polygons.close_face();
    const std::int64_t colours = whole("a number of a face's colour components");
    if (colours < 0 || colours > 4) fail("0 to 4 components of a face's colour", fmt::format("{}", colours), at_ - 4);
    if (static_cast<std::uint64_t>(colours) > left() / 4)
      fail(fmt::format("{} components of a face's colour", colours), "the end of the file", at_);
    at_ += 4 * static_cast<std::uint64_t>(colours);
  }

  std::uint64_t left() const { return file_.text().size() - at_; }
  std::int64_t whole(const char* what) {
    if (left() < 4) fail(what, "the end of the file", at_);
    at_ += 4;
    return off::integer_at(file_, at_ - 4);
  }
  /// Reads a count. \throw InvalidInput for more items than the rest of the file can hold, at `least` bytes each
  std::size_t count(const char* what, std::size_t least) {
    const std::int64_t value = whole(what);
    if (value < 0 || static_cast<std::uint64_t>(value) > left() / least)
      fail(fmt::format("{} that the rest of the file ({} bytes) can hold", what, left()), fmt::format("{}", value),
           at_ - 4);
    return static_cast<std::size_t>(value);
  }
  [[noreturn]] void fail(const std::string& expected, const std::string& found, std::uint64_t at) const {
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", file_.path, at, expected, found));
  }

  MeshFile& file_;
  OffRows& rows_;
  std::uint64_t at_;
};

void parse(MeshFile& file, OffRows& rows) {
  if (const auto begin = off::binary_begin(file)) {
    Scanner scanner(file.path, file.text());
    has_normals(scanner, scanner.token(), file);
    return BinaryOffParser(file, rows, *begin).run();
  }
  rows.has_carriage_returns = use_line_feeds(file);
  Scanner scanner(file.path, file.text(), byte_order_mark(file.text()), false, '#');
  const bool normals = has_normals(scanner, scanner.token_anywhere("the keyword OFF"), file);
  const std::size_t vertices = count(scanner, "a number of vertices", 6);
  const bool a_line_each = scanner.at_line_end();
  const std::size_t faces = count(scanner, "a number of faces", 8);
  // Some writers omit the number of edges, and some write each number on a line of its own.
  if (a_line_each) scanner.integer_anywhere("a number of edges");
  else if (!scanner.at_line_end()) scanner.integer("a number of edges");
  std::vector<NumberTriple> position_at, normal_at;
  MemoryWatch vertices_held(file.path, sizeof(Vec3d) + sizeof(NumberTriple) * (normals ? 2 : 1));
  MemoryWatch corners_held(file.path, sizeof(std::uint32_t));
  for (std::size_t v = 0; v < vertices; ++v) {
    if (scanner.at_text_end()) scanner.fail(fmt::format("vertex {} of {}", v + 1, vertices));
    vertices_held.add();
    file.polygons.positions.push_back(scanner.triple("a coordinate", position_at.emplace_back()));
    if (normals) scanner.skip_triple("three numbers of a normal", normal_at.emplace_back());
    scanner.next_line();
  }
  for (std::size_t f = 0; f < faces; ++f) {
    if (scanner.at_text_end()) scanner.fail(fmt::format("face {} of {}", f + 1, faces));
    const std::int64_t corners = scanner.integer("a number of corners");
    if (corners < 3) scanner.fail("at least 3 corners in a face", scanner.last_token());
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::int64_t v = scanner.integer("a vertex index");
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        scanner.fail(fmt::format("a vertex index below {}", vertices), scanner.last_token());
      corners_held.add();
      file.polygons.corners.push_back(static_cast<std::uint32_t>(v));
    }
    file.polygons.close_face();
    scanner.next_line();
  }
  if (faces == 0) scanner.fail("at least one face");
  rows.position_at = ByteOffsets(std::move(position_at));
  rows.normal_at = ByteOffsets(std::move(normal_at));
}

}  // namespace

void parse_off(MeshFile& file) {
  const auto rows = std::make_shared<OffRows>();
  file.document = rows;
  parse(file, *rows);
  file.normal_count = rows->normal_at.size();
}

}  // namespace vdb_offset::io
