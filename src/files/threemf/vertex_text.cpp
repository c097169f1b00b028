// SPDX-License-Identifier: Apache-2.0
#include "threemf/vertex_text.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bytes/append_number.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// Bytes of the text in a piece. Not measured beside other numbers. Fuzzers set fewer, so that small inputs have
// several.
#ifndef VDB_OFFSET_PIECE_OF_PART
#define VDB_OFFSET_PIECE_OF_PART (1 << 20)
#endif
constexpr std::size_t kBytesAtOnce = VDB_OFFSET_PIECE_OF_PART;

bool is_xml_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Appends the tag that begins at `at`, with other values in its attributes x, y and z; returns its end. expat has
/// checked the tag's form.
std::size_t append_vertex_tag(std::string& to, std::string_view text, std::size_t at, const Vec3d& position,
                              const Rounding& precision) {
  std::size_t copied = at;
  while (!is_xml_space(text[at])) ++at;
  for (;;) {
    while (is_xml_space(text[at])) ++at;
    if (text[at] == '>' || text[at] == '/') break;
    const std::size_t name = at;
    while (text[at] != '=' && !is_xml_space(text[at])) ++at;
    const std::string_view word = text.substr(name, at - name);
    while (text[at] != '"' && text[at] != '\'') ++at;
    const std::size_t value = at + 1, end = text.find(text[at], value);
    at = end + 1;
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') continue;
    to.append(text, copied, value - copied);
    append_number(to, position[word[0] - 'x'], precision);
    copied = end;
  }
  to.append(text, copied, at - copied);
  return at;
}

/// Behind the tag that begins at `at`.
std::size_t tag_end(std::string_view text, std::size_t at) {
  for (char quote = 0; quote || text[at] != '>'; ++at) {
    if (text[at] == quote) quote = 0;
    else if (!quote && (text[at] == '"' || text[at] == '\'')) quote = text[at];
  }
  return at + 1;
}

class VertexText {
 public:
  VertexText(std::string_view text, const std::vector<std::uint64_t>& vertex_at, std::vector<PlacedMesh> meshes,
             const MovedMesh& moved)
      : text_(text), vertex_at_(vertex_at), meshes_(std::move(meshes)), moved_(moved) {
    std::erase_if(meshes_, [](const PlacedMesh& mesh) { return mesh.vertices == 0; });
    std::sort(meshes_.begin(), meshes_.end(),
              [](const PlacedMesh& a, const PlacedMesh& b) { return a.first_in_part < b.first_in_part; });
  }

  std::size_t pieces() const { return (text_.size() + kBytesAtOnce - 1) / kBytesAtOnce; }

  std::string make(std::size_t piece) const {
    std::size_t copied = cut(piece);
    const std::size_t end = cut(piece + 1), first = first_from(copied), last = first_from(end);
    std::string bytes;
    bytes.reserve((end - copied) + (last - first) * 16);
    for (const PlacedMesh& mesh : meshes_) {
      const std::size_t mesh_end = mesh.first_in_part + mesh.vertices;
      for (std::size_t v = std::max(first, mesh.first_in_part); v < std::min(last, mesh_end); ++v) {
        const std::size_t of_scene = mesh.first_vertex + (v - mesh.first_in_part);
        if (!moved_.has_moved(of_scene)) continue;
        bytes.append(text_, copied, vertex_at_[v] - copied);
        const Vec3d kept = moved_.precision(moved_.positions[of_scene]);
        const Vec3d position = mesh.transform.source_of(kept);
        if (!position.isFinite())
          throw InvalidInput(moved_.source.path + ": expected transforms that lead back to finite numbers, got others");
        copied = append_vertex_tag(bytes, text_, vertex_at_[v], position, moved_.precision);
      }
    }
    return bytes.append(text_, copied, end - copied);
  }

 private:
  /// Where a piece begins: at no place inside of a vertex' tag.
  std::size_t cut(std::size_t piece) const {
    const std::size_t at = std::min(piece * kBytesAtOnce, text_.size()), next = first_from(at);
    return next == 0 ? at : std::max(at, tag_end(text_, vertex_at_[next - 1]));
  }
  /// The first vertex whose tag begins at a byte or behind it.
  std::size_t first_from(std::size_t at) const {
    return static_cast<std::size_t>(std::lower_bound(vertex_at_.begin(), vertex_at_.end(), at) - vertex_at_.begin());
  }

  std::string_view text_;
  const std::vector<std::uint64_t>& vertex_at_;
  std::vector<PlacedMesh> meshes_;  // in the order of the part
  const MovedMesh& moved_;
};

}  // namespace

Pieces with_moved_vertices(std::string_view text, const std::vector<std::uint64_t>& vertex_at,
                           std::vector<PlacedMesh> meshes, const MovedMesh& moved) {
  const auto made = std::make_shared<const VertexText>(text, vertex_at, std::move(meshes), moved);
  return {made->pieces(), [made](std::size_t piece) { return made->make(piece); }};
}

}  // namespace vdb_offset::io
