// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A miter with which a plane would go farther than the distance by more than this share of it is none. Not measured.
inline constexpr double kMostExcess = 0.5;

/// Where a vertex has to go for the planes around it to be moved by 1, each along its normal.
struct MiterPoint {
  Vec3d position;     ///< As seen from the vertex.
  double excess = 0;  ///< By how much more than 1 the plane is moved that is moved farthest.
};

/// The smallest x with n . x = 1 for all of some normals, if there is one: up to three planes have it, and more that
/// touch one cone. Else the smallest with n . x >= 1, on which at most three planes lie: the quadratic program whose
/// solution is p / |p|^2, with p the point of the normals' convex hull that is nearest to the origin (Wolfe, Finding
/// the nearest point in a polytope, 1976). Three planes of which two are almost one are moved by 1 or more as well: the
/// point in which they meet is anywhere.
/// \param normals of unit length, or shorter by what a plane that x has to lie in takes from them
/// \return nothing if there is none: the normals do not all face one direction
std::optional<MiterPoint> miter_point(std::span<const Vec3d> normals);

/// Takes from normals their parts along those of one or two walls, planes that x has to lie in.
void keep_to_walls(std::span<const Vec3d> walls, std::vector<Vec3d>& normals);

/// By how much more than 1 x moves the plane that it moves farthest; 0 if it moves none by more.
double excess_of(std::span<const Vec3d> normals, const Vec3d& x);

}  // namespace vdb_offset
