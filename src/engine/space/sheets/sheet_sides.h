// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "space/surface/surface.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The two sides of a mesh's faces, and how they are connected in space.
///
/// The faces around an edge cut space into sectors; in each, the side of one face continues as that of the next. An
/// edge of two faces has two sectors, an edge of three has three, and at an edge where a single face ends, that face's
/// own sides face each other. Sides that continue each other have their corners at a vertex in common: a wedge. Around
/// a vertex inside a sheet there are two wedges, around a vertex where n sheets meet, n; and where an edge of more than
/// two faces ends, and space goes all around that end, one for each of the sectors that it joins (see wedge_cuts.h).
struct SheetSides {
  /// A sector in which sides do not continue each other, and are to be joined by a face of a rim: where a face ends, or
  /// sheets on one plane are thick on different sides.
  struct Gap {
    std::array<std::uint32_t, 2>
        corner;                        ///< The corners at which the faces' sides along the edge start (see EdgeSide).
    std::array<std::uint8_t, 2> side;  ///< The sides of these faces: 0 or 1.
    Vec3d shift{0.0};                  ///< By which both sides should move for the sheets to be connected.
  };
  /// A side at whose height the wedge of another corner should be as well. Both are given as 2 c + s, as in `wedge`.
  struct SharedPlane {
    std::uint32_t side, corner;
  };

  /// wedge[2 c + s] is the wedge of side s at corner c of the mesh; s is 0 for the side that the face's normal points
  /// to, and 1 for the other.
  std::vector<std::uint32_t> wedge;
  std::size_t wedges = 0;
  std::vector<Gap> gaps;            ///< Sorted by their first corners.
  std::vector<SharedPlane> shared;  ///< Where wedges were cut.
};

/// The input of find_sides(): a mesh, and how its surface was built.
struct Sheets {
  PolygonView mesh;
  std::span<const std::uint32_t> welded_to;  ///< Of each vertex: the first at its position (see weld_by_position()).
  std::span<const std::uint8_t> turned;      ///< Of each face: 1 if it was turned round to agree with its neighbours.
  std::span<const std::uint8_t> repeats;     ///< Of each face: 1 if it lies over an earlier one.
  /// The thickness of a sheet at a vertex, world units: on its outer side, and on its inner side.
  std::function<std::array<double, 2>(std::uint32_t)> thickness;

  bool is_turned(std::size_t face) const { return turned[face] != 0; }
  /// The thickness on a side of a face, at one of its vertices.
  double thickness_on(std::size_t face, std::uint8_t side, std::uint32_t vertex) const {
    return thickness(vertex)[is_turned(face) ? 1 - side : side];
  }
};

/// Finds how the sides of a mesh's faces are connected.
SheetSides find_sides(const Sheets& sheets);

/// Marks the vertices of a surface at which more than two wedges meet, or two that each have an outer and an inner
/// side: at edges of three faces or more, at vertices that fans share, and where faces cannot agree about the outside.
/// Edges at which faces lie on each other do not count, nor do vertices of faces that were left out as repeating
/// others: doubled sheets count as one. Empty if there is no such vertex.
/// \param mesh from whose faces, or some of them, the surface was built
/// \param only of each of the mesh's faces: 1 if the surface has it; empty: it has all
std::vector<std::uint8_t> find_junctions(const Surface& surface, PolygonView mesh,
                                         std::span<const std::uint8_t> only = {});

}  // namespace vdb_offset
