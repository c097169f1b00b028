// SPDX-License-Identifier: Apache-2.0
// Writes a shell of a mesh from a file. In the source's own format the shell is written by the source's rows: Skin has
// for each vertex and normal of a skin the source's own text, new numbers where something moved, and the other sign for
// inner normals. Other formats, and files of strips of triangles, are converted (derived/convert_shell.cpp). Normals
// are computed anew around faces that moved, for vertices of both skins at once where junctions have split them.
// Vertices that did not move keep their numbers, and what the target cannot hold is named. Nothing is put in place if
// the source's bytes have changed meanwhile. Faces and positions of the shell are taken as they are (see
// products/shell).
#include "vdb_offset/io/derived_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bytes/append_number.h"
#include "bytes/nearest_names.h"
#include "bytes/scanner.h"
#include "derived/convert_shell.h"
#include "derived/shell_writers.h"
#include "document/require_format.h"
#include "document/rows.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// Single precision is enough for a normal.
const Rounding kNormalPrecision{Rounding::Kind::Single};

void require_same_mesh(const MeshFile& source, const Shell& shell) {
  const std::size_t faces = source.polygons.face_count();
  if (shell.source_vertices() == source.polygons.positions.size() &&
      (shell.faces.empty() ? shell.skin_faces() == faces : shell.faces.back() < faces))
    return;
  throw InvalidInput(fmt::format("write_shell: expected a shell of {} vertices and {} faces, got one of {} and {}",
                                 source.polygons.positions.size(), faces, shell.source_vertices(), shell.skin_faces()));
}

/// A number with the other sign. A word that is no number is not changed.
std::string negated(std::string_view word) {
  double value = 0;
  if (!parse_double(word, value) || value == 0) return std::string(word);
  if (word.starts_with('-')) return std::string(word.substr(1));
  return "-" + std::string(word.substr(word.starts_with('+') ? 1 : 0));
}

}  // namespace

Skin::Skin(const MeshFile& source, const Shell& shell, ShellPart part, const Rounding& precision, Normals normals)
    : source_(source),
      shell_(shell),
      positions_(part == ShellPart::Inner ? shell.inner() : shell.outer()),
      first_vertex_(part == ShellPart::Inner ? static_cast<std::uint32_t>(positions_.size()) : 0),
      precision_(precision) {
  if (normals != Normals::Recompute || source.normal_count == 0) return;
  const bool of_vertices = source.document->normals_of() == NormalsOf::Vertices;
  if (of_vertices && !shell.splits.empty()) vertex_normals_ = shell_vertex_normals(shell, precision);
  else normals_ = skin_normals(source, shell, part, precision);
}

bool Skin::is_source() const {
  return std::equal(positions_.begin(), positions_.end(), source_.polygons.positions.begin());
}

Vec3d Skin::position(std::size_t v) const { return new_position(v).value_or(source_.polygons.positions[source_of(v)]); }

std::optional<Vec3d> Skin::new_position(std::size_t v) const {
  const Vec3d& position = shell_.polygons.positions[number(v)];
  if (!has_moved(source_.polygons.positions[source_of(v)], position, precision_)) return std::nullopt;
  return precision_(position);
}

std::optional<Vec3d> Skin::new_normal(std::size_t n) const {
  if (!vertex_normals_.empty()) {
    const Vec3d& normal = vertex_normals_[number(n)];
    return normal.lengthSqr() > 0 ? std::optional(normal) : std::nullopt;
  }
  if (normals_.value.empty() || !(normals_.value[n].lengthSqr() > 0)) return std::nullopt;
  return is_reversed() ? Vec3d(0.0) - normals_.value[n] : normals_.value[n];
}

void Skin::append_coordinate(std::string& text, std::size_t v, int k, std::string_view word) const {
  if (const auto position = new_position(v)) append_number(text, (*position)[k], precision_);
  else text += word;
}

void Skin::append_normal_component(std::string& text, std::size_t n, int k, std::string_view word) const {
  if (const auto normal = new_normal(n)) append_number(text, (*normal)[k], kNormalPrecision);
  else text += is_reversed() ? negated(word) : std::string(word);
}

void Skin::append_position(std::string& text, std::size_t v) const {
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append_coordinate(text, v, k, word_at(rows_of(source_).position_at[source_of(v)].at[k]));
  }
}

void Skin::append_normal(std::string& text, std::size_t n) const {
  const std::size_t at = vertex_normals_.empty() ? n : source_of(n);
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append_normal_component(text, n, k, word_at(rows_of(source_).normal_at[at].at[k]));
  }
}

std::string_view Skin::word_at(std::uint64_t byte) const {
  const Rows::Syntax& syntax = rows_of(source_).syntax();
  return Scanner(source_.path, source_.text(), byte, syntax.joins_lines, syntax.comment).token();
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

WriteResult write_shell(const Target& target, const MeshFile& source, const Shell& shell) {
  require_same_mesh(source, shell);
  WriteResult result;
  Pieces pieces;
  // The source's rows are kept unless they are strips, which cannot be reversed face by face.
  if (target.format == source.format && has_rows(source) && rows_of(source).has_face_rows()) {
    const auto content = std::make_shared<ShellContent>(ShellContent{source, shell, target.precision, target.normals});
    std::vector<std::string> lost;
    pieces = with_line_ends_of(source, rows_of(source).with_shell(content, lost));
    result.disagreeing_normals = content->outer.new_normals().disagreeing + content->inner.new_normals().disagreeing;
    result.lost = first_names(lost);
  } else {
    pieces = convert(source, target.format, shell, target.precision, target.normals, result);
  }
  write_pieces_of(source.path, source.bytes, target.path, pieces);
  return result;
}

WriteResult write_shell(const Target& target, const Shell& shell) {
  WriteResult result;
  write_pieces(target.path, convert(target.format, shell, target.precision, result));
  return result;
}

}  // namespace vdb_offset::io
