// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "bytes/chunked_output.h"
#include "document/convert.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// One skin of a shell, with the numbers that a file in the source's format has for it. Refers to the source and the
/// shell.
///
/// Its vertices are numbered as the source's; behind those come the splits of both skins.
class Skin {
 public:
  Skin(const MeshFile& source, const Shell& shell, ShellPart part, const Rounding& precision, Normals normals);

  /// The number of the skin's first vertex in the shell.
  std::uint32_t first_vertex() const { return first_vertex_; }
  bool is_reversed() const { return first_vertex_ > 0; }
  /// Whether no vertex has moved.
  bool is_source() const;
  /// The vertex of the source that vertex v is, or is a split of.
  std::size_t source_of(std::size_t v) const { return v < vertices() ? v : shell_.splits[v - vertices()].vertex; }
  /// The new values of the source's normals, not reversed for the inner skin.
  const NewNormals& new_normals() const { return normals_; }

  /// The positions as written.
  Vec3d position(std::size_t v) const;
  /// The new position of a vertex, or the new value of a normal; none if it keeps its numbers (but for the sign of an
  /// inner normal).
  std::optional<Vec3d> new_position(std::size_t v) const;
  std::optional<Vec3d> new_normal(std::size_t n) const;

  /// Appends three numbers, each behind a blank.
  void append_position(std::string& text, std::size_t v) const;
  void append_normal(std::string& text, std::size_t n) const;
  /// Appends one of three numbers; `word` is the source's text of it.
  void append_coordinate(std::string& text, std::size_t v, int k, std::string_view word) const;
  void append_normal_component(std::string& text, std::size_t n, int k, std::string_view word) const;

 private:
  std::string_view word_at(std::uint64_t byte) const;
  std::size_t vertices() const { return positions_.size(); }
  /// The number of a skin's vertex among the shell's.
  std::size_t number(std::size_t v) const { return v < vertices() ? first_vertex_ + v : vertices() + v; }

  const MeshFile& source_;
  const Shell& shell_;
  std::span<const Vec3d> positions_;
  std::uint32_t first_vertex_;
  Rounding precision_;
  NewNormals normals_;
  std::vector<Vec3d> vertex_normals_;  // of the shell's vertices, if splits need normals of their own
};

/// New values of the normals of a file, for a skin of its shell; not reversed for the inner skin.
NewNormals skin_normals(const MeshFile& source, const Shell& shell, ShellPart part, const Rounding& precision);

/// Normals of a shell's vertices, outward: means of the faces of both skins by angle, without the rim. Zero where a
/// vertex has none.
std::vector<Vec3d> shell_vertex_normals(const Shell& shell, const Rounding& precision);

/// A shell that is to be written in the format of its source. Refers to the source and the shell.
struct ShellContent {
  const MeshFile& source;
  const Shell& shell;
  Rounding precision;
  Normals normals;
  Skin outer{source, shell, ShellPart::Outer, precision, normals};
  Skin inner{source, shell, ShellPart::Inner, precision, normals};

  const Skin& skin(ShellPart part) const { return part == ShellPart::Inner ? inner : outer; }
  /// A vertex of the shell: a skin, and its number there.
  struct SkinVertex {
    const Skin& skin;
    std::size_t number;
  };
  SkinVertex vertex(std::uint32_t v) const {
    const Skin& of = skin(shell.skin_of(v));
    const std::size_t count = shell.source_vertices();
    return {of, v < 2 * count ? v - of.first_vertex() : v - count};
  }
};
using SharedShell = std::shared_ptr<const ShellContent>;

}  // namespace vdb_offset::io
