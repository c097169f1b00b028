// SPDX-License-Identifier: Apache-2.0
#include "products/tolerance/refined_mesh.h"

#include <algorithm>
#include <utility>

#include "ground/numbers/index_set.h"
#include "products/offset/field_stage.h"
#include "valid/faults/fault_finder.h"

namespace vdb_offset {

RefinedMesh::RefinedMesh(const RefinedTriangles& triangles, PolygonView mesh, const OffsetOptions& options,
                         const Rounding& precision, int threads, const Yield& yield, bool crosses_nothing,
                         std::span<const FacePair> met)
    : mesh_(mesh),
      options_(options),
      precision_(precision),
      threads_(threads),
      yield_(yield),
      crosses_nothing_(crosses_nothing),
      met_(met) {
  refinement_ = triangles.of_mesh(mesh, numbers_, &triangle_of_face_);
  const auto faces = std::lower_bound(refinement_.parent.begin(), refinement_.parent.end(), yield.measured_faces);
  yield_.measured_faces = static_cast<std::uint32_t>(faces - refinement_.parent.begin());
  if (options.only.empty()) return;
  options_.only.clear();
  for (const std::uint32_t f : refinement_.parent) options_.only.push_back(options.only[f]);
}

/// Puts all vertices to their targets.
void RefinedMesh::prepare(const std::vector<RefinedVertex>& vertices) {
  const std::size_t count = refinement_.polygons.positions.size();
  VertexTargets targets{std::vector<Vec3d>(count, Vec3d(0.0)), std::vector<VertexState>(count, VertexState::Limited)};
  for (const Vec3d& position : refinement_.polygons.positions)
    targets.vertex_error = std::max(targets.vertex_error, precision_.most_off_together(position));
  std::vector<double> each(options_.distance.uniform() ? 0 : count);
  if (!each.empty()) {
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) each[v] = options_.distance[v];
    for (std::size_t v = mesh_.positions.size(); v < count; ++v)
      each[v] = vertices[numbers_.of_added[v - mesh_.positions.size()]].asked;
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::uint32_t v = numbers_.of_vertex[i];
    if (v == kNone) continue;
    targets.displacement[v] = vertices[i].target.displacement;
    const bool is_mitered = vertices[i].target.is_mitered || vertices[i].otherwise == VertexState::Mitered;
    targets.state[v] = !vertices[i].target.is_there ? vertices[i].otherwise
                       : is_mitered                 ? VertexState::Mitered
                                                    : VertexState::Reached;
  }
  if (!each.empty()) options_.distance = Distances(std::move(each));
  space_.emplace(refinement_.polygons.view(), options_.metric);
  prepared_.emplace(*space_, options_, threads_, farthest_of({&options_.distance, 1}), yield_);
  asked_ = ask(*prepared_, {&options_.distance, 1});
  marched_.push_back(prepared_->marched_to(asked_->moved.front(), targets));
}

/// Whether the faces of the mesh have met that two faces are pieces of.
bool RefinedMesh::has_met(std::uint32_t face, std::uint32_t other) const {
  const auto [first, second] = std::minmax(refinement_.parent[face], refinement_.parent[other]);
  return std::binary_search(met_.begin(), met_.end(), FacePair(first, second));
}

std::vector<std::uint32_t> RefinedMesh::faulty_triangles(const std::vector<RefinedVertex>& vertices) {
  prepare(vertices);
  const Surface& surface = prepared_->surface();
  const ConstrainedSurface constrained = prepared_->constrained(marched_.front(), false);
  FaultFinder finder(constrained, prepared_->source(), asked_->moved.front(), options_.precision,
                     prepared_->surroundings() || !crosses_nothing_ ? prepared_->known_crossings() : SelfCrossings{});
  finder.move_to_ends(marched_.front().paths);
  std::vector<std::uint8_t> is_faulty(refinement_.parent.size(), 0);
  const auto take = [&](std::uint32_t t) {
    if (surface.face[t] < is_faulty.size() && !constrained.is_obstacle(t)) is_faulty[surface.face[t]] = 1;
  };
  finder.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
    take(s);
    take(t);
  });
  // Where the mesh crosses itself, what crosses has to slide. That is no reason to make more that does.
  for (const auto& [s, t] : finder.crossings_near_source()) {
    if (constrained.is_obstacle(s) || constrained.is_obstacle(t) || has_met(surface.face[s], surface.face[t])) continue;
    take(s);
    take(t);
  }
  // Beside a border the side that a vertex is on may be anyone's guess.
  if (prepared_->parts().moving_part.facts.closed())
    for (const std::uint32_t v : finder.misplaced())
      for (const std::uint32_t t : surface.triangles_around(v)) take(t);
  Indices triangles;
  for (std::size_t f = 0; f < is_faulty.size(); ++f)
    if (is_faulty[f] && triangle_of_face_[f] != kNone) triangles.push_back(triangle_of_face_[f]);
  return triangles;
}

OffsetResult RefinedMesh::offset(const std::vector<RefinedVertex>& vertices) {
  prepare(vertices);
  return std::move(make_results(*prepared_, *asked_, std::move(marched_)).front());
}

}  // namespace vdb_offset
