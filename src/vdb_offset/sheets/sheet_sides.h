#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The two sides of a mesh's faces, and how they hang together in space.
///
/// Around an edge, the faces there cut space into sectors; in each, the side of one face goes on as that of the next.
/// An edge of two faces has two sectors, one of three has three, and in one where a single face ends, that face's own
/// sides face each other. Sides that go on as each other have their corners at a vertex in common: a wedge of space.
/// Around a vertex inside a sheet there are two, around one where n sheets meet, n; and where an edge of more than two
/// faces ends and space goes all around that end, one for each of the sectors that it joins (see wedge_cuts.h).
struct SheetSides {
  /// A sector in which sides do not go on as each other, and are to be joined by a face of a rim: where a face ends,
  /// or sheets on one plane are thick on different sides.
  struct Gap {
    std::array<std::uint32_t, 2> corner;  ///< Where the faces' sides along the edge start (see EdgeSide).
    std::array<std::uint8_t, 2> side;
    Vec3d shift{0.0};  ///< Where both should lead for the sheets to hang together.
  };
  /// A side at whose height another wedge should be, too: that which a corner, as 2 c + s, is part of.
  struct SharedPlane {
    std::uint32_t side, corner;
  };

  /// wedge[2 c + s] is that of side s at corner c of the mesh; s is 0 for the side that the face faces, or else 1.
  std::vector<std::uint32_t> wedge;
  std::size_t wedges = 0;
  std::vector<Gap> gaps;  ///< By their first corners.
  std::vector<SharedPlane> shared;
};

/// What is to be known of a mesh to tell its sides apart.
struct Sheets {
  PolygonView mesh;
  std::span<const std::uint32_t> place;   ///< Of each vertex (see weld_by_position()).
  std::span<const std::uint8_t> turned;   ///< Of each face: 1 if it was turned round to agree with its neighbours.
  std::span<const std::uint8_t> repeats;  ///< Of each face: 1 if it lies over an earlier one.
  /// How thick a sheet is to be at a vertex, world units: on its outer side, and on its inner one.
  std::function<std::array<double, 2>(std::uint32_t)> thickness;

  bool is_turned(std::size_t face) const { return turned[face] != 0; }
  /// Thickness on a side of a face, at one of its vertices.
  double thickness_on(std::size_t face, std::uint8_t side, std::uint32_t vertex) const {
    return thickness(vertex)[is_turned(face) ? 1 - side : side];
  }
};

SheetSides find_sides(const Sheets& sheets);

/// Of each of a surface's vertices: 1 if more than two wedges meet there, or two that each have an outer and an inner
/// side: at edges of three faces or more, at vertices that fans share, and where faces cannot agree about the outside.
/// Edges at which faces lie on each other do not count, nor do vertices of faces that were left out as they repeat
/// others: doubled sheets go as one. Empty if there is none.
/// \param mesh what the surface was built from, or of which it has only some faces
/// \param only of each of the mesh's faces: 1 for those; empty: all
std::vector<std::uint8_t> find_junctions(const Surface& surface, PolygonView mesh,
                                         std::span<const std::uint8_t> only = {});

/// The face's normal times twice its area.
Vec3d newell_normal(PolygonView mesh, std::size_t face);

}  // namespace vdb_offset
