#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/mesh/in_metric.h"
#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/query/obstacles.h"

namespace vdb_offset {

/// Where distances are measured in the space of a metric: what vertices are in the file, which is what counts where
/// triangles meet.
struct FileFrame {
  const InMetric& space;
  std::span<const Vec3d> source;  ///< Of the body's vertices, as its source in that space.
  std::span<const Vec3d> places;  ///< Where they stand, if that is known; else where they are put, rounded.

  /// Of a vertex that is put to a place in that space.
  Vec3d of(std::size_t vertex, const Vec3d& from, const Vec3d& to, const Rounding& precision) const {
    if (!places.empty()) return places[vertex];
    const Vec3d& before = source[vertex];
    return precision(before, to == from ? before : space.moved(before, from, to));
  }
};

/// All that must stay valid, beside the front that distances are measured from.
///
/// The surface holds what moves and what is in its way: the whole mesh where only a part of it is offset, and obstacles
/// behind it. It stands in the front's frame. Spans are empty where the surface is the front itself.
struct ConstrainedSurface {
  const ClosestQuery& front;
  const Surface& surface;
  std::span<const std::uint32_t> front_vertex;  ///< Of each vertex; kNone where it is not on the front.
  std::span<const std::uint8_t> off_front;      ///< Of each triangle: 1 if it is no part of the front.
  std::span<const std::uint8_t> bound;          ///< Of each vertex: 1 if it must not leave the path it went.
  const Obstacles* obstacles = nullptr;         ///< Those to keep away from, if there are any.
  bool off_source = false;                      ///< What has moved must not meet the source either, as in a shell.
  /// Faces of the mesh, if what is off the front stays as a whole while layers rise from it: border vertices then go
  /// along those faces instead of taking them along. 0: they are taken along.
  std::size_t resting_faces = 0;
  bool with_rim = false;  ///< A shell's rim joins its borders to those of its other skin; what meets it is wrong, too.
  /// Of each vertex: where a shell's other skin stands, world coordinates, which what moves must not meet. Empty: that
  /// is the source.
  std::span<const Vec3d> other_skin;

  const FileFrame* file = nullptr;  ///< If the body's space is not the file's.

  /// The index of a vertex on the front; kNone if it is not there.
  std::uint32_t front_vertex_of(std::uint32_t vertex) const {
    return front_vertex.empty() ? vertex : front_vertex[vertex];
  }
  bool on_front(std::uint32_t vertex) const { return front_vertex.empty() || front_vertex[vertex] != kNone; }
  bool is_front(std::uint32_t triangle) const { return off_front.empty() || !off_front[triangle]; }
  /// Triangles of an obstacle never move.
  bool is_obstacle(std::uint32_t triangle) const {
    return obstacles && triangle >= surface.triangles.size() - obstacles->query.surface().triangles.size();
  }
  /// Nor do its vertices, which are behind all others, nor are they written.
  bool is_of_obstacle(std::uint32_t vertex) const {
    return obstacles && vertex >= surface.vertices.size() - obstacles->query.surface().vertices.size();
  }
  bool rests(std::uint32_t triangle) const { return !is_front(triangle) && surface.face[triangle] < resting_faces; }
  bool has_bound_corner(std::uint32_t triangle) const {
    const auto& corners = surface.triangles[triangle];
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return is_bound(v); });
  }
  bool is_bound(std::uint32_t vertex) const { return !bound.empty() && bound[vertex]; }
  /// A triangle of the front to start a search from.
  std::uint32_t hint_of_triangle(std::uint32_t triangle) const {
    return front_vertex.empty() ? triangle : hint(surface.triangles[triangle][0]);
  }
  std::uint32_t hint(std::uint32_t vertex) const {
    const std::uint32_t v = front_vertex_of(vertex);
    return v == kNone ? 0 : front.surface().triangles_around(v).front();
  }
  /// Whether sizes and frames agree: for assertions.
  bool fits() const {
    const auto fits = [](const auto& some, std::size_t count) { return some.empty() || some.size() == count; };
    return surface.origin == front.surface().origin && fits(front_vertex, surface.vertices.size()) &&
           fits(off_front, surface.triangles.size()) && fits(bound, surface.vertices.size()) &&
           fits(other_skin, surface.vertices.size()) && front_vertex.empty() == off_front.empty() &&
           (!obstacles || obstacles->query.surface().origin == surface.origin);
  }
};

}  // namespace vdb_offset
