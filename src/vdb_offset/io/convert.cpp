#include "vdb_offset/io/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/io/encode.h"
#include "vdb_offset/io/normals.h"
#include "vdb_offset/io/shell_formats.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset::io {
namespace {

/// Normals of faces that moved are computed from the coordinates as written, and need no more than single precision.
void update_normals(const MeshFile& source, std::span<const Vec3d> positions, const Precision& precision,
                    std::vector<Vec3d>& normals, std::size_t& disagreeing) {
  const NewNormals computed = new_normals(source, positions, precision);
  disagreeing += computed.disagreeing;
  const Precision single{Precision::Kind::Single};
  for (std::size_t n = 0; n < normals.size(); ++n)
    if (computed.value[n].lengthSqr() > 0) normals[n] = single(computed.value[n]);
}

/// Turns values of corners into those of vertices, zero where a vertex is no corner. False, and they stay, if the
/// corners of a vertex have different ones or none.
template <class Value>
bool make_per_vertex(PolygonView mesh, CornerValues<Value>& values) {
  if (values.empty() || values.of_corner.empty()) return true;
  std::vector<Value> of_vertex(mesh.positions.size(), Value(0.0));
  std::vector<std::uint8_t> is_known(mesh.positions.size(), 0);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::uint32_t v = mesh.corners[c], index = values.of_corner[c];
    if (index == kNoNormal || (is_known[v] && !(of_vertex[v] == values.value[index]))) return false;
    of_vertex[v] = values.value[index];
    is_known[v] = 1;
  }
  values.value = std::move(of_vertex);
  values.of_corner.clear();
  return true;
}

/// Whether all colours are bytes, to the three digits that a text has of a byte.
bool are_bytes(const std::vector<std::array<double, 4>>& colours) {
  const auto is_byte = [](double colour) { return std::abs(colour - colour_byte(colour) / 255.0) <= 0.0005; };
  return std::all_of(colours.begin(), colours.end(),
                     [&](const auto& colour) { return std::all_of(colour.begin(), colour.end(), is_byte); });
}

/// Takes the values of faces that have them at some corners only. False if there are none of these.
template <class Value>
bool take_off_partial_faces(PolygonView mesh, CornerValues<Value>& values) {
  bool taken = false, left = false;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto first = values.of_corner.begin() + mesh.face_begin[f],
               last = values.of_corner.begin() + mesh.face_begin[f + 1];
    const auto without = std::count(first, last, kNoNormal);
    left |= without == 0;
    if (without == 0 || without == last - first) continue;
    std::fill(first, last, kNoNormal);
    taken = true;
  }
  if (!left) values = {};
  return taken;
}

/// Drops what the format has no place for, and names it.
void fit(Format target, PolygonView mesh, Attributes& attributes) {
  auto& [colours, has_alpha, texture, normals, lost] = attributes;
  const auto drop = [&lost = lost](auto& what, const char* in_words) {
    if (!what.empty()) lost.emplace_back(in_words);
    what = {};
  };
  if (target == Format::Obj) return;
  if (target == Format::Stl) {
    drop(colours, "vertex colours");
    drop(texture, "texture coordinates");
    drop(normals, "normals of vertices");
    return;
  }
  if (!are_bytes(colours)) lost.emplace_back("digits of colours beyond 8 bits");
  if (!make_per_vertex(mesh, normals)) drop(normals, "normals (not one for each vertex)");
  if (make_per_vertex(mesh, texture)) return;
  if (target == Format::Off) drop(texture, "texture coordinates (not one for each vertex)");
  else if (take_off_partial_faces(mesh, texture))
    lost.emplace_back("texture coordinates of faces that have them at some corners only");
}

/// What triangles of single precision cannot hold.
void name_losses_of_triangles(const MeshFile& source, std::vector<std::string>& lost) {
  lost.emplace_back("shared vertices");
  const auto& begin = source.polygons.face_begin;
  for (std::size_t f = 0; f + 1 < begin.size(); ++f)
    if (begin[f + 1] - begin[f] > 3) {
      lost.emplace_back("faces of more than three corners (split into triangles)");
      break;
    }
  lost.emplace_back("digits beyond single precision");
}

/// What each skin's vertices have.
template <class Value>
void double_up(std::vector<Value>& of_vertices) {
  const std::size_t count = of_vertices.size();
  of_vertices.resize(2 * count);
  std::copy_n(of_vertices.begin(), count, of_vertices.begin() + static_cast<std::ptrdiff_t>(count));
}

/// What the corners of a shell name, by what those of its mesh do; those of the rim what the corners of its border
/// face do.
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

/// Normals of the inner skin point the other way. The rim has none of its own: in a format that has normals of vertices
/// only, those of the skins.
void add_inner_normals(PolygonView mesh, const Shell& shell, bool of_corners, const std::vector<Vec3d>& inner,
                       CornerValues<Vec3d>& normals) {
  const auto count = static_cast<std::uint32_t>(normals.value.size());
  if (of_corners || !normals.of_corner.empty()) {
    normals.of_corner = values_of_shell(mesh, shell, normals);
    const std::size_t rim = shell.polygons.face_begin[2 * shell.source_faces()];
    for (std::size_t c = 0; c < normals.of_corner.size(); ++c) {
      std::uint32_t& normal = normals.of_corner[c];
      if (of_corners && c >= rim) normal = kNoNormal;
      if (normal != kNoNormal && shell.polygons.corners[c] >= shell.source_vertices()) normal += count;
    }
  }
  for (const Vec3d& normal : inner) normals.value.push_back(Vec3d(0.0) - normal);
}

std::vector<Part> parts_of(const Shell& shell) {
  std::vector<Part> parts;
  const std::size_t faces[kShellPartCount] = {shell.source_faces(), shell.source_faces(), shell.rim.size()};
  for (const ShellPart part : {ShellPart::Outer, ShellPart::Inner, ShellPart::Rim})
    if (const std::size_t count = faces[static_cast<std::size_t>(part)]; count > 0)
      parts.push_back({name(part), count});
  return parts;
}

bool keeps_parts(Format format) { return format == Format::Obj || format == Format::Ply; }

/// Drops what would be no number, and what the format has no place for.
Pieces encode_fitting(const MeshFile& source, Format target, const std::shared_ptr<Content>& content,
                      WriteResult& result) {
  Attributes& with = content->with;
  if (!std::all_of(with.normals.value.begin(), with.normals.value.end(), [](const Vec3d& n) { return n.isFinite(); })) {
    with.normals = {};
    with.lost.emplace_back("normals");
  }
  fit(target, content->mesh, with);
  if (target == Format::Stl) name_losses_of_triangles(source, with.lost);
  if (!content->parts.empty() && !keeps_parts(target)) with.lost.emplace_back(kShellParts);
  result.lost = fmt::format("{}", fmt::join(with.lost, ", "));
  return encode(target, content);
}

}  // namespace

Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Precision& precision,
               Normals normals, WriteResult& result) {
  const PolygonView mesh{positions, source.polygons.corners, source.polygons.face_begin};
  const auto content = std::make_shared<Content>(Content{mesh, precision, read_attributes(source), {}});
  Attributes& with = content->with;
  if (!with.normals.empty() && normals == Normals::Recompute && target != Format::Stl)
    update_normals(source, positions, precision, with.normals.value, result.disagreeing_normals);
  return encode_fitting(source, target, content, result);
}

Pieces convert(const MeshFile& source, Format target, const Shell& shell, const Precision& precision, Normals normals,
               WriteResult& result) {
  const PolygonView mesh = source.polygons.view();
  const auto content =
      std::make_shared<Content>(Content{shell.polygons.view(), precision, read_attributes(source), parts_of(shell)});
  Attributes& with = content->with;
  double_up(with.colours);
  if (!with.texture.of_corner.empty()) with.texture.of_corner = values_of_shell(mesh, shell, with.texture);
  else double_up(with.texture.value);
  if (!with.normals.empty()) {
    std::vector<Vec3d> inner = with.normals.value;
    if (normals == Normals::Recompute && target != Format::Stl) {
      update_normals(source, shell.outer(), precision, with.normals.value, result.disagreeing_normals);
      update_normals(source, shell.inner(), precision, inner, result.disagreeing_normals);
    }
    add_inner_normals(mesh, shell, target == Format::Obj, inner, with.normals);
  }
  return encode_fitting(source, target, content, result);
}

Pieces convert(Format target, const Shell& shell, const Precision& precision, WriteResult& result) {
  if (!keeps_parts(target)) result.lost = kShellParts;
  return encode(target, std::make_shared<Content>(Content{shell.polygons.view(), precision, {}, parts_of(shell)}));
}

}  // namespace vdb_offset::io
