// SPDX-License-Identifier: Apache-2.0
// Gives iso-surfaces and hollow solids the attributes of their source, and encodes them. A vertex takes the colour of
// its closest point, interpolated on the triangle there. Texture coordinates come from the chart of each triangle, so
// that seams run between triangles; corners of a vertex with equal ones share one value. Materials, which only OBJ
// keeps, are those closest to the centres of triangles; an iso-surface is sorted by them. Of a hollow solid, the skin
// that is the source keeps all that it has, with normals turned round if it is the inner one, and the other skin takes
// colours and materials alone. Normals of an iso-surface are gradients of the distance. What the format cannot hold is
// named. Closest points are found in products/iso/source_lookup.cpp, and positions stay as they come.
#include "derived/convert_iso.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "bytes/nearest_names.h"
#include "document/convert.h"
#include "ground/system/parallel.h"
#include "products/iso/source_lookup.h"

namespace vdb_offset::io {
namespace {

CornerValues<Vec3d> normals_of(const IsoResult& iso) {
  const Rounding single{Rounding::Kind::Single};
  CornerValues<Vec3d> normals{iso.normals, {}, true};
  for (Vec3d& normal : normals.value) normal = single(normal);
  return normals;
}

/// The colours of the closest points of the source.
std::vector<std::array<double, 4>> colours_of(const SourceLookup& lookup, PolygonView source, const Attributes& with,
                                              std::size_t vertices) {
  std::vector<std::array<double, 4>> colours(vertices, {0, 0, 0, 0});
  for_each_index(vertices, [&](std::size_t v) {
    const SourcePoint point = lookup.at_vertex(static_cast<std::uint32_t>(v));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 4; ++k)
        colours[v][k] += point.weight[i] * with.colours[source.corners[point.corner[i]]][k];
    for (double& colour : colours[v])
      colour = std::clamp(colour, 0.0, 1.0);  // interpolation may round them out of range
  });
  return colours;
}

/// For each corner a number that is the same for equal values, kNoNormal without a value. Seams are where the numbers
/// differ.
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

/// The texture coordinates at a point. None unless all corners around it have texture coordinates.
std::optional<Vec2d> texture_at(const SourcePoint& point, PolygonView source, const CornerValues<Vec2d>& texture) {
  Vec2d uv(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t index = texture.index(point.corner[i], source.corners[point.corner[i]]);
    if (index == kNoNormal) return std::nullopt;
    uv += texture.value[index] * point.weight[i];
  }
  return uv;
}

/// The texture coordinates of all corners. Corners of a vertex that have equal ones share one value.
CornerValues<Vec2d> texture_of(const IsoResult& iso, SourceLookup& lookup, PolygonView source,
                               const CornerValues<Vec2d>& texture) {
  lookup.cut_into_charts(number_values(source, texture));
  const std::vector<std::uint32_t>& corners = iso.polygons.corners;
  std::vector<std::optional<Vec2d>> at(corners.size());
  for_each_index(corners.size(),
                 [&](std::size_t c) { at[c] = texture_at(lookup.at_corner(c / 3, c % 3), source, texture); });
  CornerValues<Vec2d> result;
  result.single = texture.single;
  result.of_corner.assign(corners.size(), kNoNormal);
  std::vector<std::uint32_t> latest(iso.polygons.positions.size(), kNoNormal),
      before;  // of each vertex: the value that was added last; of each value: the one added before for its vertex
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

/// Sorts the triangles by material, together with what their corners refer to.
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

std::vector<Part> parts_of(const Hollow& hollow) {
  return {{name(ShellPart::Outer), hollow.outer_faces},
          {name(ShellPart::Inner), hollow.polygons.face_count() - hollow.outer_faces}};
}

/// For each corner of a hollow solid the value that the source's corner refers to; kNoNormal on the other skin.
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

/// Adds the values of the other skin: behind those of the source or, if the source is the inner skin, before them.
template <class Value>
void add_other_skin(const Hollow& hollow, std::vector<Value> other, std::vector<Value>& values) {
  if (hollow.source == Hollow::Source::Inner) values.swap(other);
  values.insert(values.end(), other.begin(), other.end());
}

Pieces keep_alive(Pieces pieces, std::shared_ptr<const Polygons> mesh) {
  return {pieces.count, [make = std::move(pieces.make), mesh = std::move(mesh)](std::size_t i) { return make(i); }};
}

}  // namespace

Pieces convert(const MeshFile& source, Format target, const Hollow& hollow, const IsoResult& iso, WriteResult& result) {
  const PolygonView mesh = source.polygons.view();
  // Positions are already those that will be written.
  const auto content =
      std::make_shared<Content>(Content{hollow.polygons.view(), {}, read_attributes(source), parts_of(hollow), {}});
  Attributes& with = content->with;
  const SourceLookup lookup(iso, mesh);
  if (!with.colours.empty())
    add_other_skin(hollow, colours_of(lookup, mesh, with, iso.polygons.positions.size()), with.colours);
  if (!with.texture.empty()) with.texture.of_corner = values_of_hollow(mesh, hollow, with.texture);
  if (!with.normals.empty()) {
    with.normals.of_corner = values_of_hollow(mesh, hollow, with.normals);
    if (hollow.source == Hollow::Source::Inner)
      for (Vec3d& normal : with.normals.value) normal = Vec3d(0.0) - normal;
  }
  if (Materials materials = read_materials(source); target == Format::Obj && !materials.of_face.empty()) {
    std::erase(with.lost, "materials");
    std::vector<std::uint32_t> other(iso.polygons.face_count());
    for (std::size_t t = 0; t < other.size(); ++t) other[t] = materials.of_face[lookup.face_of(t)];
    add_other_skin(hollow, std::move(other), materials.of_face);
    content->materials = std::move(materials);
  }
  return encode_fitting(source, target, content, result);
}

Pieces convert(Format target, const Hollow& hollow, std::optional<double> unit_micrometres, WriteResult& result) {
  if (!keeps_parts(target, {})) result.lost = kShellParts;
  return encode(target, std::make_shared<Content>(
                            Content{hollow.polygons.view(), {}, {}, parts_of(hollow), {}, unit_micrometres}));
}

Pieces convert(const MeshFile& source, Format target, const IsoResult& iso, const Transported& transported,
               const Rounding& precision, WriteResult& result) {
  const PolygonView from = source.polygons.view();
  const Attributes& of_source = transported.attributes;
  // The triangles are sorted, and so are a copy, which must live as long as the pieces.
  const auto mesh = std::make_shared<Polygons>(iso.polygons);
  const auto content = std::make_shared<Content>(Content{mesh->view(), precision, {}, {}, {}});
  content->unit_micrometres = source.unit_micrometres;
  Attributes& with = content->with;
  with.lost = of_source.lost;
  if (holds_normals(target)) with.normals = normals_of(iso);
  SourceLookup lookup(iso, from);
  with.has_alpha = of_source.has_alpha;
  if (!of_source.colours.empty()) with.colours = colours_of(lookup, from, of_source, mesh->positions.size());
  if (!of_source.texture.empty()) with.texture = texture_of(iso, lookup, from, of_source.texture);
  if (target == Format::Obj && !transported.materials.of_face.empty()) {
    std::erase(with.lost, "materials");
    sort_by_material(lookup, transported.materials, *content, *mesh);
  }
  fit_to_format(target, content->mesh, with);
  result.lost = first_names(with.lost);
  return keep_alive(encode(target, content), mesh);
}

Pieces convert(Format target, const IsoResult& iso, const Rounding& precision) {
  const auto content = std::make_shared<Content>(Content{iso.polygons.view(), precision, {}, {}, {}});
  if (holds_normals(target)) content->with.normals = normals_of(iso);
  return encode(target, content);
}

}  // namespace vdb_offset::io
