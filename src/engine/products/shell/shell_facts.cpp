// SPDX-License-Identifier: Apache-2.0
// Measures a shell on the coordinates that will be written. It is closed if each edge, by position, has an even number
// of faces, and oriented if as many of these run one way as the other. The volume is summed up over its triangles by
// the divergence theorem, from a corner of the shell. A vertex is pinched where the corners of an outer and an inner
// face are at one position. Triangles that meet are the source's own if no corner has moved, are counted apart within
// two rings of where the source crosses itself, and are crossings of the shell elsewhere. Triangles of both skins are
// those of the mesh's faces, so that both are split alike. Nothing is moved or mended here; the rim's faces are counted
// in shell.cpp and junction_shell.cpp.
#include "products/shell/shell_facts.h"

#include <algorithm>

#include "ground/mesh/edge_sides.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "valid/faults/source_crossings.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

void count_edges(std::span<const std::uint32_t> welded_to, Shell& shell) {
  ShellFacts& facts = shell.facts;
  facts.closed = facts.oriented = true;
  visit_edges(shell.polygons.view(), welded_to, [&](std::uint32_t smaller, std::span<const EdgeSide> sides) {
    const auto forwards = std::count_if(sides.begin(), sides.end(), [&](const EdgeSide& side) {
      return welded_to[shell.polygons.corners[side.corner]] == smaller;
    });
    facts.border_edges_left += sides.size() == 1;
    facts.non_manifold_edges += sides.size() > 2;
    facts.closed = facts.closed && sides.size() % 2 == 0;
    facts.oriented = facts.oriented && 2 * static_cast<std::size_t>(forwards) == sides.size();
  });
}

/// The volume by the divergence theorem, relative to a corner of the shell, so that solids far from the origin lose no
/// digits.
double enclosed_volume(PolygonView mesh) {
  const Vec3d origin = mesh.positions[mesh.corners[0]];
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double six_times = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    triangles.clear();
    append_triangles(mesh, f, triangles);
    for (const auto& [i, j, k] : triangles)
      six_times += (mesh.positions[i] - origin).dot((mesh.positions[j] - origin).cross(mesh.positions[k] - origin));
  }
  return six_times / 6;
}

/// Counts the vertices of the mesh at which the skins touch on some face, and notes whether there are others.
void count_pinched(PolygonView mesh, std::span<const Vec3d> written, Shell& shell) {
  std::vector<std::uint8_t> pinched(mesh.positions.size(), 0);
  const std::size_t faces = shell.skin_faces();
  for (std::size_t f = 0; f < faces; ++f) {
    const auto outer = shell.polygons.view().face(f), inner = shell.polygons.view().face(faces + f);
    for (std::size_t k = 0; k < outer.size(); ++k)
      if (written[outer[k]] == written[inner[(outer.size() - k) % outer.size()]]) pinched[mesh.face(f)[k]] = 1;
      else shell.facts.has_thickness = true;
  }
  shell.facts.pinched_vertices = static_cast<std::size_t>(std::count(pinched.begin(), pinched.end(), 1));
}

/// Counts the crossings. Vertices that count as one are judged at one position, although those that have not moved keep
/// their own coordinates.
void count_crossings(PolygonView mesh, const WeldOptions& weld, std::span<const Vec3d> written,
                     std::span<const std::uint32_t> welded_to, const Rounding& precision, Shell& shell) {
  std::vector<Vec3d> joined(written.begin(), written.end());
  for (std::size_t v = 0; v < joined.size(); ++v)
    if (welded_to[v] != kNone) joined[v] = written[welded_to[v]];
  const Surface surface =
      build_surface({joined, shell.polygons.corners, shell.polygons.face_begin, shell.triangles}, {});
  const std::vector<TrianglePair> pairs = CrossingFinder(surface, surface.vertices).all();
  if (pairs.empty()) return;
  const std::vector<std::uint8_t> near = find_near_crossings(mesh, weld);
  const auto has_moved = [&](std::uint32_t v) {
    return !precision.stays(mesh.positions[shell.source_vertex(v)], written[v]);
  };
  const auto is_near = [&](std::uint32_t v) { return near[shell.source_vertex(v)] != 0; };
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

std::vector<Vec3d> positions_as_welded(PolygonView mesh, const WeldOptions& weld) {
  const std::vector<std::uint32_t> first = weld_by_position(mesh, weld);
  std::vector<Vec3d> positions(mesh.positions.begin(), mesh.positions.end());
  for_each_index(positions.size(), [&](std::size_t v) {
    if (first[v] != kNone) positions[v] = mesh.positions[first[v]];
  });
  return positions;
}

std::vector<Vec3d> written_positions(PolygonView mesh, const Shell& shell, const Rounding& precision) {
  std::vector<Vec3d> written = shell.polygons.positions;
  for (std::uint32_t v = 0; v < written.size(); ++v)
    written[v] = precision(mesh.positions[shell.source_vertex(v)], written[v]);
  return written;
}

void split_shell(PolygonView mesh, Shell& shell) {
  const PolygonView faces = shell.polygons.view();
  shell.triangles.clear();
  shell.triangles.reserve(faces.corners.size() - 2 * faces.face_count());
  const std::size_t count = shell.skin_faces();
  std::vector<std::array<std::uint32_t, 3>> of_mesh;
  for (const bool inner : {false, true})
    for (std::size_t f = 0; f < count; ++f) {
      const auto source = mesh.face(f), face = faces.face(inner ? count + f : f);
      of_mesh.clear();
      append_triangles(mesh, f, of_mesh);
      if (inner) std::reverse(of_mesh.begin(), of_mesh.end());
      for (auto triangle : of_mesh) {
        if (inner) std::swap(triangle[1], triangle[2]);
        for (auto& v : triangle) {
          const auto k = static_cast<std::size_t>(std::find(source.begin(), source.end(), v) - source.begin());
          v = face[inner && k > 0 ? face.size() - k : k];
        }
        shell.triangles.push_back(triangle);
      }
    }
  for (std::size_t f = 2 * count; f < faces.face_count(); ++f) append_triangles(faces, f, shell.triangles);
}

std::vector<std::uint8_t> find_near_crossings(PolygonView mesh, const WeldOptions& weld) {
  const Surface surface = build_surface(mesh, weld);
  const SourceCrossings crossings(surface, CrossingFinder(surface, surface.vertices).listed());
  std::vector<std::uint8_t> near(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < near.size(); ++v)
    near[v] = surface.welded[v] != kNone && crossings.is_vertex_near(surface.welded[v]);
  return near;
}

void count_facts(PolygonView mesh, const WeldOptions& weld, const Rounding& precision,
                 std::span<const std::uint32_t> welded_to, Shell& shell) {
  VDB_OFFSET_ASSERT(welded_to.size() == shell.polygons.positions.size());
  const std::vector<Vec3d> written = written_positions(mesh, shell, precision);
  count_edges(welded_to, shell);
  count_pinched(mesh, written, shell);
  count_crossings(mesh, weld, written, welded_to, precision, shell);
  shell.facts.volume = enclosed_volume({written, shell.polygons.corners, shell.polygons.face_begin, shell.triangles});
}

}  // namespace vdb_offset
