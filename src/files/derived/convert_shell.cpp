// SPDX-License-Identifier: Apache-2.0
#include "derived/convert_shell.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "derived/derived_mesh.h"
#include "document/convert.h"
#include "ground/system/parallel.h"

namespace vdb_offset::io {
namespace {

/// Extends values of the source's vertices to all vertices of a shell: both skins, and splits.
template <class Value>
void double_up(const Shell& shell, std::vector<Value>& of_vertices) {
  if (of_vertices.empty()) return;
  const std::size_t count = of_vertices.size();
  of_vertices.resize(2 * count);
  std::copy_n(of_vertices.begin(), count, of_vertices.begin() + static_cast<std::ptrdiff_t>(count));
  for (const Shell::Split& split : shell.splits) of_vertices.push_back(of_vertices[split.vertex]);
}

/// For each corner of a shell the value that its corner of the mesh refers to. A corner of the rim has that of the face
/// at its border.
template <class Value>
std::vector<std::uint32_t> values_of_shell(PolygonView mesh, const Shell& shell, const CornerValues<Value>& values) {
  std::vector<std::uint32_t> of_corner(shell.polygons.corners.size());
  for_each_index(shell.polygons.face_count(), [&](std::size_t f) {
    const std::uint32_t begin = shell.polygons.face_begin[f], end = shell.polygons.face_begin[f + 1];
    for (std::uint32_t c = begin; c < end; ++c) {
      const std::uint32_t of_mesh = shell.source_corner(mesh, f, c - begin);
      of_corner[c] = values.index(of_mesh, mesh.corners[of_mesh]);
    }
  });
  return of_corner;
}

/// Adds the normals of the inner skin, which point the other way. The rim has no normals of its own. In a format with
/// normals of vertices only, the rim's vertices and splits have those of the skins.
void add_inner_normals(PolygonView mesh, const Shell& shell, bool of_corners, const std::vector<Vec3d>& inner,
                       CornerValues<Vec3d>& normals) {
  const auto count = static_cast<std::uint32_t>(normals.value.size());
  if (of_corners || !normals.of_corner.empty()) {
    normals.of_corner = values_of_shell(mesh, shell, normals);
    const std::size_t rim = shell.polygons.face_begin[2 * shell.skin_faces()];
    for (std::size_t c = 0; c < normals.of_corner.size(); ++c) {
      std::uint32_t& normal = normals.of_corner[c];
      if (of_corners && c >= rim) normal = kNoNormal;
      const bool on_inner_skin = c < rim ? c >= rim / 2 : shell.skin_of(shell.polygons.corners[c]) == ShellPart::Inner;
      if (normal != kNoNormal && on_inner_skin) normal += count;
    }
  }
  for (const Vec3d& normal : inner) normals.value.push_back(Vec3d(0.0) - normal);
  if (!of_corners && normals.of_corner.empty())
    for (const Shell::Split& split : shell.splits)
      normals.value.push_back(normals.value[split.skin == ShellPart::Inner ? count + split.vertex : split.vertex]);
}

std::vector<Part> parts_of(const Shell& shell) {
  std::vector<Part> parts;
  const std::size_t faces[kShellPartCount] = {shell.skin_faces(), shell.skin_faces(), shell.rim.size()};
  for (const ShellPart part : {ShellPart::Outer, ShellPart::Inner, ShellPart::Rim})
    if (const std::size_t count = faces[static_cast<std::size_t>(part)]; count > 0)
      parts.push_back({name(part), count});
  return parts;
}

}  // namespace

Pieces convert(const MeshFile& source, Format target, const Shell& shell, const Rounding& precision, Normals normals,
               WriteResult& result) {
  const PolygonView mesh = source.polygons.view();
  const auto content =
      std::make_shared<Content>(Content{shell.view(), precision, read_attributes(source), parts_of(shell), {}});
  Attributes& with = content->with;
  double_up(shell, with.colours);
  if (!with.texture.of_corner.empty()) with.texture.of_corner = values_of_shell(mesh, shell, with.texture);
  else double_up(shell, with.texture.value);
  if (!with.normals.empty()) {
    std::vector<Vec3d> inner = with.normals.value;
    if (normals == Normals::Recompute && holds_normals(target)) {
      update_normals(skin_normals(source, shell, ShellPart::Outer, precision), with.normals.value, result);
      update_normals(skin_normals(source, shell, ShellPart::Inner, precision), inner, result);
    }
    add_inner_normals(mesh, shell, holds_corners(target), inner, with.normals);
  }
  return encode_fitting(source, target, content, result);
}

Pieces convert(Format target, const Shell& shell, const Rounding& precision, WriteResult& result) {
  if (!keeps_parts(target, {})) result.lost = kShellParts;
  return encode(target, std::make_shared<Content>(Content{shell.view(), precision, {}, parts_of(shell), {}}));
}

}  // namespace vdb_offset::io
