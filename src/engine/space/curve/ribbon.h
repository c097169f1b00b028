// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The plane that curves lie in, with two axes. A plane z = constant has the axes x and y; one across another axis has
/// the other two, so that coordinates are the input's to the last bit; any other plane has unit vectors.
struct PlaneFrame {
  Vec3d origin{0.0}, u{1, 0, 0}, v{0, 1, 0};
  Vec2d to_plane(const Vec3d& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
  Vec3d to_space(const Vec2d& vector) const { return u * vector[0] + v * vector[1]; }
};

/// Finds the plane of curves. \throw InvalidInput if points that curves use do not lie in one plane, to 1e-6 of their
/// extent, by the point that is farthest off; or if one is not finite or an index is out of range.
PlaneFrame plane_of(CurvesView curves);

/// A segment of a curve between two points, by their numbers: its right side, as one looks along it, is outward.
using Segment = std::array<std::uint32_t, 2>;

/// Curves joined end to end.
struct CurveChains {
  /// In the order of the chains, each from where the one before it ends; between the first points at each position;
  /// none without a length.
  std::vector<Segment> segments;
  /// For each point the first one at its position, or, of two ends that are apart by rounding alone, the first of
  /// these; kNone if no curve uses it.
  std::vector<std::uint32_t> welded_to;
  std::size_t chains = 0, closed = 0;  ///< Curves from end to end; those among them that are closed.
  std::size_t ends = 0;                ///< Points where one segment ends, and no other begins.
  std::size_t branchings = 0;          ///< Points where more than two segments meet.
};

/// Joins curves end to end, however they are cut into pieces and whichever way those run, and settles which side is
/// outward: of closed curves the outer side, out of those that an even number of others surround and into holes; of
/// others the right, as one goes along them (along most of the pieces that they are made of), which is the outer side
/// of a closed curve that runs counterclockwise.
CurveChains join_curves(CurvesView curves, std::span<const Vec2d> points);

/// The ribbon that stands on segments, from z = 0 up to `height`: a point at a height in between is exactly as far from
/// the ribbon as from the curve in its plane. Point p becomes the vertices 2 p, below, and 2 p + 1.
Polygons make_ribbon(std::span<const Segment> segments, std::span<const Vec2d> points, double height);

}  // namespace vdb_offset
