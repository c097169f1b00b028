// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// A closed loop of edges that lack a face on one side.
struct Hole {
  std::vector<std::uint32_t> rim;  ///< Vertices, in the direction that the missing faces run.
  double area = 0;                 ///< Of the fan around centre_of() that fills it.
  double radius = 0;               ///< No point of the fan is farther from the rim.
  std::uint32_t beside = 0;        ///< A triangle at the rim.
  bool is_wall = false;  ///< Plane, and no edge is a border: a wall inside ends there, and lies in the filling.
};

/// Mean of the rim's vertices, where these stand now.
Vec3d centre_of(const Surface& surface, const Hole& hole);

/// Which parts of a mesh are solid. Parts are joined over edges.
struct Solidity {
  std::vector<std::uint32_t> part_of;  ///< Of each triangle.
  std::vector<std::uint8_t> is_solid;  ///< Of each part: with its holes filled, it winds around whole points.
  std::vector<Hole> holes;             ///< Of the solid parts.
  double area = 0;                     ///< Of the solid parts.
  double volume = 0;                   ///< That these enclose, holes filled; below 0 if inside out.

  std::size_t solid_parts() const;
  bool all_solid() const { return solid_parts() == is_solid.size(); }
  std::size_t hole_count() const;  ///< Holes that are no walls.
  double hole_area() const;        ///< Their area.
};

/// Finds the parts that enclose something, though some of their edges may not have two faces.
///
/// Where as many faces run through each edge one way as the other, a part winds a whole number of times around each
/// point, however many meet there. Elsewhere edges that lack faces make loops, and the generalised winding number
/// (Jacobson et al., Robust inside-outside segmentation using generalized winding numbers, 2013) is that of the mesh
/// with these loops filled, less the share of all directions in which a point sees the fillings. So it is clear what is
/// inside if the fillings are small: each 0.2 % of the part's area at most, or 5 % where it goes on as the faces around
/// do, and all together 10 %. Loops of edges with three faces and more, at which walls inside end, are filled whatever
/// their area if they are plane. Other parts are open.
Solidity find_solid_parts(const Surface& surface);

}  // namespace vdb_offset
