// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A Delaunay triangulation in the plane, with exact predicates, that can be made to keep segments and be cut to the
/// region that these enclose. Corners of triangles run counter-clockwise.
class Triangulation {
 public:
  using Index = std::uint32_t;
  struct Triangle {
    std::array<Index, 3> corners;
    std::array<Index, 3> beside;  ///< Across from each corner; kNone: the boundary.
  };
  /// A triangle's side, across from a corner.
  struct Side {
    Index triangle, corner;
  };
  /// The triangles whose circles hold a point, and the sides around them.
  struct Cavity {
    std::vector<Index> triangles;
    std::vector<Side> sides;
  };

  /// Of some points. \throw InvalidInput for two at one place
  explicit Triangulation(std::span<const Vec2d> points);

  const std::vector<Vec2d>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const Vec2d& corner(Index triangle, std::size_t k) const { return points_[triangles_[triangle].corners[k % 3]]; }

  /// Makes the triangulation have each of the segments as an edge, and drops all triangles but those on their left.
  /// \throw InvalidInput for segments that cross, or go through a point
  void cut_to(std::span<const std::array<Index, 2>> segments);

  /// The cavity of a point in the circle of a triangle, as far as it can be seen from there. None if the point lies
  /// beyond the boundary, or on it.
  std::optional<Cavity> cavity_of(const Vec2d& x, Index triangle);
  /// Puts a point into its cavity, whose triangles are replaced by those around it. Returns these.
  std::vector<Index> insert(const Vec2d& x, const Cavity& cavity);

  /// Moves a point. \pre the triangles around it stay counter-clockwise
  void move(Index point, const Vec2d& to) { points_[point] = to; }
  /// Turns the edge across from a corner to the other diagonal of the two triangles there.
  void flip(const Side& side);
  /// Which corner of a triangle is across from another one beside it.
  std::size_t corner_towards(Index triangle, Index other) const;

 private:
  std::vector<Index> put(Index point, const Cavity& cavity);
  Index locate(const Vec2d& x) const;
  struct Crossed {
    std::vector<Index> triangles, left, right;
  };
  void enforce(Index from, Index to);
  std::optional<Side> way_out(Index from, Index to) const;
  Crossed crossed_by(Index from, Index to, const Side& entry) const;
  void put_beside(Index triangle, Index from, Index to, Index other);
  std::optional<std::size_t> corner_of(Index triangle, Index point) const;
  template <class Visit>
  void turn_around(Index point, Visit&& visit) const;
  void drop_outside(std::span<const std::array<Index, 2>> segments);

  std::vector<Vec2d> points_;
  std::vector<Triangle> triangles_;
  std::vector<Index> at_;        // of each point: a triangle there
  std::vector<Index> stamp_;     // of each triangle: the last cavity that looked at it
  std::vector<Index> starting_;  // of each point: a new triangle with a side from there, for put()
  Index cavities_ = 0;
  Index last_ = 0;
};

}  // namespace vdb_offset
