// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/limit_state.h"

#include <algorithm>
#include <cmath>

#include "ground/system/assert.h"
#include "space/surface/creases.h"
#include "valid/untangle/schedule.h"

namespace vdb_offset {
namespace {

// Share of the whole displacement below which a vertex leaves the straight line: the last tenth of the way back is
// bent. Reasoned: the line may dip through the faces around the vertex only near them.
constexpr double kBent = 0.1;

std::array<float, 3> as_floats(const Vec3d& x) {
  return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
}

}  // namespace

LimitState::LimitState(FaultFinder& fault_finder, const SurfaceOffset& offset, const WarmStart* warm)
    : constrained(offset.constrained),
      surface(offset.constrained.surface),
      source(offset.source),
      distances(offset.distances),
      paths(offset.paths),
      mitered(offset.mitered),
      keeps_faces(offset.keeps_faces),
      first_over_ridges(offset.first_over_ridges),
      faults(fault_finder),
      started_from(warm),
      whole(offset.paths.displacement),
      share(offset.source.size(), 1.0),
      live_area(offset.constrained, offset.distances),
      gathered(offset.source.size()) {
  VDB_OFFSET_ASSERT(source.size() == surface.vertices.size());
  VDB_OFFSET_ASSERT(paths.displacement.size() == source.size() && paths.state.size() == source.size());
  VDB_OFFSET_ASSERT(!warm || warm->displacement.size() == source.size());
  statistics.source_crossings = faults.source_crossings().count();
  statistics.more_source_crossings = faults.source_crossings().has_more();
  statistics.before = faults.count();
  many_at_first = fault_count() > kManyFaults || (started_from && started_from->many_faults);
}

void LimitState::find_creases() {
  if (!on_crease.empty()) return;
  on_crease = vertices_on_creases(surface);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.face[t] >= first_over_ridges && constrained.triangle_on_part(t))
      for (const std::uint32_t v : surface.triangles[t]) on_crease[v] = 1;
}

bool LimitState::has_many_faults() const {
  return fault_count() > kManyFaults || (started_from && started_from->many_faults);
}

Vec3d LimitState::displacement_of(std::uint32_t v) const {
  const double part = share[v];
  const Vec3d& all = whole[v];
  if (part == 1) return all;
  if (part >= kBent || part == 0 || constrained.is_bound(v)) return all * part;
  const Vec3d start = start_direction(constrained.moving_part.surface(), constrained.part_vertex_of(v)) *
                      (distances[v] < 0 ? -1.0 : 1.0);
  if (!(start.lengthSqr() > 0)) return all * part;
  const double u = part / kBent;
  return (all * (u * u) + start * (all.length() * u * (1 - u))) * kBent;
}

double LimitState::off_planes(std::uint32_t v, const Vec3d& displacement) const {
  const auto& x = surface.vertices;
  double off = 0, area = 0;
  for (const auto t : surface.triangles_around(v)) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3d normal = (x[b] - x[a]).cross(x[c] - x[a]);
    const double length = normal.length();
    off += std::abs(normal.dot(displacement) - length * distances[v]);
    area += length;
  }
  return area > 0 ? off / (area * std::abs(distances[v])) : 0;
}

Indices LimitState::take_miters_back(const Indices& vertices) {
  if (!mitered) return {};
  Indices unmitered = mitered->take_back(vertices, paths);
  for (const auto v : unmitered) whole[v] = paths.displacement[v];
  return unmitered;
}

Displacements LimitState::displacements() const {
  Displacements all(share.size());
  for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = as_floats(displacement_of(v));
  return all;
}

Indices LimitState::moved_since(const Displacements& before, int rings) {
  VDB_OFFSET_ASSERT(before.empty() || before.size() == share.size());
  Indices moved;
  for (std::uint32_t v = 0; v < share.size(); ++v)
    if (before.empty() || as_floats(displacement_of(v)) != before[v]) moved.push_back(v);
  return with_rings(moved, rings);
}

Indices LimitState::with_rings(const Indices& vertices, int rings) {
  for (const auto v : vertices) gathered.add(v);
  for (std::size_t i = 0; rings > 0; --rings)
    for (const std::size_t inner = gathered.so_far().size(); i < inner; ++i)
      for (const auto t : surface.triangles_around(gathered.so_far()[i]))
        for (const auto v : surface.triangles[t]) gathered.add(v);
  return gathered.take();
}

bool LimitState::may_slide(std::uint32_t v) const {
  if (keeps_faces && mitered && mitered->is_mitered(v)) return false;
  const VertexState state = paths.state[v];
  const bool at_end = !falls_short(state) || (state == VertexState::Collision && has_sides(v));
  return at_end && distances[v] != 0 && constrained.vertex_on_part(v) && !constrained.is_bound(v);
}

bool LimitState::may_leave_path(std::uint32_t v) const {
  if (constrained.obstacles && paths.state[v] == VertexState::Collision) return false;
  return distances[v] != 0 && constrained.vertex_on_part(v) && !constrained.is_bound(v);
}

/// Whether any face around a vertex has an area. Lines have none, nor do the vertices that only lines hold.
bool LimitState::has_sides(std::uint32_t v) const {
  const auto around = surface.triangles_around(v);
  return std::any_of(around.begin(), around.end(),
                     [&](std::uint32_t t) { return surface.triangle_normals[t].lengthSqr() > 0; });
}

}  // namespace vdb_offset
