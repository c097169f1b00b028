// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/rim_crossings.h"

#include <algorithm>

#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

/// Whether no other face of the moving part lies at a half-edge's edge.
bool ends_part(const ConstrainedSurface& constrained, std::uint32_t half_edge) {
  const auto& next = constrained.surface.next_around_edge;
  for (std::uint32_t h = next[half_edge]; h != half_edge; h = next[h])
    if (constrained.triangle_on_part(h / 3)) return false;
  return true;
}

/// Whether a triangle is one of the mesh that stays, which a shell of the moving part does not have.
bool is_left_out(const ConstrainedSurface& constrained, std::uint32_t triangle) {
  return !constrained.triangle_on_part(triangle) &&
         constrained.surface.representative[constrained.surface.triangles[triangle][0]] != kNone;
}

}  // namespace

RimCrossings::RimCrossings(const ConstrainedSurface& constrained, std::span<const Vec3d> other_skin,
                           std::span<const Vec3d> positions, const Distances& distances)
    : constrained_(constrained),
      surface_(constrained.surface),
      other_skin_(other_skin),
      positions_(positions),
      distances_(distances) {
  VDB_OFFSET_ASSERT(other_skin.size() == surface_.vertices.size() && positions.size() == other_skin.size());
  find_edges();
  if (edges_.empty()) return;
  list_vertices();
  finder_.emplace(rim_, skins_);
}

/// Finds the border's edges. Edges of faces that are not on the moving part have no rim.
void RimCrossings::find_edges() {
  const auto half_edges = static_cast<std::uint32_t>(surface_.next_around_edge.size());
  for (std::uint32_t h = 0; h < half_edges; ++h) {
    if (!constrained_.triangle_on_part(h / 3) || !ends_part(constrained_, h)) continue;
    Edge edge{surface_.from(h), surface_.to(h), h / 3};
    if (surface_.is_turned(edge.triangle)) std::swap(edge.from, edge.to);
    edges_.push_back(edge);
  }
}

void RimCrossings::list_vertices() {
  for (const Edge& edge : edges_) vertices_.insert(vertices_.end(), {edge.from, edge.to});
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  skins_.resize(2 * vertices_.size());
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) put(i);
  rim_.origin = surface_.origin;
  for (const Edge& edge : edges_) {
    const std::uint32_t from_outer = 2 * border_index(edge.from), to_outer = 2 * border_index(edge.to);
    rim_.triangles.push_back({to_outer, from_outer, from_outer + 1});
    rim_.triangles.push_back({to_outer, from_outer + 1, to_outer + 1});
  }
}

void RimCrossings::put(std::uint32_t border_vertex) {
  const std::uint32_t v = vertices_[border_vertex];
  const bool inward = distances_[v] < 0;
  skins_[2 * border_vertex] = inward ? other_skin_[v] : positions_[v];
  skins_[2 * border_vertex + 1] = inward ? positions_[v] : other_skin_[v];
}

std::uint32_t RimCrossings::border_index(std::uint32_t vertex) const {
  return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin());
}

std::vector<std::uint32_t> RimCrossings::triangles_at(std::span<const std::uint32_t> moved) const {
  const auto has_moved = [&](std::uint32_t v) { return std::binary_search(moved.begin(), moved.end(), v); };
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    if (has_moved(edges_[e].from) || has_moved(edges_[e].to)) triangles.insert(triangles.end(), {2 * e, 2 * e + 1});
  return triangles;
}

std::array<Vec3d, 3> RimCrossings::corners(std::uint32_t rim_triangle) const {
  const auto& [a, b, c] = rim_.triangles[rim_triangle];
  return {skins_[a], skins_[b], skins_[c]};
}

void RimCrossings::find(std::span<const std::uint32_t> moved, std::span<const std::uint32_t> touched,
                        const CrossingFinder& skin, const CrossingFinder& other_skin,
                        const SourceCrossings& source_crossings) {
  if (edges_.empty()) return;
  for (std::uint32_t i = 0; i < vertices_.size(); ++i)
    if (std::binary_search(moved.begin(), moved.end(), vertices_[i])) put(i);
  const std::vector<std::uint32_t> rim = triangles_at(moved);
  finder_->update(rim);
  const auto rim_has_moved = [&](std::uint32_t t) { return finder_->is_updated(t); };
  const auto may_meet = [&](std::uint32_t rim_triangle, std::uint32_t triangle) {
    const auto& [from, to, at_border] = edge(rim_triangle);
    return (source_crossings.is_vertex_near(from) || source_crossings.is_vertex_near(to)) &&
           source_crossings.sheets_cross(at_border, triangle);
  };
  const auto rim_corners = [&](std::uint32_t t) { return corners(t); };
  const auto skin_corners = [&](std::uint32_t t) -> std::array<Vec3d, 3> {
    const auto& [a, b, c] = surface_.triangles[t];
    return {positions_[a], positions_[b], positions_[c]};
  };

  std::erase_if(with_skin_,
                [&](const auto& pair) { return rim_has_moved(pair.first) || skin.is_updated(pair.second); });
  for (const auto& [r, t] : skin.met_by(rim, rim_corners))
    if (!is_left_out(constrained_, t) && !may_meet(r, t)) with_skin_.emplace_back(r, t);
  for (const auto& [t, r] : finder_->met_by(touched, skin_corners))
    if (!is_left_out(constrained_, t) && !rim_has_moved(r) && !may_meet(r, t)) with_skin_.emplace_back(r, t);
  std::sort(with_skin_.begin(), with_skin_.end());

  std::erase_if(with_other_, [&](const auto& pair) { return rim_has_moved(pair.first); });
  for (const auto& [r, t] : other_skin.met_by(rim, rim_corners))
    if (constrained_.triangle_on_part(t) && !may_meet(r, t)) with_other_.emplace_back(r, t);

  std::erase_if(with_rim_, [&](const auto& pair) { return rim_has_moved(pair.first) || rim_has_moved(pair.second); });
  for (const auto& [r, s] : finder_->of_updated())
    if (!may_meet(r, edge(s).triangle)) with_rim_.emplace_back(r, s);
}

}  // namespace vdb_offset
