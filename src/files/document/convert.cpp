// SPDX-License-Identifier: Apache-2.0
// Writes a mesh file as one of another format, with other positions. The attributes of the source are read, normals of
// faces that moved are computed anew, and what the target has no place for is dropped and named in words: nothing is
// lost in silence. Where a format has one value for a vertex, values of corners become values of vertices if all
// corners agree; PLY keeps texture coordinates of corners. Materials go to formats that have them, and the faces of a
// CAD model become parts where there are such. Faces keep their order. Bytes are made by the formats' own writers
// (encode.h); shells and iso-surfaces use the functions here as well.
#include "document/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "bytes/nearest_names.h"
#include "document/document.h"
#include "document/encode.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "ground/system/parallel.h"

namespace vdb_offset::io {
namespace {

/// Turns values of corners into values of vertices; zero for a vertex that is in no face. Returns false, and changes
/// nothing, if the corners of a vertex have different values, or one of them has none.
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

/// Removes the values of faces that have them only at some corners. Returns whether there were such faces.
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

/// Lists what a format of triangles or of single precision cannot hold.
void name_losses_of_triangles(const MeshFile& source, Format target, std::vector<std::string>& lost) {
  if (target == Format::Stl) lost.emplace_back("shared vertices");
  const auto& begin = source.polygons.face_begin;
  for (std::size_t f = 0; f + 1 < begin.size(); ++f)
    if (begin[f + 1] - begin[f] > 3) {
      lost.emplace_back("faces of more than three corners (split into triangles)");
      break;
    }
  if (target == Format::ThreeMf && std::any_of(begin.begin(), begin.end() - 1, [&](const std::uint32_t& first) {
        const auto face = source.polygons.view().face(static_cast<std::size_t>(&first - begin.data()));
        return face.size() == 3 && (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]);
      }))
    lost.emplace_back("triangles that have a vertex twice");
  if (is_single(target) && source.precision.kind != Precision::Kind::Single)
    lost.emplace_back("digits beyond single precision");
}

/// Names the unit where the format cannot state it, or has another one. Numbers without one are taken for millimetres.
void name_loss_of_unit(double micrometres, Format target, std::vector<std::string>& lost) {
  constexpr double kMillimetre = 1e3, kMetre = 1e6;
  const bool is_gltf = target == Format::Gltf || target == Format::Glb;
  if (target == Format::ThreeMf || micrometres == (is_gltf ? kMetre : kMillimetre)) return;
  lost.push_back(fmt::format("the unit ({:g} mm{})", micrometres / kMillimetre,
                             is_gltf ? "; the numbers stay as they are, and are metres now" : ""));
}

/// The faces of a CAD model as parts, which follow each other.
std::vector<Part> parts_of_model(const FaceNames& names) {
  std::vector<Part> parts;
  for (std::size_t f = 0; f < names.group_of.size(); ++f) {
    const std::uint32_t group = names.group_of[f];
    if (f > 0 && group == names.group_of[f - 1]) {
      ++parts.back().faces;
      continue;
    }
    const std::string& layer = names.layers[group];
    parts.push_back({names.groups[group] + (layer.empty() ? "" : " " + layer), 1});
  }
  return parts;
}

}  // namespace

void update_normals(const NewNormals& computed, std::vector<Vec3d>& normals, WriteResult& result) {
  result.disagreeing_normals += computed.disagreeing;
  const Rounding single{Rounding::Kind::Single};
  for (std::size_t n = 0; n < normals.size(); ++n)
    if (computed.value[n].lengthSqr() > 0) normals[n] = single(computed.value[n]);
}

void fit_to_format(Format target, PolygonView mesh, Attributes& attributes) {
  auto& [colours, has_alpha, texture, normals, lost] = attributes;
  const auto drop = [&lost = lost](auto& what, const char* in_words) {
    if (!what.empty()) lost.emplace_back(in_words);
    what = {};
  };
  if (holds_corners(target)) return;
  if (!holds_colours(target)) drop(colours, "vertex colours");
  if (!holds_texture(target)) drop(texture, "texture coordinates");
  if (!holds_normals(target)) drop(normals, "normals of vertices");
  if (!are_bytes(colours)) lost.emplace_back("digits of colours beyond 8 bits");
  if (!make_per_vertex(mesh, normals)) drop(normals, "normals (not one for each vertex)");
  if (make_per_vertex(mesh, texture)) return;
  if (target != Format::Ply) drop(texture, "texture coordinates (not one for each vertex)");
  else if (take_off_partial_faces(mesh, texture))
    lost.emplace_back("texture coordinates of faces that have them at some corners only");
}

bool keeps_parts(Format format, const Attributes& with) {
  // A triangle of 3MF has a colour or a material, by which a part is recognised.
  if (format == Format::ThreeMf) return with.colours.empty();
  return format != Format::Off && format != Format::Stl;
}

Pieces encode_fitting(const MeshFile& source, Format target, const std::shared_ptr<Content>& content,
                      WriteResult& result) {
  Attributes& with = content->with;
  content->unit_micrometres = source.unit_micrometres;
  if (!std::all_of(with.normals.value.begin(), with.normals.value.end(), [](const Vec3d& n) { return n.isFinite(); })) {
    with.normals = {};
    with.lost.emplace_back("normals");
  }
  fit_to_format(target, content->mesh, with);
  if (source.unit_micrometres) name_loss_of_unit(*source.unit_micrometres, target, with.lost);
  if (is_of_triangles(target)) name_losses_of_triangles(source, target, with.lost);
  if (!content->parts.empty() && !keeps_parts(target, with)) with.lost.emplace_back(kShellParts);
  result.lost = first_names(with.lost);
  return encode(target, content);
}

Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Rounding& precision,
               Normals normals, WriteResult& result) {
  const PolygonView mesh{positions, source.polygons.corners, source.polygons.face_begin};
  const auto content = std::make_shared<Content>(Content{mesh, precision, read_attributes(source), {}, {}});
  if (is_of_triangles(target)) {
    content->triangles = split_polygons(source.polygons.view());
    content->mesh.triangles = content->triangles;
  }
  Attributes& with = content->with;
  if (target == Format::ThreeMf || is_gltf(target) || (!has_rows(source) && target == Format::Obj))
    if (Materials materials = read_materials(source); !materials.of_face.empty()) {
      content->materials = std::move(materials);
      // Their names alone; and in 3MF not these either where vertices have colours: a triangle has either.
      if (target != Format::ThreeMf || with.colours.empty())
        std::replace(with.lost.begin(), with.lost.end(), std::string("materials"),
                     std::string(target == Format::ThreeMf ? "colours of materials" : "what materials are made of"));
    }
  // In 3MF a triangle has a material or says of which part it is.
  if (is_cad(source.format) && keeps_parts(target, with) &&
      !(target == Format::ThreeMf && !content->materials.of_face.empty()))
    content->parts = parts_of_model(source.document->face_names());
  if (!with.normals.empty() && normals == Normals::Recompute && holds_normals(target))
    update_normals(new_normals(source, positions, precision), with.normals.value, result);
  return encode_fitting(source, target, content, result);
}

}  // namespace vdb_offset::io
