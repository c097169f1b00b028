// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/chunked_output.h"
#include "document/document.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

class CornerFinder;

/// Faces from `begin` to `end`.
struct FaceRange {
  std::uint32_t begin, end;

  std::uint32_t size() const { return end - begin; }
};

/// Where a corner of a face lies: at the vertex's origin, which is at these corners of the face's parent, indices into
/// the source's corners. A copy has one corner, three times.
struct CornerOrigin {
  VertexOrigin vertex;
  std::array<std::uint32_t, 3> corner;
};

/// A mesh that is made of a file's, which is to be written with all that the file has: a shell or a refinement. Refers
/// to both.
///
/// Its first vertices are the source's in their order, moved or not; all others have an origin. Its first faces stand
/// in the place of their parents, faces of the source, in the same order; those of a shell's inner skin and of its rim
/// follow, each of these parts in the order of its parents.
class DerivedMesh {
 public:
  DerivedMesh(const MeshFile& source, const Shell& shell, const Rounding& precision, Normals normals);
  DerivedMesh(const MeshFile& source, const Refinement& refinement);

  const MeshFile& source() const { return source_; }
  PolygonView source_mesh() const { return source_.polygons.view(); }
  PolygonView mesh() const { return mesh_; }
  bool is_shell() const { return shell_ != nullptr; }
  const Rounding& precision() const { return precision_; }

  std::uint32_t source_vertices() const { return static_cast<std::uint32_t>(source_.polygons.positions.size()); }
  std::size_t added_vertices() const { return mesh_.positions.size() - source_vertices(); }
  /// What a vertex has is that of one of the source's, with the share 1; else it lies between some of these.
  bool is_copy(std::uint32_t v) const { return is_shell() || v < source_vertices(); }
  VertexOrigin origin(std::uint32_t v) const;
  bool is_inner(std::uint32_t v) const { return is_shell() && shell_->skin_of(v) == ShellPart::Inner; }
  /// The position as it is written.
  Vec3d position(std::uint32_t v) const;
  /// None if the numbers of the vertex that it is a copy of stay.
  std::optional<Vec3d> new_position(std::uint32_t v) const;
  /// Whether no vertex of a skin has moved.
  bool is_source(ShellPart skin) const;

  std::uint32_t face_count() const { return static_cast<std::uint32_t>(mesh_.face_count()); }
  /// The faces of a part. Those of a refinement are outer ones, and those over ridges are its rim.
  FaceRange faces_of(ShellPart part) const;
  /// The faces that follow those which stand in the place of their parents.
  FaceRange other_faces() const { return {faces_of(ShellPart::Outer).end, face_count()}; }
  /// Of these the ones that lie over ridges, by strips and patches: the parents of each range are ascending.
  std::array<FaceRange, 2> over_ridges() const {
    const FaceRange others = other_faces();
    const auto corners = static_cast<std::uint32_t>(is_shell() ? 0 : refinement_->over_corners);
    return {FaceRange{others.begin, others.end - corners}, FaceRange{others.end - corners, others.end}};
  }
  ShellPart part(std::uint32_t f) const {
    if (is_shell()) return shell_->part(f);
    return f < refinement_->faces_in_place() ? ShellPart::Outer : ShellPart::Rim;
  }
  bool has_ridges() const { return !is_shell() && refinement_->over_ridges > 0; }
  std::uint32_t parent(std::uint32_t f) const { return is_shell() ? shell_->source_face(f) : refinement_->parent[f]; }
  /// The faces that stand in the place of one of the source's.
  FaceRange pieces_of(std::uint32_t source_face) const;
  /// Whether that is one of the same vertices.
  bool is_kept(std::uint32_t source_face) const {
    return is_shell() ? has_one_like(source_face) : is_kept_[source_face] != 0;
  }
  /// Whether that goes for all faces of the source.
  bool keeps_all() const { return is_shell() && shell_->faces.empty() && shell_->splits.empty(); }
  /// Where corner k of a face lies. \throw InvalidInput if its parent has no such vertices
  CornerOrigin corner(std::uint32_t f, std::size_t k, CornerFinder& finder) const;

  /// The new value of one of the source's normals; none if it stays as it is, but for the sign of an inner one.
  std::optional<Vec3d> new_normal(std::size_t n, bool inner) const;
  /// The same of the normal of a vertex that is a copy.
  std::optional<Vec3d> new_vertex_normal(std::uint32_t v) const;
  /// The normal of a vertex, of those at its origin; none if the nearest of these stays.
  std::optional<Vec3d> vertex_normal(std::uint32_t v, const std::array<Vec3d, 3>& of_origin) const;
  std::size_t disagreeing_normals() const { return normals_[0].disagreeing + normals_[1].disagreeing; }
  /// The new normals of the source's vertices, or corners.
  std::shared_ptr<const NewNormals> normals_in_place() const;

  // Of files whose rows are lines of text: numbers that stay keep their words.
  /// Appends three numbers, each behind a blank.
  void append_position(std::string& text, std::uint32_t v) const;
  /// Appends one of three numbers; `word` is that of the vertex that it is a copy of.
  void append_coordinate(std::string& text, std::uint32_t v, int k, std::string_view word) const;
  std::array<std::string, 3> normal_words(std::size_t n, bool inner) const;
  std::array<std::string, 3> vertex_normal_words(std::uint32_t v) const;

  /// The bytes of the source's rows from one byte to another, with the positions and normals of its vertices. Pieces of
  /// a text begin where cut_at_lines() cuts it.
  Pieces rows_in_place(std::size_t begin, std::size_t end) const;

 private:
  bool has_one_like(std::uint32_t source_face) const;
  std::array<std::string_view, 3> words_at(const NumberTriple& at) const;
  std::array<std::string, 3> words_of(const std::optional<Vec3d>& value, bool inner, const NumberTriple& at) const;

  const MeshFile& source_;
  const Shell* shell_ = nullptr;
  const Refinement* refinement_ = nullptr;
  PolygonView mesh_;
  Rounding precision_;
  // Of a refinement, of each face of the source.
  std::vector<std::uint32_t> first_piece_;
  std::vector<std::uint8_t> is_kept_;
  std::array<NewNormals, 2> normals_;  // of the outer skin, and of the inner one, not reversed
  std::vector<Vec3d> vertex_normals_;  // of all vertices, if splits need normals of their own
};
using SharedDerived = std::shared_ptr<const DerivedMesh>;

// Inline, as modules use them that have nothing else of this class (modules.cmake).

inline VertexOrigin DerivedMesh::origin(std::uint32_t v) const {
  if (!is_copy(v)) return refinement_->added[v - source_vertices()];
  const std::uint32_t of = is_shell() ? shell_->source_vertex(v) : v;
  return {kNone, {of, of, of}, {1, 0, 0}};
}

inline std::optional<Vec3d> DerivedMesh::new_position(std::uint32_t v) const {
  const Vec3d& position = mesh_.positions[v];
  if (!is_copy(v)) return position;
  const Vec3d& before = source_.polygons.positions[origin(v).vertex[0]];
  return has_moved(before, position, precision_) ? std::optional(precision_(before, position)) : std::nullopt;
}

inline Vec3d DerivedMesh::position(std::uint32_t v) const {
  return new_position(v).value_or(source_.polygons.positions[origin(v).vertex[0]]);
}

inline FaceRange DerivedMesh::faces_of(ShellPart part) const {
  const auto of_skin = static_cast<std::uint32_t>(is_shell() ? shell_->skin_faces() : refinement_->faces_in_place());
  if (part == ShellPart::Outer) return {0, of_skin};
  if (!is_shell()) return {of_skin, part == ShellPart::Rim ? face_count() : of_skin};
  return part == ShellPart::Inner ? FaceRange{of_skin, 2 * of_skin} : FaceRange{2 * of_skin, face_count()};
}

inline std::optional<Vec3d> DerivedMesh::new_normal(std::size_t n, bool inner) const {
  const NewNormals& of_skin = normals_[inner];
  if (of_skin.value.empty() || !(of_skin.value[n].lengthSqr() > 0)) return std::nullopt;
  return inner ? Vec3d(0.0) - of_skin.value[n] : of_skin.value[n];
}

inline std::optional<Vec3d> DerivedMesh::new_vertex_normal(std::uint32_t v) const {
  if (vertex_normals_.empty()) return new_normal(origin(v).vertex[0], is_inner(v));
  return vertex_normals_[v].lengthSqr() > 0 ? std::optional(vertex_normals_[v]) : std::nullopt;
}

/// The source's document over the mesh. \pre the document takes faces \throw InvalidInput if the source's file has
/// changed
WrittenDocument derive(const SharedDerived& mesh, const std::string& path);

/// New values of the normals of a file, for a skin of its shell; not reversed for the inner skin.
NewNormals skin_normals(const MeshFile& source, const Shell& shell, ShellPart part, const Rounding& precision);

/// What something is at the vertices that one lies between.
template <class At>
auto at_origin(const VertexOrigin& origin, At&& at) {
  using Value = decltype(at(std::uint32_t{0}));
  return std::array<Value, 3>{at(origin.vertex[0]), at(origin.vertex[1]), at(origin.vertex[2])};
}

}  // namespace vdb_offset::io
