#include "vdb_offset/shell.h"

#include <algorithm>
#include <string>

#include "vdb_offset/crossings.h"
#include "vdb_offset/edge_sides.h"
#include "vdb_offset/error.h"
#include "vdb_offset/near_crossings.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/triangulate.h"

namespace vdb_offset {
namespace {

/// The corners at which the mesh's border edges start, in ascending order.
std::vector<std::uint32_t> find_border(PolygonView mesh, std::span<const std::uint32_t> place) {
  std::vector<std::uint32_t> corners;
  visit_edges(mesh, place, [&](auto, std::span<const EdgeSide> sides) {
    if (sides.size() == 1) corners.push_back(sides[0].corner);
  });
  std::sort(corners.begin(), corners.end());
  return corners;
}

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

/// For each vertex of the shell one that stands for its place; kNone for one in no face. Vertices that are one in the
/// mesh are one in each skin; whether others are, both skins' positions decide, so far as vertices are welded at all.
std::vector<std::uint32_t> places_of(const Shell& shell, std::span<const std::uint32_t> place_in_mesh,
                                     bool by_position) {
  const std::size_t count = shell.source_vertices();
  std::vector<Vec3d> positions = shell.polygons.positions;
  for_each_index(2 * count, [&](std::size_t v) {
    const std::uint32_t first = place_in_mesh[v % count];
    if (first != kNone) positions[v] = shell.polygons.positions[v < count ? first : count + first];
  });
  if (by_position) return weld_by_position({positions, shell.polygons.corners, shell.polygons.face_begin}, {});
  std::vector<std::uint32_t> place(2 * count);
  for_each_index(2 * count, [&](std::size_t v) {
    place[v] = static_cast<std::uint32_t>(v >= count && positions[v] == positions[v - count] ? v - count : v);
  });
  return place;
}

/// Runs through each border edge against its face on the outer skin, and so with the face's own direction on the inner
/// one, where faces are reversed.
void add_rim(PolygonView mesh, std::span<const std::uint32_t> border, std::span<const std::uint32_t> place,
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
      if (corners.size() == first || place[v] != place[corners.back()]) corners.push_back(v);
    while (corners.size() > first && place[corners.back()] == place[corners[first]]) corners.pop_back();
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

void count_edges(std::span<const std::uint32_t> place, Shell& shell) {
  ShellFacts& facts = shell.facts;
  facts.closed = facts.oriented = true;
  visit_edges(shell.polygons.view(), place, [&](std::uint32_t smaller, std::span<const EdgeSide> sides) {
    const auto forwards = std::count_if(sides.begin(), sides.end(), [&](const EdgeSide& side) {
      return place[shell.polygons.corners[side.corner]] == smaller;
    });
    facts.border_edges_left += sides.size() == 1;
    facts.non_manifold_edges += sides.size() > 2;
    facts.closed = facts.closed && sides.size() % 2 == 0;
    facts.oriented = facts.oriented && 2 * static_cast<std::size_t>(forwards) == sides.size();
  });
}

/// By the divergence theorem, from a corner of the shell so that far-away solids keep their digits.
double enclosed_volume(PolygonView mesh) {
  const Vec3d origin = mesh.positions[mesh.corners[0]];
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double six_times = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    triangles.clear();
    triangulate(mesh.positions, mesh.face(f), triangles);
    for (const auto& [i, j, k] : triangles)
      six_times += (mesh.positions[i] - origin).dot((mesh.positions[j] - origin).cross(mesh.positions[k] - origin));
  }
  return six_times / 6;
}

/// Vertices of faces at which the skins touch.
std::size_t count_pinched(PolygonView mesh, const Shell& shell) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const auto v : mesh.corners) used[v] = 1;
  std::size_t pinched = 0;
  for (std::size_t v = 0; v < used.size(); ++v) pinched += used[v] && shell.outer()[v] == shell.inner()[v];
  return pinched;
}

/// For each vertex of the mesh: 1 within two rings of where it crosses itself.
std::vector<std::uint8_t> find_near_crossings(PolygonView mesh, const WeldOptions& weld) {
  const Surface surface = build_surface(mesh, weld);
  const NearCrossings crossings(surface, CrossingFinder(surface, surface.vertices).all());
  std::vector<std::uint8_t> near(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < near.size(); ++v)
    near[v] = surface.welded[v] != kNone && crossings.is_vertex_near(surface.welded[v]);
  return near;
}

void count_crossings(PolygonView mesh, const WeldOptions& weld, const Precision& precision, Shell& shell) {
  const std::size_t count = mesh.positions.size();
  std::vector<Vec3d> rounded = shell.polygons.positions;
  for (std::size_t v = 0; v < rounded.size(); ++v)
    if (rounded[v] != mesh.positions[v % count]) rounded[v] = precision(rounded[v]);  // the others keep their bytes
  const Surface surface = build_surface({rounded, shell.polygons.corners, shell.polygons.face_begin}, {});
  const std::vector<TrianglePair> pairs = CrossingFinder(surface, surface.vertices).all();
  if (pairs.empty()) return;
  const std::vector<std::uint8_t> near = find_near_crossings(mesh, weld);
  const auto has_moved = [&](std::uint32_t v) { return rounded[v] != mesh.positions[v % count]; };
  const auto is_near = [&](std::uint32_t v) { return near[v % count] != 0; };
  const auto any_corner = [&](const TrianglePair& pair, const auto& holds) {
    for (const auto t : {pair.first, pair.second})
      for (const auto v : surface.triangles[t])
        if (holds(surface.representative[v])) return true;
    return false;
  };
  for (const TrianglePair& pair : pairs)
    ++(!any_corner(pair, has_moved) ? shell.facts.source_crossings
       : any_corner(pair, is_near)  ? shell.facts.crossings_near_source
                                    : shell.facts.crossings);
}

}  // namespace

Shell make_shell(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner, const WeldOptions& weld,
                 const Precision& precision) {
  if (outer.size() != mesh.positions.size() || inner.size() != mesh.positions.size())
    throw InvalidInput("shell: expected two skins of " + std::to_string(mesh.positions.size()) + " vertices, got " +
                       std::to_string(outer.size()) + " and " + std::to_string(inner.size()));
  const std::vector<std::uint32_t> place_in_mesh = weld_by_position(mesh, weld);
  if (2 * mesh.positions.size() >= kNone)
    throw InvalidInput("shell: expected fewer than 2^31 vertices, got " + std::to_string(mesh.positions.size()));
  Shell shell = both_skins(mesh, outer, inner);
  const std::vector<std::uint32_t> place = places_of(shell, place_in_mesh, weld.enabled);
  add_rim(mesh, find_border(mesh, place_in_mesh), place, shell);
  count_edges(place, shell);
  shell.facts.pinched_vertices = count_pinched(mesh, shell);
  count_crossings(mesh, weld, precision, shell);
  shell.facts.volume = enclosed_volume(shell.polygons.view());
  return shell;
}

Shell shell_of(PolygonView mesh, const OffsetResult& result, const OffsetOptions& options, const OffsetResult* inner) {
  std::vector<Vec3d> out(mesh.positions.begin(), mesh.positions.end()), in = out;
  for (std::size_t v = 0; v < out.size(); ++v) (result.distances[v] < 0 ? in : out)[v] = result.positions[v];
  return make_shell(mesh, out, inner ? inner->positions : in, options.weld, options.precision);
}

}  // namespace vdb_offset
