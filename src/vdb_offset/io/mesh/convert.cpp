#include "vdb_offset/io/mesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/io/base/nearest_names.h"
#include "vdb_offset/io/mesh/encode.h"
#include "vdb_offset/io/mesh/new_normals.h"
#include "vdb_offset/io/shell/shell_writers.h"
#include "vdb_offset/iso/source_lookup.h"

namespace vdb_offset::io {
namespace {

/// Normals of faces that moved are computed from the coordinates as written, and need no more than single precision.
void update_normals(const NewNormals& computed, std::vector<Vec3d>& normals, WriteResult& result) {
  result.disagreeing_normals += computed.disagreeing;
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

CornerValues<Vec3d> normals_of(const CaptureResult& captured) {
  const Precision single{Precision::Kind::Single};
  CornerValues<Vec3d> normals{captured.normals, {}, true};
  for (Vec3d& normal : normals.value) normal = single(normal);
  return normals;
}

/// Colours of the closest points.
std::vector<std::array<double, 4>> colours_of(const SourceLookup& lookup, PolygonView source, const Attributes& with,
                                              std::size_t vertices) {
  std::vector<std::array<double, 4>> colours(vertices, {0, 0, 0, 0});
  for_each_index(vertices, [&](std::size_t v) {
    const SourcePoint point = lookup.at_vertex(static_cast<std::uint32_t>(v));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 4; ++k)
        colours[v][k] += point.weight[i] * with.colours[source.corners[point.corner[i]]][k];
    for (double& colour : colours[v]) colour = std::clamp(colour, 0.0, 1.0);  // rounding
  });
  return colours;
}

/// Numbers alike what is of equal value: seams are where values differ. What has none is alike, too.
std::vector<std::uint32_t> number_values(PolygonView source, const CornerValues<Vec2d>& texture) {
  std::vector<std::uint32_t> order(texture.value.size()), number(order.size()), of_corner(source.corners.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec2d &u = texture.value[a], &v = texture.value[b];
    return std::pair(u[0], u[1]) < std::pair(v[0], v[1]);
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t i = 0; i < order.size(); ++i)
    number[order[i]] = i > 0 && !less(order[i - 1], order[i]) ? number[order[i - 1]] : static_cast<std::uint32_t>(i);
  for (std::size_t c = 0; c < of_corner.size(); ++c) {
    const std::uint32_t index = texture.index(c, source.corners[c]);
    of_corner[c] = index == kNoNormal ? kNoNormal : number[index];
  }
  return of_corner;
}

/// The texture coordinates at a point, if all corners around it have some.
std::optional<Vec2d> texture_at(const SourcePoint& point, PolygonView source, const CornerValues<Vec2d>& texture) {
  Vec2d uv(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t index = texture.index(point.corner[i], source.corners[point.corner[i]]);
    if (index == kNoNormal) return std::nullopt;
    uv += texture.value[index] * point.weight[i];
  }
  return uv;
}

/// One value for all corners of a vertex that have the same.
CornerValues<Vec2d> texture_of(const CaptureResult& captured, SourceLookup& lookup, PolygonView source,
                               const CornerValues<Vec2d>& texture) {
  lookup.cut_into_charts(number_values(source, texture));
  const std::vector<std::uint32_t>& corners = captured.polygons.corners;
  std::vector<std::optional<Vec2d>> at(corners.size());
  for_each_index(corners.size(),
                 [&](std::size_t c) { at[c] = texture_at(lookup.at_corner(c / 3, c % 3), source, texture); });
  CornerValues<Vec2d> result;
  result.single = texture.single;
  result.of_corner.assign(corners.size(), kNoNormal);
  std::vector<std::uint32_t> latest(captured.polygons.positions.size(), kNoNormal), before;  // of a vertex, of a value
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (!at[c]) continue;
    std::uint32_t known = latest[corners[c]];
    while (known != kNoNormal && !(result.value[known] == *at[c])) known = before[known];
    if (known == kNoNormal) {
      known = static_cast<std::uint32_t>(result.value.size());
      result.value.push_back(*at[c]);
      before.push_back(std::exchange(latest[corners[c]], known));
    }
    result.of_corner[c] = known;
  }
  return result;
}

/// Puts the triangles in the order of their materials, and what their corners name with them.
void sort_by_material(const SourceLookup& lookup, const Materials& materials, Content& content, Polygons& mesh) {
  const std::size_t count = mesh.face_count();
  std::vector<std::uint32_t> order(count), of_face(count);
  for_each_index(count, [&](std::size_t t) { of_face[t] = materials.of_face[lookup.face_of(t)]; });
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t s, std::uint32_t t) { return of_face[s] < of_face[t]; });
  content.materials = {materials.names, {}, materials.libraries};
  for (const auto t : order) content.materials.of_face.push_back(of_face[t]);
  const auto put_in_order = [&](std::vector<std::uint32_t>& of_corner) {
    const std::vector<std::uint32_t> was = of_corner;
    for (std::size_t c = 0; c < was.size(); ++c) of_corner[c] = was[3 * order[c / 3] + c % 3];
  };
  put_in_order(mesh.corners);
  put_in_order(content.with.texture.of_corner);
}

/// What the vertices of both skins have, and splits of them.
template <class Value>
void double_up(const Shell& shell, std::vector<Value>& of_vertices) {
  if (of_vertices.empty()) return;
  const std::size_t count = of_vertices.size();
  of_vertices.resize(2 * count);
  std::copy_n(of_vertices.begin(), count, of_vertices.begin() + static_cast<std::ptrdiff_t>(count));
  for (const Shell::Split& split : shell.splits) of_vertices.push_back(of_vertices[split.vertex]);
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
/// only, those of the skins; so have splits.
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

std::vector<Part> parts_of(const Hollow& hollow) {
  return {{name(ShellPart::Outer), hollow.outer_faces},
          {name(ShellPart::Inner), hollow.polygons.face_count() - hollow.outer_faces}};
}

/// What the corners of a hollow solid name, by what those of its source do; those of the other skin none.
template <class Value>
std::vector<std::uint32_t> values_of_hollow(PolygonView source, const Hollow& hollow,
                                            const CornerValues<Value>& values) {
  std::vector<std::uint32_t> of_corner(hollow.polygons.corners.size(), kNoNormal);
  const bool is_inside = hollow.source == Hollow::Source::Inner;
  const std::size_t first = is_inside ? hollow.outer_faces : 0;
  for_each_index(source.face_count(), [&](std::size_t f) {
    const std::uint32_t begin = source.face_begin[f], size = source.face_begin[f + 1] - begin;
    for (std::uint32_t k = 0; k < size; ++k) {
      const std::uint32_t corner = begin + (is_inside ? (size - k) % size : k);
      of_corner[hollow.polygons.face_begin[first + f] + k] = values.index(corner, source.corners[corner]);
    }
  });
  return of_corner;
}

/// The other skin's values behind the source's, or in front of them if that is inside.
template <class Value>
void add_other_skin(const Hollow& hollow, std::vector<Value> other, std::vector<Value>& values) {
  if (hollow.source == Hollow::Source::Inner) values.swap(other);
  values.insert(values.end(), other.begin(), other.end());
}

bool keeps_parts(Format format) { return format == Format::Obj || format == Format::Ply; }

Pieces keep_alive(Pieces pieces, std::shared_ptr<const Polygons> mesh) {
  return {pieces.count, [make = std::move(pieces.make), mesh = std::move(mesh)](std::size_t i) { return make(i); }};
}

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
  result.lost = first_names(with.lost);
  return encode(target, content);
}

}  // namespace

Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Precision& precision,
               Normals normals, WriteResult& result) {
  const PolygonView mesh{positions, source.polygons.corners, source.polygons.face_begin};
  const auto content = std::make_shared<Content>(Content{mesh, precision, read_attributes(source), {}, {}});
  Attributes& with = content->with;
  if (!with.normals.empty() && normals == Normals::Recompute && target != Format::Stl)
    update_normals(new_normals(source, positions, precision), with.normals.value, result);
  return encode_fitting(source, target, content, result);
}

Pieces convert(const MeshFile& source, Format target, const Shell& shell, const Precision& precision, Normals normals,
               WriteResult& result) {
  const PolygonView mesh = source.polygons.view();
  const auto content = std::make_shared<Content>(
      Content{shell.polygons.view(), precision, read_attributes(source), parts_of(shell), {}});
  Attributes& with = content->with;
  double_up(shell, with.colours);
  if (!with.texture.of_corner.empty()) with.texture.of_corner = values_of_shell(mesh, shell, with.texture);
  else double_up(shell, with.texture.value);
  if (!with.normals.empty()) {
    std::vector<Vec3d> inner = with.normals.value;
    if (normals == Normals::Recompute && target != Format::Stl) {
      update_normals(skin_normals(source, shell, ShellPart::Outer, precision), with.normals.value, result);
      update_normals(skin_normals(source, shell, ShellPart::Inner, precision), inner, result);
    }
    add_inner_normals(mesh, shell, target == Format::Obj, inner, with.normals);
  }
  return encode_fitting(source, target, content, result);
}

Pieces convert(Format target, const Shell& shell, const Precision& precision, WriteResult& result) {
  if (!keeps_parts(target)) result.lost = kShellParts;
  return encode(target, std::make_shared<Content>(Content{shell.polygons.view(), precision, {}, parts_of(shell), {}}));
}

Pieces convert(const MeshFile& source, Format target, const Hollow& hollow, const CaptureResult& captured,
               WriteResult& result) {
  const PolygonView mesh = source.polygons.view();
  // Positions are what is written already.
  const auto content =
      std::make_shared<Content>(Content{hollow.polygons.view(), {}, read_attributes(source), parts_of(hollow), {}});
  Attributes& with = content->with;
  const SourceLookup lookup(captured, mesh);
  if (!with.colours.empty())
    add_other_skin(hollow, colours_of(lookup, mesh, with, captured.polygons.positions.size()), with.colours);
  if (!with.texture.empty()) with.texture.of_corner = values_of_hollow(mesh, hollow, with.texture);
  if (!with.normals.empty()) {
    with.normals.of_corner = values_of_hollow(mesh, hollow, with.normals);
    if (hollow.source == Hollow::Source::Inner)
      for (Vec3d& normal : with.normals.value) normal = Vec3d(0.0) - normal;
  }
  if (Materials materials = read_materials(source); target == Format::Obj && !materials.of_face.empty()) {
    std::erase(with.lost, "materials");
    std::vector<std::uint32_t> other(captured.polygons.face_count());
    for (std::size_t t = 0; t < other.size(); ++t) other[t] = materials.of_face[lookup.face_of(t)];
    add_other_skin(hollow, std::move(other), materials.of_face);
    content->materials = std::move(materials);
  }
  return encode_fitting(source, target, content, result);
}

Pieces convert(Format target, const Hollow& hollow, WriteResult& result) {
  if (!keeps_parts(target)) result.lost = kShellParts;
  return encode(target, std::make_shared<Content>(Content{hollow.polygons.view(), {}, {}, parts_of(hollow), {}}));
}

Pieces convert(const MeshFile& source, Format target, const CaptureResult& captured, const Transported& transported,
               const Precision& precision, WriteResult& result) {
  const PolygonView from = source.polygons.view();
  const Attributes& of_source = transported.attributes;
  // Sorted, the triangles are a copy, which must live as long as the pieces.
  const auto mesh = std::make_shared<Polygons>(captured.polygons);
  const auto content = std::make_shared<Content>(Content{mesh->view(), precision, {}, {}, {}});
  Attributes& with = content->with;
  with.lost = of_source.lost;
  if (target != Format::Stl) with.normals = normals_of(captured);
  SourceLookup lookup(captured, from);
  with.has_alpha = of_source.has_alpha;
  if (!of_source.colours.empty()) with.colours = colours_of(lookup, from, of_source, mesh->positions.size());
  if (!of_source.texture.empty()) with.texture = texture_of(captured, lookup, from, of_source.texture);
  if (target == Format::Obj && !transported.materials.of_face.empty()) {
    std::erase(with.lost, "materials");
    sort_by_material(lookup, transported.materials, *content, *mesh);
  }
  fit(target, content->mesh, with);
  result.lost = first_names(with.lost);
  return keep_alive(encode(target, content), mesh);
}

Pieces convert(Format target, const CaptureResult& captured, const Precision& precision) {
  const auto content = std::make_shared<Content>(Content{captured.polygons.view(), precision, {}, {}, {}});
  if (target != Format::Stl) content->with.normals = normals_of(captured);
  return encode(target, content);
}

}  // namespace vdb_offset::io
