// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/shell.h"

#include <fmt/format.h>

#include <algorithm>

#include "ground/mesh/edge_sides.h"
#include "products/shell/shell_facts.h"
#include "space/surface/surface.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The volume by the divergence theorem, relative to a vertex, so that solids far from the origin lose no digits.
double volume_of(PolygonView mesh) {
  const Vec3d origin = mesh.positions.front();
  double six_times = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const auto at = [&](std::size_t k) { return mesh.positions[face[k]] - origin; };
    for (std::size_t k = 1; k + 1 < face.size(); ++k) six_times += at(0).dot(at(k).cross(at(k + 1)));
  }
  return six_times / 6;
}

/// Both skins, the inner one turned round. That of a source which is inside out already bounds a solid from within.
Polygons put_together(PolygonView outer, PolygonView inner, bool is_inside_out) {
  const auto first = static_cast<std::uint32_t>(outer.positions.size());
  Polygons all;
  all.positions.assign(outer.positions.begin(), outer.positions.end());
  all.positions.insert(all.positions.end(), inner.positions.begin(), inner.positions.end());
  all.corners.assign(outer.corners.begin(), outer.corners.end());
  all.face_begin.assign(outer.face_begin.begin(), outer.face_begin.end());
  all.corners.reserve(outer.corners.size() + inner.corners.size());
  for (std::size_t f = 0; f < inner.face_count(); ++f) {
    const auto face = inner.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      all.corners.push_back(first + face[is_inside_out ? k : (face.size() - k) % face.size()]);
    all.close_face();
  }
  return all;
}

void count_edges(Hollow& hollow) {
  const PolygonView mesh = hollow.polygons.view();
  const std::vector<std::uint32_t> welded_to = weld_by_position(mesh, {});
  ShellFacts& facts = hollow.facts;
  facts.closed = facts.oriented = true;
  visit_edges(mesh, welded_to, [&](std::uint32_t smaller, std::span<const EdgeSide> sides) {
    const auto forwards = std::count_if(sides.begin(), sides.end(), [&](const EdgeSide& side) {
      return welded_to[mesh.corners[side.corner]] == smaller;
    });
    facts.border_edges_left += sides.size() == 1;
    facts.non_manifold_edges += sides.size() > 2;
    facts.closed = facts.closed && sides.size() % 2 == 0;
    facts.oriented = facts.oriented && 2 * static_cast<std::size_t>(forwards) == sides.size();
  });
}

void count_crossings(const Surface& surface, Hollow& hollow) {
  const auto is_source = [&](std::uint32_t triangle) {
    const bool is_outer = surface.face[triangle] < hollow.outer_faces;
    return hollow.source == (is_outer ? Hollow::Source::Outer : Hollow::Source::Inner);
  };
  for (const auto& [s, t] : CrossingFinder(surface, surface.vertices).all())
    ++(is_source(s) && is_source(t) ? hollow.facts.source_crossings : hollow.facts.crossings);
}

}  // namespace

Hollow make_hollow(PolygonView outer, PolygonView inner, Hollow::Source source, const WeldOptions& weld) {
  if (outer.positions.size() + inner.positions.size() >= kNone)
    throw InvalidInput(fmt::format("hollow: expected fewer than 2^32 vertices, got {}",
                                   outer.positions.size() + inner.positions.size()));
  Hollow hollow;
  const bool has_source = source != Hollow::Source::Neither;
  const PolygonView skin = source == Hollow::Source::Inner ? inner : outer;
  hollow.polygons = put_together(outer, inner, has_source && volume_of(skin) < 0);
  if (has_source) {
    const std::vector<Vec3d> welded = positions_as_welded(skin, weld);
    const std::size_t first = source == Hollow::Source::Outer ? 0 : outer.positions.size();
    std::copy(welded.begin(), welded.end(), hollow.polygons.positions.begin() + static_cast<std::ptrdiff_t>(first));
  }
  hollow.outer_vertices = outer.positions.size();
  hollow.outer_faces = outer.face_count();
  hollow.source = source;
  count_edges(hollow);
  count_crossings(build_surface(hollow.polygons.view(), {}), hollow);
  hollow.facts.volume = volume_of(hollow.polygons.view());
  return hollow;
}

}  // namespace vdb_offset
