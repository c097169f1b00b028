// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "products/fill/openings.h"

/// Lines in which planes of openings cross, as the axis of a quarter of a pipe is one.
namespace vdb_offset {

/// A piece of such a line that belongs to the border of what is to be filled, on both planes.
struct LineSegment {
  std::array<std::uint32_t, 2> planes;
  std::array<std::uint32_t, 2> ends;  ///< Points of the mesh, or behind these those of PlaneLines::corners.
};

struct PlaneLines {
  std::vector<Vec3d> corners;         ///< Where three planes cross and no point of the mesh is.
  std::vector<LineSegment> segments;  ///< Those that end at a point of the mesh come first.
  bool is_closed = true;              ///< Else some lines go on without an end: what is to be filled is unbounded.
};

/// Finds what closes openings along the lines in which their planes cross, beginning where an opening's edges go over
/// from one plane to another, into what is to be filled, and ending at the next such point or at a third plane.
/// \throw InvalidInput where more than two planes meet at a point of an opening
PlaneLines find_plane_lines(std::span<const Vec3d> points, std::span<const OpenPlane> planes);

/// Adds the segments to both of their planes, parted into edges that are as long as those of openings at their ends,
/// and grow from there. Points are added to the mesh.
/// \param alike pairs of points at which edges are to be as long as at each other
void close_along(const PlaneLines& lines, double growth, double longest, std::vector<Vec3d>& points,
                 std::vector<OpenPlane>& planes, const std::map<std::uint32_t, std::uint32_t>& alike = {});

}  // namespace vdb_offset
