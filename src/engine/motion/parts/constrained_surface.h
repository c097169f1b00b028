// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/distances/in_metric.h"
#include "ground/numbers/rounding.h"
#include "space/query/closest_query.h"
#include "space/query/obstacles.h"

namespace vdb_offset {

/// The space of the file, where distances are measured in the space of a metric: vertices are written there, and it
/// decides where triangles meet.
struct FileFrame {
  const InMetric& space;
  std::span<const Vec3d> source;  ///< Of each vertex of the constrained surface: its position in the input.
  std::span<const Vec3d>
      positions;  ///< Of each vertex: its position, if that is known; empty: it is computed, rounded.

  /// The position in the file of a vertex that is moved, in the space of the metric, from `from` to `to`.
  Vec3d of(std::size_t vertex, const Vec3d& from, const Vec3d& to, const Rounding& precision) const {
    if (!positions.empty()) return positions[vertex];
    const Vec3d& before = source[vertex];
    return precision(before, to == from ? before : space.moved(before, from, to));
  }
};

/// What of an error of vertices counts at a distance: no more than a thousandth of it, as what is farther off is short.
inline double vertex_error_at(double error, double distance) { return std::min(error, 1e-3 * std::abs(distance)); }

/// All that must stay valid: the part that moves, which distances are measured from, and what it must not meet.
///
/// The surface holds what moves and what is in its way: the whole mesh where only a part of it is offset, and obstacles
/// behind it. It stands in the moving part's frame. Spans are empty where the surface is the moving part itself.
struct ConstrainedSurface {
  const ClosestQuery& moving_part;  ///< Of the moving part.
  const Surface& surface;
  std::span<const std::uint32_t> part_vertex;  ///< Of each vertex: its index on the moving part, or kNone.
  std::span<const std::uint8_t> off_part;      ///< Of each triangle: 1 if it is not on the moving part.
  std::span<const std::uint8_t> bound;         ///< Of each vertex: 1 if it must not leave its path.
  const Obstacles* obstacles = nullptr;        ///< Obstacles to keep away from, if there are any.
  bool off_source = false;                     ///< Moved faces must not meet the source either, as in a shell.
  /// Faces with a smaller index than this, and not on the moving part, stay fixed, as while layers rise: vertices at
  /// the border go along them. 0: border faces are carried along.
  std::size_t resting_faces = 0;
  bool with_rim = false;  ///< A shell's rim joins the borders of both skins; what meets it is a fault, too.
  /// Of each vertex: its position in the other skin of a shell, world coordinates, which moved faces must not meet.
  /// Empty: that skin is the source.
  std::span<const Vec3d> other_skin;

  /// Of each vertex: how far from the moving part it may be, if that is farther than its distance. Empty: no vertex
  /// may.
  std::span<const double> farther;
  /// Of each vertex: how near to the triangles of the moving part it may be and yet be at its distance from the exact
  /// surface; 0 if it has to be as far as asked. Empty: all have.
  std::span<const double> nearer;
  /// Of each vertex of the moving part: whether it is on a crease. Empty: that is not known.
  std::span<const std::uint8_t> on_crease;

  /// How far the surface's vertices may be off where they were before their digits were cut to those of a file, as in a
  /// refined mesh, whose added vertices were in the planes of faces: distances are no more exact than that.
  double vertex_error = 0;

  const FileFrame* file = nullptr;  ///< If distances are measured in the space of a metric.

  /// The index of a vertex on the moving part; kNone if it is not there.
  std::uint32_t part_vertex_of(std::uint32_t vertex) const {
    return part_vertex.empty() ? vertex : part_vertex[vertex];
  }
  bool vertex_on_part(std::uint32_t vertex) const { return part_vertex.empty() || part_vertex[vertex] != kNone; }
  bool triangle_on_part(std::uint32_t triangle) const { return off_part.empty() || !off_part[triangle]; }
  /// Whether a triangle is one of an obstacle, which never moves.
  bool is_obstacle(std::uint32_t triangle) const {
    return obstacles && triangle >= surface.triangles.size() - obstacles->query.surface().triangles.size();
  }
  /// Whether a vertex is one of an obstacle. These are behind all others, never move, and are not written.
  bool is_of_obstacle(std::uint32_t vertex) const {
    return obstacles && vertex >= surface.vertices.size() - obstacles->query.surface().vertices.size();
  }
  /// Whether a triangle stays while layers rise from the moving part.
  bool rests(std::uint32_t triangle) const {
    return !triangle_on_part(triangle) && surface.face[triangle] < resting_faces;
  }
  bool has_bound_corner(std::uint32_t triangle) const {
    const auto& corners = surface.triangles[triangle];
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return is_bound(v); });
  }
  bool is_bound(std::uint32_t vertex) const { return !bound.empty() && bound[vertex]; }
  /// A triangle of the moving part to begin a search at.
  std::uint32_t hint_of_triangle(std::uint32_t triangle) const {
    return part_vertex.empty() ? triangle : hint(surface.triangles[triangle][0]);
  }
  /// A triangle of the moving part, at a vertex if that is on it, to begin a search at.
  std::uint32_t hint(std::uint32_t vertex) const {
    const std::uint32_t v = part_vertex_of(vertex);
    return v == kNone ? 0 : moving_part.surface().triangles_around(v).front();
  }
  /// Whether sizes and frames agree: for assertions.
  bool fits() const {
    const auto fits = [](const auto& some, std::size_t count) { return some.empty() || some.size() == count; };
    return surface.origin == moving_part.surface().origin && fits(part_vertex, surface.vertices.size()) &&
           fits(off_part, surface.triangles.size()) && fits(bound, surface.vertices.size()) &&
           fits(other_skin, surface.vertices.size()) && fits(farther, surface.vertices.size()) &&
           fits(nearer, surface.vertices.size()) && fits(on_crease, moving_part.surface().vertices.size()) &&
           part_vertex.empty() == off_part.empty() &&
           (!obstacles || obstacles->query.surface().origin == surface.origin);
  }
};

}  // namespace vdb_offset
