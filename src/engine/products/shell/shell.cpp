// SPDX-License-Identifier: Apache-2.0
// Joins a mesh and its offset, or two offsets, into one solid. The outer skin has the mesh's faces, the inner skin the
// faces turned round, and each border edge gets a quad that runs against its face; the quad becomes a triangle where
// the skins touch at one end, and nothing where they touch at both. Each moved vertex goes to the skin that the sign of
// its distance stands for, and stays in the mesh on the other one. Where sheets meet or faces were turned,
// junction_shell.cpp gives wedges corners of their own; if that is not closed and oriented, both skins run on through
// the junctions instead. Vertices keep their numbers, and faces their order. Skins are taken as they come and not made
// valid; what touches or crosses is counted (shell_facts.cpp).
#include "vdb_offset/shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "ground/mesh/count_states.h"
#include "ground/mesh/edge_sides.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "ground/system/stage_timer.h"
#include "ground/system/thread_count.h"
#include "products/shell/junction_shell.h"
#include "products/shell/shell_facts.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The corners at which the mesh's border edges start, in ascending order.
std::vector<std::uint32_t> find_border(PolygonView mesh, std::span<const std::uint32_t> welded_to) {
  std::vector<std::uint32_t> corners;
  visit_edges(mesh, welded_to, [&](auto, std::span<const EdgeSide> sides) {
    if (sides.size() == 1) corners.push_back(sides[0].corner);
  });
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// The faces of a mesh that a shell is made from.
class Part {
 public:
  Part(PolygonView mesh, std::span<const std::uint8_t> only) : mesh_(mesh), all_(only.empty()) {
    if (all_) return;
    if (only.size() != mesh.face_count())
      throw InvalidInput("shell: expected a mark for each of " + std::to_string(mesh.face_count()) + " faces, got " +
                         std::to_string(only.size()));
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      if (!only[f]) continue;
      const auto face = mesh.face(f);
      corners_.insert(corners_.end(), face.begin(), face.end());
      face_begin_.push_back(static_cast<std::uint32_t>(corners_.size()));
      faces_.push_back(f);
      if (!mesh.triangles.empty()) append_triangles(mesh, f, triangles_);
    }
  }

  PolygonView view() const { return all_ ? mesh_ : PolygonView{mesh_.positions, corners_, face_begin_, triangles_}; }
  const std::vector<std::uint32_t>& faces() const { return faces_; }
  /// An edge of the part as one of the mesh.
  Shell::RimOrigin in_mesh(Shell::RimOrigin edge) const {
    if (all_) return edge;
    edge.corner += mesh_.face_begin[faces_[edge.face]] - face_begin_[edge.face];
    edge.face = faces_[edge.face];
    return edge;
  }

 private:
  PolygonView mesh_;
  bool all_;
  std::vector<std::uint32_t> corners_, face_begin_{0}, faces_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// Both skins, without a rim.
Shell both_skins(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner) {
  const auto vertices = static_cast<std::uint32_t>(outer.size()), corners = mesh.face_begin.back();
  Shell shell;
  std::vector<Vec3d>& positions = shell.polygons.positions;
  std::vector<std::uint32_t>&all_corners = shell.polygons.corners, &face_begin = shell.polygons.face_begin;
  positions.reserve(2 * outer.size());
  positions.assign(outer.begin(), outer.end());
  positions.insert(positions.end(), inner.begin(), inner.end());
  all_corners.assign(mesh.corners.begin(), mesh.corners.end());
  all_corners.resize(2 * mesh.corners.size());
  face_begin.assign(mesh.face_begin.begin(), mesh.face_begin.end());
  face_begin.resize(2 * mesh.face_count() + 1);
  for_each_index(mesh.face_count(), [&](std::size_t f) {
    const auto face = mesh.face(f);
    face_begin[mesh.face_count() + f + 1] = corners + mesh.face_begin[f + 1];
    for (std::size_t k = 0; k < face.size(); ++k)
      all_corners[corners + mesh.face_begin[f] + k] = vertices + face[(face.size() - k) % face.size()];
  });
  return shell;
}

/// The positions of the shell's vertices if vertices that are welded in the mesh have one position in each skin. In the
/// shell they may have several: where vertices are welded with a tolerance, or at a seam, those that do not move stay.
std::vector<Vec3d> welded_positions(const Shell& shell, std::span<const std::uint32_t> welded_in_mesh) {
  const std::size_t count = shell.source_vertices();
  std::vector<Vec3d> positions = shell.polygons.positions;
  for_each_index(2 * count, [&](std::size_t v) {
    const std::uint32_t first = welded_in_mesh[v % count];
    if (first != kNone) positions[v] = shell.polygons.positions[v < count ? first : count + first];
  });
  return positions;
}

/// For each vertex of the shell the first vertex that counts as one with it; kNone for a vertex in no face. Vertices
/// that are welded in the mesh are one in each skin; others are by their positions, if vertices are welded at all.
std::vector<std::uint32_t> welded_in_shell(const Shell& shell, std::span<const std::uint32_t> welded_in_mesh,
                                           bool by_position) {
  const std::size_t count = shell.source_vertices();
  const std::vector<Vec3d> positions = welded_positions(shell, welded_in_mesh);
  if (by_position) return weld_by_position({positions, shell.polygons.corners, shell.polygons.face_begin}, {});
  std::vector<std::uint32_t> welded_to(2 * count);
  for_each_index(2 * count, [&](std::size_t v) {
    welded_to[v] = static_cast<std::uint32_t>(v >= count && positions[v] == positions[v - count] ? v - count : v);
  });
  return welded_to;
}

/// Adds a rim face at each border edge. It runs against the edge's face on the outer skin, and so along that face's own
/// direction on the inner skin, where faces are reversed.
void add_rim(PolygonView mesh, std::span<const std::uint32_t> border, std::span<const std::uint32_t> welded_to,
             Shell& shell) {
  const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
  for (const std::uint32_t corner : border) {
    const auto face = std::upper_bound(mesh.face_begin.begin(), mesh.face_begin.end(), corner) - 1;
    const Shell::RimOrigin edge{static_cast<std::uint32_t>(face - mesh.face_begin.begin()), corner};
    const std::uint32_t from = mesh.corners[corner], to = mesh.corners[next_corner(mesh, edge)];
    const std::uint32_t quad[4] = {to, from, from + inner, to + inner};
    auto& corners = shell.polygons.corners;
    const std::size_t first = corners.size();
    for (const std::uint32_t v : quad)
      if (corners.size() == first || welded_to[v] != welded_to[corners.back()]) corners.push_back(v);
    while (corners.size() > first && welded_to[corners.back()] == welded_to[corners[first]]) corners.pop_back();
    const std::size_t size = corners.size() - first;
    if (size < 3) {
      corners.resize(first);
      continue;
    }
    shell.polygons.close_face();
    shell.rim.push_back(edge);
    ++(size == 4 ? shell.facts.rim_quads : shell.facts.rim_triangles);
  }
}

}  // namespace

Shell make_shell(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner, const WeldOptions& weld,
                 const Precision& precision, std::span<const std::uint8_t> only) {
  if (outer.size() != mesh.positions.size() || inner.size() != mesh.positions.size())
    throw InvalidInput("shell: expected two skins of " + std::to_string(mesh.positions.size()) + " vertices, got " +
                       std::to_string(outer.size()) + " and " + std::to_string(inner.size()));
  const Part part(mesh, only);
  const PolygonView faces = part.view();
  const std::vector<std::uint32_t> welded_in_mesh = weld_by_position(faces, weld);
  if (2 * mesh.positions.size() >= kNone)
    throw InvalidInput("shell: expected fewer than 2^31 vertices, got " + std::to_string(mesh.positions.size()));
  Shell shell = both_skins(faces, outer, inner);
  const std::vector<std::uint32_t> welded_to = welded_in_shell(shell, welded_in_mesh, weld.enabled);
  add_rim(faces, find_border(faces, welded_in_mesh), welded_to, shell);
  split_shell(faces, shell);
  count_facts(faces, weld, precision, welded_to, shell);
  shell.faces = part.faces();
  for (Shell::RimOrigin& edge : shell.rim) edge = part.in_mesh(edge);
  return shell;
}

namespace {

/// How building the surface has taken the faces of a part: turned round, or left out as repeating others; and which of
/// its vertices are at junctions.
struct TakenFaces {
  std::vector<std::uint8_t> turned, repeats, junctions;

  TakenFaces(PolygonView part, const OffsetOptions& options)
      : turned(part.face_count(), 0), repeats(part.face_count(), 1), junctions(part.positions.size(), 0) {
    const Surface surface = build_surface(part, options.weld, options.orient);
    const std::vector<std::uint8_t> found =
        options.off_source ? find_junctions(surface, part) : std::vector<std::uint8_t>();
    for (std::size_t v = 0; v < junctions.size() && !found.empty(); ++v)
      junctions[v] = surface.welded[v] != kNone && found[surface.welded[v]];
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      repeats[surface.face[t]] = 0;
      turned[surface.face[t]] |= static_cast<std::uint8_t>(surface.is_turned(t));
    }
  }
};

/// Whether two skins of one vertex each are not enough: sheets meet, or faces were turned round.
bool needs_sides(const OffsetResult& result, const TakenFaces& taken) {
  const auto any = [](const std::vector<std::uint8_t>& marks) {
    return std::find(marks.begin(), marks.end(), 1) != marks.end();
  };
  return any(taken.junctions) || (result.has_turned_faces && any(taken.turned));
}
/// Whether needs_sides() may hold, judged without building the surface.
bool may_need_sides(PolygonView mesh, const OffsetResult& result, const OffsetOptions& options) {
  if (result.has_turned_faces) return true;
  for (std::size_t v = 0; options.off_source && v < result.states.size(); ++v)
    if (result.states[v] == VertexState::Limited && result.positions[v] == mesh.positions[v]) return true;
  return false;
}

Shell junction_shell_of(const Part& part, const TakenFaces& taken, std::span<const Vec3d> outer,
                        std::span<const Vec3d> inner_skin, const OffsetResult& result, const OffsetOptions& options,
                        const OffsetResult* inner) {
  const PolygonView faces = part.view();
  const std::vector<std::uint32_t> welded_to = weld_by_position(faces, options.weld);
  const auto thickness = [&](std::uint32_t v) -> std::array<double, 2> {
    const double d = result.distances[v];
    if (inner) return {d, -inner->distances[v]};
    return {std::max(d, 0.0), std::max(-d, 0.0)};
  };
  Shell shell = make_junction_shell({.sheets = {faces, welded_to, taken.turned, taken.repeats, thickness},
                                     .outer = outer,
                                     .inner = inner_skin,
                                     .junctions = taken.junctions,
                                     .weld = options.weld,
                                     .precision = options.precision,
                                     .to_be_valid = options.collision == Collision::Limit});
  count_facts(faces, options.weld, options.precision, weld_by_position(shell.polygons.view(), {}), shell);
  shell.faces = part.faces();
  for (Shell::RimOrigin& edge : shell.rim) edge = part.in_mesh(edge);
  return shell;
}

}  // namespace

Shell shell_of(PolygonView given, const OffsetResult& result, const OffsetOptions& options, const OffsetResult* inner) {
  VDB_OFFSET_ASSERT(result.positions.size() == given.positions.size());
  VDB_OFFSET_ASSERT(!inner || inner->positions.size() == given.positions.size());
  // What has moved is at one position already, where it is one vertex; so is what stays.
  const std::vector<Vec3d> welded = positions_as_welded(given, options.weld);
  const PolygonView mesh{welded, given.corners, given.face_begin};
  std::vector<Vec3d> out = welded, in = out;
  const auto move = [&](std::vector<Vec3d>& skin, std::size_t v, const Vec3d& to) {
    if (to != given.positions[v]) skin[v] = to;
  };
  for (std::size_t v = 0; v < out.size(); ++v) {
    move(result.distances[v] < 0 ? in : out, v, result.positions[v]);
    if (inner) move(in, v, inner->positions[v]);
  }
  const auto plain = [&] { return make_shell(mesh, out, in, options.weld, options.precision, options.only); };
  if (!may_need_sides(given, result, options)) return plain();
  const Part part(mesh, options.only);
  const TakenFaces taken(part.view(), options);
  if (!needs_sides(result, taken)) return plain();
  Shell shell = junction_shell_of(part, taken, out, in, result, options, inner);
  if (shell.facts.closed && shell.facts.oriented) return shell;
  // If the sheets are too tangled for that, both skins go on through the junctions, which stay where they are.
  Shell simple = plain();
  simple.facts.junction_vertices = simple.facts.short_junctions = shell.facts.junction_vertices;
  return simple;
}

void report_states(const Shell& shell, OffsetResult& result) {
  if (shell.kept.empty()) return;
  VDB_OFFSET_ASSERT(shell.kept.size() == result.states.size() && shell.is_junction.size() == shell.kept.size());
  for (std::size_t v = 0; v < shell.kept.size(); ++v) {
    const double kept = shell.kept[v], asked = std::abs(result.distances[v]);
    if (kept < 0 || asked == 0) continue;
    if (kept < 1 && !shell.is_junction[v] && result.states[v] != VertexState::Reached) continue;
    result.states[v] = kept < 1 ? VertexState::Limited : VertexState::Reached;
    result.achieved[v] = kept * asked;
  }
  result.statistics.vertices_by_state = {};
  count_states(result.states, result.statistics);
}

}  // namespace vdb_offset
