// SPDX-License-Identifier: Apache-2.0
// What writers of all formats ask of a mesh that is made of a file's: where its vertices and faces come from, and which
// numbers they have now. A vertex that did not move keeps its numbers, in a text their words; normals are computed anew
// around faces that moved, for vertices of both skins at once where junctions have split them, and have the other sign
// on the inner skin. Nothing is kept for each vertex and face that a shell or a refinement does not know itself.
#include "derived/derived_mesh.h"

#include <algorithm>
#include <cmath>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "derived/interpolate.h"
#include "derived/refined_corners.h"
#include "document/rows.h"

namespace vdb_offset::io {
namespace {

/// A number with the other sign. A word that is no number is not changed.
std::string negated(std::string_view word) {
  double value = 0;
  if (!parse_double(word, value) || value == 0) return std::string(word);
  if (word.starts_with('-')) return std::string(word.substr(1));
  return "-" + std::string(word.substr(word.starts_with('+') ? 1 : 0));
}

/// Normals of a shell's vertices, outward: means of the faces of both skins by angle, without the rim. Zero where a
/// vertex has none.
std::vector<Vec3d> shell_vertex_normals(const Shell& shell, const Rounding& precision) {
  std::vector<Vec3d> normals(shell.polygons.positions.size(), Vec3d(0.0));
  for (std::size_t f = 0; f < 2 * shell.skin_faces(); ++f) {
    const auto face = shell.polygons.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto at = [&](std::size_t i) { return precision(shell.polygons.positions[face[i % face.size()]]); };
      const Vec3d next = at(k + 1) - at(k), previous = at(k + face.size() - 1) - at(k), across = next.cross(previous);
      const double sine = across.length();
      if (sine > 0) normals[face[k]] += across * (std::atan2(sine, next.dot(previous)) / sine);
    }
  }
  for (Vec3d& normal : normals)
    if (normal.lengthSqr() > 0) normal.normalize();
  return normals;
}

}  // namespace

DerivedMesh::DerivedMesh(const MeshFile& source, const Shell& shell, const Rounding& precision, Normals normals)
    : source_(source), shell_(&shell), mesh_(shell.view()), precision_(precision) {
  if (normals != Normals::Recompute || source.normal_count == 0) return;
  if (source.document->normals_of() == NormalsOf::Vertices && !shell.splits.empty())
    vertex_normals_ = shell_vertex_normals(shell, precision);
  else
    for (const ShellPart skin : {ShellPart::Outer, ShellPart::Inner})
      normals_[skin == ShellPart::Inner] = skin_normals(source, shell, skin, precision);
}

DerivedMesh::DerivedMesh(const MeshFile& source, const Refinement& refinement)
    : source_(source),
      refinement_(&refinement),
      mesh_(refinement.polygons.view()),
      precision_(source.precision),
      first_piece_(source.polygons.face_count() + 1, 0) {
  for (std::size_t f = 0; f < refinement.faces_in_place(); ++f) ++first_piece_[refinement.parent[f] + 1];
  for (std::uint32_t f = 0; f + 1 < first_piece_.size(); ++f) {
    first_piece_[f + 1] += first_piece_[f];
    is_kept_.push_back(has_one_like(f));
  }
}

bool DerivedMesh::is_source(ShellPart skin) const {
  const std::size_t first = skin == ShellPart::Inner ? source_vertices() : 0;
  return std::ranges::equal(mesh_.positions.subspan(first, source_vertices()), source_.polygons.positions);
}

FaceRange DerivedMesh::pieces_of(std::uint32_t source_face) const {
  if (!is_shell()) return {first_piece_[source_face], first_piece_[source_face + 1]};
  const std::uint32_t face = shell_->skin_face(source_face);
  return face == kNone ? FaceRange{0, 0} : FaceRange{face, face + 1};
}

bool DerivedMesh::has_one_like(std::uint32_t source_face) const {
  const FaceRange pieces = pieces_of(source_face);
  return pieces.size() == 1 && std::ranges::equal(mesh_.face(pieces.begin), source_mesh().face(source_face));
}

CornerOrigin DerivedMesh::corner(std::uint32_t f, std::size_t k, CornerFinder& finder) const {
  CornerOrigin found{origin(mesh_.face(f)[k]), {}};
  const std::uint32_t of = parent(f), first = source_.polygons.face_begin[of];
  if (is_shell()) found.corner.fill(shell_->source_corner(source_mesh(), f, k));
  else if (is_kept(of) && part(f) == ShellPart::Outer) found.corner.fill(first + static_cast<std::uint32_t>(k));
  else
    for (std::size_t i = 0; i < 3; ++i)
      found.corner[i] = found.vertex.share[i] > 0 ? finder.at(of, found.vertex.vertex[i]) : first;
  return found;
}

std::optional<Vec3d> DerivedMesh::vertex_normal(std::uint32_t v, const std::array<Vec3d, 3>& of_origin) const {
  if (!is_copy(v)) {
    const Vec3d between = interpolated_normal(origin(v), of_origin);
    return between.isFinite() ? std::optional(between) : std::nullopt;
  }
  if (const auto known = new_vertex_normal(v)) return known;
  return is_inner(v) ? std::optional(Vec3d(0.0) - of_origin[0]) : std::nullopt;
}

std::shared_ptr<const NewNormals> DerivedMesh::normals_in_place() const {
  const auto normals = std::make_shared<NewNormals>(normals_[0]);
  if (!vertex_normals_.empty())
    normals->value.assign(vertex_normals_.begin(), vertex_normals_.begin() + source_vertices());
  return normals;
}

void DerivedMesh::append_coordinate(std::string& text, std::uint32_t v, int k, std::string_view word) const {
  if (const auto position = new_position(v)) append_number(text, (*position)[k], precision_);
  else text += word;
}

void DerivedMesh::append_position(std::string& text, std::uint32_t v) const {
  const NumberTriple at = rows_of(source_).position_at[origin(v).vertex[0]];
  const auto words = is_copy(v) ? words_at(at) : std::array<std::string_view, 3>();
  for (int k = 0; k < 3; ++k) append_coordinate(text += ' ', v, k, words[static_cast<std::size_t>(k)]);
}

std::array<std::string_view, 3> DerivedMesh::words_at(const NumberTriple& at) const {
  const Rows::Syntax& syntax = rows_of(source_).syntax();
  std::array<std::string_view, 3> words;
  for (std::size_t k = 0; k < 3; ++k)
    words[k] = Scanner(source_.path, source_.text(), at.at[k], syntax.joins_lines, syntax.comment).token();
  return words;
}

std::array<std::string, 3> DerivedMesh::words_of(const std::optional<Vec3d>& value, bool inner,
                                                 const NumberTriple& at) const {
  const std::array<std::string_view, 3> known = words_at(at);
  std::array<std::string, 3> words;
  for (std::size_t k = 0; k < 3; ++k) {
    // Single precision is enough for a normal.
    if (value) append_number(words[k], (*value)[static_cast<int>(k)], {Rounding::Kind::Single});
    else words[k] = inner ? negated(known[k]) : std::string(known[k]);
  }
  return words;
}

std::array<std::string, 3> DerivedMesh::normal_words(std::size_t n, bool inner) const {
  return words_of(new_normal(n, inner), inner, rows_of(source_).normal_at[n]);
}

std::array<std::string, 3> DerivedMesh::vertex_normal_words(std::uint32_t v) const {
  const VertexOrigin of = origin(v);
  const ByteOffsets& normal_at = rows_of(source_).normal_at;
  if (is_copy(v)) return words_of(new_vertex_normal(v), is_inner(v), normal_at[of.vertex[0]]);
  return interpolated_normal_words(of, at_origin(of, [&](std::uint32_t n) { return words_at(normal_at[n]); }));
}

Pieces DerivedMesh::rows_in_place(std::size_t begin, std::size_t end) const {
  return rewrite_rows(source_, mesh_.positions.first(source_vertices()), precision_, normals_in_place(), begin, end);
}

WrittenDocument derive(const SharedDerived& mesh, const std::string& path) {
  WrittenDocument written = mesh->source().document->derive(mesh, path);
  if (has_rows(mesh->source())) written.file = with_line_ends_of(mesh->source(), std::move(written.file));
  return written;
}

NewNormals skin_normals(const MeshFile& source, const Shell& shell, ShellPart part, const Rounding& precision) {
  const bool inner = part == ShellPart::Inner;
  if (shell.splits.empty())
    return new_normals(source, inner ? shell.inner() : shell.outer(), precision, {.faces = shell.faces});
  const PolygonView mesh = source.polygons.view();
  std::vector<std::uint32_t> corners = source.polygons.corners, origin(shell.polygons.positions.size());
  for (std::uint32_t v = 0; v < origin.size(); ++v) origin[v] = shell.source_vertex(v);
  const std::size_t first = inner ? shell.skin_faces() : 0;
  for (std::size_t f = first; f < first + shell.skin_faces(); ++f) {
    const auto face = shell.polygons.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) corners[shell.source_corner(mesh, f, k)] = face[k];
  }
  return new_normals(source, shell.polygons.positions, precision, {shell.faces, corners, origin});
}

}  // namespace vdb_offset::io
