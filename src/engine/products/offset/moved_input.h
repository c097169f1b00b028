// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "motion/paths/propagate.h"
#include "motion/paths/side_room.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

/// From what is offset back to the input, for meshes and curves alike.
namespace vdb_offset {

/// What is offset, as all stages after the field see it: Surface, or Polyline for curves.
template <class T>
concept Shape = requires(const T& shape) {
  { shape.origin } -> std::convertible_to<Vec3d>;
  { shape.vertices } -> std::convertible_to<std::span<const Vec3d>>;
  { shape.component } -> std::convertible_to<std::span<const std::uint32_t>>;
  { shape.facts.closed() } -> std::same_as<bool>;
  { shape.facts.oriented() } -> std::same_as<bool>;
};

/// Exact distances to a Shape: ClosestQuery or CurveQuery.
template <class T>
concept ShapeQuery = requires(const T& query, const Vec3d& x, std::uint32_t hint) {
  { query(x, hint) } -> std::same_as<Closest>;
  { query.surface() } -> Shape;
};

/// The vertices of an input, and how they are related to those of its Shape.
template <class T>
concept InputVertices = requires(const T& input, std::size_t v, const Vec3d& displacement) {
  /// Positions in the input.
  { input.positions() } -> std::same_as<std::span<const Vec3d>>;
  /// The Shape's vertex that an input vertex is; kNone if it is in no face, or on no curve.
  { input.shape_vertex(v) } -> std::same_as<std::uint32_t>;
  /// Where the path of an input vertex starts. \pre it has a vertex of the Shape
  { input.start(v) } -> std::same_as<Vec3d>;
  /// A displacement of a Shape's vertex as one of the input.
  { input.to_input(displacement) } -> std::same_as<Vec3d>;
};

/// A result in which every vertex is where it was, unused and without distances.
template <InputVertices Input>
OffsetResult unmoved_result(const Input& input) {
  OffsetResult result;
  const std::span<const Vec3d> positions = input.positions();
  result.positions.assign(positions.begin(), positions.end());
  result.states.assign(positions.size(), VertexState::Unused);
  result.achieved.assign(positions.size(), 0.0);
  return result;
}

/// The result for a distance of 0, which needs no field: every vertex in use has reached it. `distances` are those of
/// the input's vertices.
template <InputVertices Input>
OffsetResult result_at_source(const Input& input, Distances distances, bool keep_paths, OffsetStatistics statistics) {
  OffsetResult result = unmoved_result(input);
  result.statistics = std::move(statistics);
  result.distances = std::move(distances);
  for (std::size_t v = 0; v < result.states.size(); ++v)
    if (input.shape_vertex(v) != kNone) result.states[v] = VertexState::Reached;
  if (keep_paths)
    for (const Vec3d& position : result.positions) result.paths.push_back({position});
  return result;
}

/// Gives the input's vertices the positions, states and distances of their Shape's vertices. A vertex that has not
/// moved keeps its own position, even if it is welded to another one with a tolerance.
template <InputVertices Input>
void move_vertices(const Input& input, const Paths& paths, OffsetResult& result) {
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const std::uint32_t w = input.shape_vertex(v);
    if (w == kNone) continue;
    VDB_OFFSET_ASSERT(w < paths.displacement.size());
    const Vec3d displacement = input.to_input(paths.displacement[w]);
    if (displacement != Vec3d(0.0)) result.positions[v] = input.start(v) + displacement;
    result.states[v] = paths.state[w];
    result.achieved[v] = paths.achieved[w];
  }
}

/// The distances of the input's vertices, from those of their Shape's vertices; 0 for a vertex without one.
template <InputVertices Input>
Distances distances_of_input(const Input& input, const Distances& of_shape) {
  if (of_shape.uniform()) return of_shape;
  std::vector<double> each(input.positions().size(), 0.0);
  for (std::size_t v = 0; v < each.size(); ++v)
    if (const std::uint32_t w = input.shape_vertex(v); w != kNone) each[v] = of_shape[w];
  return Distances(std::move(each));
}

/// Gives the input's vertices the paths of their Shape's vertices. \pre the paths have traces
template <InputVertices Input>
void hand_out_paths(const Input& input, const Paths& paths, OffsetResult& result) {
  VDB_OFFSET_ASSERT(paths.trace.size() == paths.displacement.size());
  result.paths.resize(result.positions.size());
  for_each_index(result.paths.size(), [&](std::size_t v) {
    const std::uint32_t w = input.shape_vertex(v);
    if (w == kNone) {
      result.paths[v] = {result.positions[v]};
      return;
    }
    std::vector<Vec3d> trace;
    trace.reserve(paths.trace[w].size());
    for (const Vec3d& displacement : paths.trace[w]) trace.push_back(input.to_input(displacement));
    result.paths[v] = positions_on_path(input.start(v), trace, input.to_input(paths.displacement[w]));
  });
}

/// How much room a Shape has on either side, where so many vertices are short that it may be the wrong one; else
/// nothing is known, as of a Shape whose side is `sure`. `distances()` are those of the Shape's vertices, and only then
/// asked for.
template <ShapeQuery Query, std::invocable GetDistances>
SideRoom room_beside(const Query& query, bool sure, std::span<const VertexState> states, GetDistances&& distances) {
  if (sure || !falls_short(states)) return {};
  return room_on_sides(query, distances());
}

}  // namespace vdb_offset
