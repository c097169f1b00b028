#include <fmt/format.h>

#include "vdb_offset/error.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"

namespace vdb_offset::io {
namespace {

/// [ST][C][N]OFF: which numbers stand behind a vertex's coordinates. 4OFF and nOFF have other coordinates.
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

/// A count that the rest of the file can hold, at `least` bytes an item.
std::size_t count(Scanner& scanner, const char* what, std::size_t least) {
  const std::int64_t value = scanner.integer_anywhere(what);
  if (value < 0 || static_cast<std::uint64_t>(value) > scanner.remaining() / least + 1)
    scanner.fail(fmt::format("{} that the rest of the file ({} bytes) can hold", what, scanner.remaining()),
                 scanner.last_token());
  return static_cast<std::size_t>(value);
}

}  // namespace

void parse_off(MeshFile& file) {
  Scanner scanner(file.path, file.text(), byte_order_mark(file.text()), false, '#');
  const bool normals = has_normals(scanner, scanner.token_anywhere("the keyword OFF"), file);
  if (is_word(Scanner(scanner).token(), "binary"))
    scanner.fail_with("a text OFF file", "a binary one", scanner.position());
  const std::size_t vertices = count(scanner, "a number of vertices", 6);
  const bool a_line_each = scanner.at_line_end();
  const std::size_t faces = count(scanner, "a number of faces", 8);
  // Some writers leave the number of edges away, some give each number a line of its own.
  if (a_line_each) scanner.integer_anywhere("a number of edges");
  else if (!scanner.at_line_end()) scanner.integer("a number of edges");
  std::vector<NumberTriple> position_at, normal_at;
  for (std::size_t v = 0; v < vertices; ++v) {
    if (scanner.at_text_end()) scanner.fail(fmt::format("vertex {} of {}", v + 1, vertices));
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
      file.polygons.corners.push_back(static_cast<std::uint32_t>(v));
    }
    file.polygons.close_face();
    scanner.next_line();
  }
  if (faces == 0) scanner.fail("at least one face");
  file.position_at = Places(std::move(position_at));
  file.normal_at = Places(std::move(normal_at));
}

}  // namespace vdb_offset::io
