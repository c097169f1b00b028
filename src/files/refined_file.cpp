// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/derived_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "derived/derived_mesh.h"
#include "document/convert.h"
#include "document/rows.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

[[noreturn]] void misfit(const std::string& expected, const std::string& found) {
  throw InvalidInput(fmt::format("refine_file: expected {}, got {}", expected, found));
}

/// Whether two positions are the same to the bit.
bool is_same_position(const Vec3d& a, const Vec3d& b) {
  const auto bits = [](double number) { return std::bit_cast<std::uint64_t>(number); };
  return bits(a[0]) == bits(b[0]) && bits(a[1]) == bits(b[1]) && bits(a[2]) == bits(b[2]);
}

/// Whether each of `count` faces has pieces, in their order.
bool are_parents(std::span<const std::uint32_t> parent, std::size_t count) {
  std::uint32_t next = 0;
  for (const std::uint32_t face : parent) {
    if (face != next && face + 1 != next) return false;
    next = face + 1;
  }
  return next == count;
}

bool is_origin(const VertexOrigin& origin, PolygonView mesh) {
  if (origin.face >= mesh.face_count()) return false;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (origin.vertex[k] >= mesh.positions.size() || !(origin.share[k] >= 0)) return false;
    sum += origin.share[k];
  }
  return std::abs(sum - 1) <= 0x1p-40;  // far more than what rounding leaves, and far less than a wrong share
}

void require_fit(const Polygons& source, const Refinement& refinement) {
  const Polygons& refined = refinement.polygons;
  const std::size_t vertices = source.positions.size(), faces = source.face_count();
  if (refined.positions.size() != vertices + refinement.added.size() ||
      !std::equal(source.positions.begin(), source.positions.end(), refined.positions.begin(), is_same_position))
    misfit(fmt::format("a refinement of {} vertices", vertices),
           fmt::format("one of {} vertices, or of others", refinement.source_vertices()));
  if (refinement.parent.size() != refined.face_count() || refinement.over_ridges > refinement.parent.size() ||
      refinement.over_corners > refinement.over_ridges ||
      !are_parents(std::span(refinement.parent).first(refinement.faces_in_place()), faces))
    misfit(fmt::format("pieces of {} faces in their order", faces), "others");
  for (const std::uint32_t parent : std::span(refinement.parent).last(refinement.over_ridges))
    if (parent >= faces) misfit(fmt::format("parents below {}", faces), "others");
  if (refined.face_begin.back() != refined.corners.size()) misfit("faces of all corners", "others");
  for (std::size_t f = 0; f < refined.face_count(); ++f)
    if (refined.face_begin[f + 1] < refined.face_begin[f] + 3) misfit("faces of at least 3 corners", "fewer");
  if (std::any_of(refined.corners.begin(), refined.corners.end(),
                  [&](auto v) { return v >= refined.positions.size(); }))
    misfit(fmt::format("vertices below {}", refined.positions.size()), "others");
  for (const VertexOrigin& origin : refinement.added)
    if (!is_origin(origin, source.view())) misfit("shares of the source's vertices that add up to 1", "others");
}

bool splits_nothing(const Polygons& source, const Refinement& refinement) {
  return refinement.added.empty() && refinement.polygons.face_begin == source.face_begin &&
         refinement.polygons.corners == source.corners;
}

MeshFile parse_refined(const MeshFile& source, const Refinement& refinement, std::vector<std::string>& lost) {
  // A face takes about as many bytes as before, and a text grows by doubling.
  const std::size_t of_face = source.text().size() / source.polygons.face_count() + 1;
  require_memory(2 * of_face * refinement.polygons.face_count(), source.path);
  WrittenDocument made = derive(std::make_shared<const DerivedMesh>(source, refinement), source.path);
  std::string bytes = join(made.file);
  lost.insert(lost.end(), made.lost.begin(), made.lost.end());
  source.bytes.require_unchanged(source.path);
  return parse_mesh(source.path, source.format, std::move(bytes));
}

/// Checks that the file holds the refinement, to the bit.
void require_same(const RefinedFile& refined, const Refinement& refinement) {
  const Polygons &found = refined.file.polygons, &wanted = refinement.polygons;
  const std::size_t count = refined.vertex.empty() ? wanted.positions.size() : refined.vertex.size();
  if (found.positions.size() != count || found.face_begin != wanted.face_begin ||
      (refined.vertex.empty() && found.corners != wanted.corners))
    misfit("to read the faces that were written", "others");
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3d& position = wanted.positions[refined.vertex.empty() ? v : refined.vertex[v]];
    if (!is_same_position(found.positions[v], position))
      misfit(fmt::format("a position of vertex {} that the file can hold", v),
             fmt::format("{}, {}, {}", position[0], position[1], position[2]));
  }
}

}  // namespace

RefinedFile refine_file(const MeshFile& source, const Refinement& refinement) {
  require_fit(source.polygons, refinement);
  RefinedFile refined;
  if (has_rows(source) && !rows_of(source).shares_vertices()) refined.vertex = refinement.polygons.corners;
  if (splits_nothing(source.polygons, refinement)) {
    refined.file = source;
    return refined;
  }
  if (!has_rows(source)) {
    // Such a file cannot be given more vertices as it is: what OBJ has a place for comes along.
    WriteResult as_obj;
    std::string bytes = join(convert(source, Format::Obj, source.polygons.positions, {}, Normals::Keep, as_obj));
    if (!as_obj.lost.empty()) refined.lost.push_back(as_obj.lost);
    refined.file = parse_refined(parse_mesh(source.path, Format::Obj, std::move(bytes)), refinement, refined.lost);
    refined.file.unit_micrometres = source.unit_micrometres;
    source.bytes.require_unchanged(source.path);
  } else if (!rows_of(source).takes_faces()) {
    std::string bytes = rows_of(source).with_face_rows(source, refined.lost);
    refined.file = parse_refined(parse_mesh(source.path, source.format, std::move(bytes)), refinement, refined.lost);
    source.bytes.require_unchanged(source.path);
  } else {
    refined.file = parse_refined(source, refinement, refined.lost);
  }
  require_same(refined, refinement);
  return refined;
}

}  // namespace vdb_offset::io
