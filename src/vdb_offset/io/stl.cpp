#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "vdb_offset/error.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

void add_facet(MeshFile& file) {
  const auto v = static_cast<std::uint32_t>(file.polygons.positions.size());
  file.polygons.add_face({v - 3, v - 2, v - 1});
}

class AsciiStlParser {
 public:
  explicit AsciiStlParser(MeshFile& file) : file_(file), scanner_(file.path, file.bytes) {}

  void run() {
    while (!scanner_.at_text_end()) solid();
    if (file_.polygons.face_count() == 0) scanner_.fail("at least one facet");
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
    expect("normal");
    normal();
    scanner_.next_line();
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      file_.polygons.positions.push_back(scanner_.triple("a coordinate", file_.position_at.emplace_back()));
      if (!scanner_.at_line_end()) scanner_.fail("the end of the line after three coordinates");
    }
    expect("endloop");
    skip_remark();
    expect("endfacet");
    skip_remark();
    add_facet(file_);
  }
  /// Some writers put words of their own behind the end of a loop or a facet.
  void skip_remark() {
    const std::string_view next = Scanner(scanner_).token();
    if (!next.starts_with("end") && !next.starts_with("END") && !is_word(next, "facet")) scanner_.next_line();
  }
  /// Words and infinities in the place of a normal are common.
  void normal() { scanner_.skip_triple("three numbers of a normal", file_.normal_at.emplace_back()); }
  void expect(const char* word) {
    const std::string quoted = fmt::format("'{}'", word);
    const std::string_view found = scanner_.token_anywhere(quoted.c_str());
    if (!is_word(found, word)) scanner_.fail(quoted, scanner_.position() - found.size());
  }

  MeshFile& file_;
  Scanner scanner_;
};

std::uint32_t promised_facets(const MeshFile& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, file.bytes.data() + kHeaderBytes - 4, 4);
  return count;
}

void parse_binary(MeshFile& file) {
  static_assert(std::endian::native == std::endian::little, "binary numbers are copied as they are");
  const std::size_t facets = promised_facets(file);
  file.encoding = Encoding::LittleEndian;
  file.position_bytes = file.normal_bytes = 4;
  if (facets == 0) throw InvalidInput(file.path + ", byte 80: expected at least one facet, got a count of 0");
  file.polygons.positions.reserve(3 * facets);
  file.position_at.reserve(3 * facets);
  file.normal_at.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const std::size_t facet = kHeaderBytes + f * kFacetBytes;
    file.normal_at.push_back({{facet, facet + 4, facet + 8}});
    for (std::size_t corner = facet + 12; corner < facet + 48; corner += 12) {
      float xyz[3];
      std::memcpy(xyz, file.bytes.data() + corner, sizeof xyz);
      for (std::size_t k = 0; k < 3; ++k)
        if (!std::isfinite(xyz[k]))
          throw InvalidInput(
              fmt::format("{}, byte {}: expected a finite coordinate, got {}", file.path, corner + 4 * k, xyz[k]));
      file.polygons.positions.emplace_back(xyz[0], xyz[1], xyz[2]);
      file.position_at.push_back({{corner, corner + 4, corner + 8}});
    }
    add_facet(file);
  }
}

}  // namespace

void parse_stl(MeshFile& file) {
  const std::string& bytes = file.bytes;
  const bool says_solid = is_word(Scanner(file.path, bytes).first_word(), "solid");
  const bool holds_header = bytes.size() >= kHeaderBytes;
  // Binary files may start with "solid" too; then their size tells. Bytes behind the last facet are kept.
  if (holds_header && (bytes.size() == kHeaderBytes + kFacetBytes * std::size_t{promised_facets(file)} ||
                       (!says_solid && bytes.size() > kHeaderBytes + kFacetBytes * std::size_t{promised_facets(file)})))
    return parse_binary(file);
  if (says_solid) return AsciiStlParser(file).run();
  if (!holds_header)
    throw InvalidInput(fmt::format("{}, byte 0: expected 'solid' or a binary STL header of 84 bytes, got {} bytes",
                                   file.path, bytes.size()));
  throw InvalidInput(fmt::format("{}, byte 80: expected {} facets, which take {} bytes, got a file of {} bytes",
                                 file.path, promised_facets(file),
                                 kHeaderBytes + kFacetBytes * std::size_t{promised_facets(file)}, bytes.size()));
}

}  // namespace vdb_offset::io
