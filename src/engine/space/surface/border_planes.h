// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"

/// Planes that vertices stay in: those of symmetry, of half models, and those that borders lie in.
namespace vdb_offset {

struct Surface;

/// Keeps a vertex on its side of a plane: its positions are at heights of 0 or less above the plane.
struct Wall {
  std::uint32_t vertex;
  SymmetryPlane plane;
  double slack;  ///< World units: vertices may be above the plane by this, by the input's own rounding.
};

/// Whether, beyond the edge of a border from one vertex to another, the mesh goes on with faces that this surface has
/// not, and at the first vertex leads out of a plane with this normal.
using LeadsOn = std::function<bool(std::uint32_t vertex, std::uint32_t other, const Vec3d& normal)>;

/// Decides which vertices of a surface stay in planes, and has its conormals say so: along_border() takes from a vector
/// what leads out of those planes, exactly where these are at right angles to an axis.
///
/// If no planes are named, these are the vertices of borders, or of pieces of borders, that lie in a plane to the
/// precision of a file of seven digits, if the faces there rise from that plane by at least 12 degrees, so that
/// displacements in the plane lead off all of them; and vertices of straight pieces along which the
/// faces are in one plane: they stay in the plane at right angles to it. Where the surface lies on one side of a plane,
/// that becomes a wall: for a border's plane, of the vertices that are connected with it within `reach`, the farthest
/// that vertices go, if that is not 0, but not of those that lie in it away from that border, nor farther on from
/// these: the surface goes on along the plane there. For a named plane, of all that are connected with it. Where the
/// mesh leads on out of a plane that was found, that holds nothing, and is no wall: what slides on the faces there
/// leaves it. \pre conormals and normals are those of the surface as it stands. \throw InvalidInput if there is no
/// vertex on a plane that is named
void hold_in_planes(Surface& surface, const SymmetryOptions& options, double reach, const LeadsOn& leads_on = {});

/// Normals of planes, at right angles to each other.
struct PlaneNormals {
  std::array<Vec3d, 3> normal{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
  std::size_t count = 0;

  /// A vector without what leads out of the planes: exactly, of one at right angles to an axis.
  Vec3d within(Vec3d v) const {
    for (std::size_t i = 0; i < count; ++i) v -= normal[i] * normal[i].dot(v);
    return v;
  }
};

/// The planes that hold what is between some vertices of a surface: those that hold all of these. What is not on the
/// border itself is held by planes that are named alone.
PlaneNormals planes_along(const Surface& surface, std::span<const std::uint32_t> vertices, bool is_on_border);

/// Makes planes of the surface walls, as hold_in_planes() says.
/// \param held for each plane the vertices that it holds; none of one that is to be no wall
/// \param reach the farthest that vertices go
/// \param tolerance how far a vertex in a plane may be off it
void raise_walls(Surface& surface, std::span<const Indices> held, double reach, double tolerance);

/// Whether a position of a vertex is beyond one of its walls, by more than `slack`.
bool is_beyond_wall(const Surface& surface, std::uint32_t vertex, const Vec3d& x, double slack);

}  // namespace vdb_offset
