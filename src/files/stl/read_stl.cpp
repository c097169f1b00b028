// SPDX-License-Identifier: Apache-2.0
// Reads an STL file: three vertices for each facet come out, with the places of all coordinates and normals. A file is
// binary if its size is that which its count asks for, or if it is larger and does not begin as a text; whatever begins
// with "solid" otherwise is a text. A text is read word by word, solid by solid; normals are passed over, as words and
// infinities are common there, and so are remarks behind loops. A binary file is read in parallel, after memory for it
// has been asked for, and of coordinates that are not finite the first one in the file is reported. Vertices at one
// position are not welded here, and names of solids are read by stl_document.cpp.
#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "bytes/scanner.h"
#include "document/require_format.h"
#include "ground/numbers/rounding.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "stl/stl_document.h"
#include "stl/stl_layout.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

using stl::kFacet, stl::kFirst;

class AsciiStlParser {
 public:
  AsciiStlParser(MeshFile& file, StlRows& rows)
      : file_(file), rows_(rows), scanner_(file.path, file.text(), byte_order_mark(file.text())) {}

  void run() {
    while (!scanner_.at_text_end()) solid();
    if (file_.polygons.face_count() == 0) scanner_.fail("at least one facet");
    rows_.position_at = ByteOffsets(std::move(position_at_));
    rows_.normal_at = ByteOffsets(std::move(normal_at_));
  }

 private:
  void solid() {
    expect("solid");
    scanner_.next_line();
    for (;;) {
      const std::string_view word = scanner_.token_anywhere("'facet' or 'endsolid'");
      if (is_word(word, "endsolid")) break;
      if (!is_word(word, "facet")) scanner_.fail("'facet' or 'endsolid'", scanner_.position() - word.size());
      facet();
    }
    scanner_.next_line();
  }
  void facet() {
    held_.add();
    expect("normal");
    normal();
    scanner_.next_line();
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      file_.polygons.positions.push_back(scanner_.triple("a coordinate", position_at_.emplace_back()));
      if (!scanner_.at_line_end()) scanner_.fail("the end of the line after three coordinates");
    }
    expect("endloop");
    stl::skip_remark(scanner_);
    expect("endfacet");
    stl::skip_remark(scanner_);
    const auto v = static_cast<std::uint32_t>(file_.polygons.positions.size());
    file_.polygons.add_face({v - 3, v - 2, v - 1});
  }
  /// Skips a normal without reading its numbers: words and infinities are common there.
  void normal() { scanner_.skip_triple("three numbers of a normal", normal_at_.emplace_back()); }
  void expect(const char* word) {
    const bool ended = scanner_.at_text_end();
    if (ended || !is_word(scanner_.token(), word))
      scanner_.fail(fmt::format("'{}'", word), ended ? scanner_.position() : scanner_.last_token());
  }

  MeshFile& file_;
  StlRows& rows_;
  Scanner scanner_;
  std::vector<NumberTriple> position_at_, normal_at_;
  MemoryWatch held_{file_.path, 3 * (sizeof(Vec3d) + sizeof(NumberTriple)) + sizeof(NumberTriple) + 4 * 4};
};

std::uint32_t promised_facets(const MeshFile& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, file.text().data() + kFirst - 4, 4);
  return count;
}

void parse_binary(MeshFile& file, StlRows& rows) {
  static_assert(std::endian::native == std::endian::little, "binary numbers are copied as they are");
  const std::size_t facets = promised_facets(file);
  file.encoding = Encoding::LittleEndian;
  rows.position_bytes = rows.normal_bytes = 4;
  file.precision = {Rounding::Kind::Single};
  if (facets == 0) throw InvalidInput(file.path + ", byte 80: expected at least one facet, got a count of 0");
  if (3 * facets > kMostVertices)
    throw InvalidInput(
        fmt::format("{}, byte 80: expected at most {} facets, got {}", file.path, kMostVertices / 3, facets));
  rows.normal_at = ByteOffsets(facets, kFirst, kFacet, {0, 4, 8});
  rows.position_at = ByteOffsets(3 * facets, kFirst + 12, kFacet, {0, 4, 8}, 3, 12);
  Polygons& polygons = file.polygons;
  require_memory(facets * (3 * sizeof(Vec3d) + 4 * sizeof(std::uint32_t)), file.path);
  polygons.positions.resize(3 * facets);
  polygons.corners.resize(3 * facets);
  polygons.face_begin.resize(facets + 1);
  std::atomic<std::uint64_t> first_bad = file.text().size();
  for_each_index(facets, [&](std::size_t f) {
    polygons.face_begin[f + 1] = static_cast<std::uint32_t>(3 * f + 3);
    for (std::size_t v = 3 * f; v < 3 * f + 3; ++v) {
      polygons.corners[v] = static_cast<std::uint32_t>(v);
      const std::uint64_t at = rows.position_at[v].at[0];
      float xyz[3];
      std::memcpy(xyz, file.text().data() + at, sizeof xyz);
      for (std::size_t k = 0; k < 3; ++k)
        if (!std::isfinite(xyz[k])) lower_to(first_bad, at + 4 * k);
      polygons.positions[v] = Vec3d(xyz[0], xyz[1], xyz[2]);
    }
  });
  if (first_bad == file.text().size()) return;
  float bad = 0;
  std::memcpy(&bad, file.text().data() + first_bad, sizeof bad);
  throw InvalidInput(
      fmt::format("{}, byte {}: expected a finite coordinate, got {}", file.path, first_bad.load(), bad));
}

void parse(MeshFile& file, StlRows& rows) {
  const std::string_view bytes = file.text();
  const bool says_solid = is_word(Scanner(file.path, bytes, byte_order_mark(bytes)).first_word(), "solid");
  const bool holds_header = bytes.size() >= kFirst;
  // Binary files may also start with "solid": their size decides. Bytes behind the last facet are kept.
  if (holds_header && (bytes.size() == kFirst + kFacet * std::size_t{promised_facets(file)} ||
                       (!says_solid && bytes.size() > kFirst + kFacet * std::size_t{promised_facets(file)})))
    return parse_binary(file, rows);
  if (says_solid) {
    rows.has_carriage_returns = use_line_feeds(file);
    return AsciiStlParser(file, rows).run();
  }
  if (!holds_header)
    throw InvalidInput(fmt::format("{}, byte 0: expected 'solid' or a binary STL header of 84 bytes, got {} bytes",
                                   file.path, bytes.size()));
  throw InvalidInput(fmt::format("{}, byte 80: expected {} facets, which take {} bytes, got a file of {} bytes",
                                 file.path, promised_facets(file), kFirst + kFacet * std::size_t{promised_facets(file)},
                                 bytes.size()));
}

}  // namespace

void parse_stl(MeshFile& file) {
  const auto rows = std::make_shared<StlRows>();
  file.document = rows;
  parse(file, *rows);
  file.normal_count = rows->normal_at.size();
}

}  // namespace vdb_offset::io
