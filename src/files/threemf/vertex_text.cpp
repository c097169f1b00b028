// SPDX-License-Identifier: Apache-2.0
#include "threemf/vertex_text.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bytes/append_number.h"
#include "threemf/tags.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// Bytes of the text in a piece. Not measured beside other numbers. Fuzzers set fewer, so that small inputs have
// several.
#ifndef VDB_OFFSET_PIECE_OF_PART
#define VDB_OFFSET_PIECE_OF_PART (1 << 20)
#endif
constexpr std::size_t kBytesAtOnce = VDB_OFFSET_PIECE_OF_PART;

class VertexText {
 public:
  VertexText(std::string_view text, std::size_t begin, const std::vector<std::uint64_t>& vertex_at,
             std::vector<PlacedMesh> meshes, const MovedMesh& moved)
      : text_(text), begin_(begin), vertex_at_(vertex_at), meshes_(std::move(meshes)), moved_(moved) {
    std::erase_if(meshes_, [](const PlacedMesh& mesh) { return mesh.vertices == 0; });
    std::sort(meshes_.begin(), meshes_.end(),
              [](const PlacedMesh& a, const PlacedMesh& b) { return a.first_in_part < b.first_in_part; });
  }

  std::size_t pieces() const { return (text_.size() - begin_ + kBytesAtOnce - 1) / kBytesAtOnce; }

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
        copied = append_tag(bytes, text_, vertex_at_[v], [&](std::string_view name, auto, std::string& value) {
          return append_coordinate_named(value, name, position, moved_.precision);
        });
      }
    }
    return bytes.append(text_, copied, end - copied);
  }

 private:
  /// Where a piece begins: at no place inside of a vertex' tag.
  std::size_t cut(std::size_t piece) const {
    const std::size_t at = std::min(begin_ + piece * kBytesAtOnce, text_.size()), next = first_from(at);
    return next == 0 ? at : std::max(at, tag_end(text_, vertex_at_[next - 1]));
  }
  /// The first vertex whose tag begins at a byte or behind it.
  std::size_t first_from(std::size_t at) const {
    return static_cast<std::size_t>(std::lower_bound(vertex_at_.begin(), vertex_at_.end(), at) - vertex_at_.begin());
  }

  std::string_view text_;
  std::size_t begin_;
  const std::vector<std::uint64_t>& vertex_at_;
  std::vector<PlacedMesh> meshes_;  // in the order of the part
  const MovedMesh& moved_;
};

}  // namespace

bool append_coordinate_named(std::string& text, std::string_view name, const Vec3d& position,
                             const Rounding& precision) {
  if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') return false;
  append_number(text, position[name[0] - 'x'], precision);
  return true;
}

Pieces with_moved_vertices(std::string_view text, const std::vector<std::uint64_t>& vertex_at,
                           std::vector<PlacedMesh> meshes, const MovedMesh& moved, std::size_t begin) {
  const auto made = std::make_shared<const VertexText>(text, begin, vertex_at, std::move(meshes), moved);
  return {made->pieces(), [made](std::size_t piece) { return made->make(piece); }};
}

}  // namespace vdb_offset::io
