// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// A round hole, as far as one ring of flat facets goes around it.
struct RoundHole {
  std::vector<std::uint32_t> faces;
  double diameter;  ///< Of the circle that the corners lie on; of a cone the least, or the largest if it ends in a tip.
};

/// What the faces of a mesh are by their own shape and that of the faces around them. Vertices at one position count as
/// one, and faces in one plane that share an edge as one facet.
///
/// A ring is a closed sequence of
/// facets that bend to one side around one axis, with which all of their normals make one angle: a cylinder or a cone,
/// from eight facets on.
class FaceShapes {
 public:
  explicit FaceShapes(PolygonView mesh);

  /// Of each face: 1 if it looks up (side 1) or down (-1) the z axis, within less than 45 degrees.
  std::vector<std::uint8_t> facing(int side) const;
  /// Of each face: 1 if it looks along an axis to one side (1 or -1), within a degree, and lies as far that way as any
  /// such face, within 0.01 % of the mesh's diagonal.
  std::vector<std::uint8_t> flat_end(std::size_t axis, int side) const;
  /// Of each face: 1 if it is on a surface that is curved outward (side 1) or inward (-1): on a ring that is, or else
  /// by most of what its facet bends from others.
  std::vector<std::uint8_t> curved(int side) const;
  /// The rings of facets that are curved inward.
  std::vector<RoundHole> holes() const;

 private:
  /// A facet that another one bends from: by an angle, above 0 if the edge between them is convex.
  struct Neighbour {
    std::uint32_t facet;
    double bend, length;
  };
  /// A facet between two others that bend from it to one side; and the axis that all three go around.
  struct Link {
    std::uint32_t facet;
    std::array<std::uint32_t, 2> beside;
    Vec3d axis;
  };
  using Ring = std::vector<std::uint32_t>;

  void find_facets();
  void find_neighbours();
  std::vector<Link> links_of(std::uint32_t facet, int side) const;
  std::optional<Link> next_of(const Link& link, std::uint32_t to, int side) const;
  std::optional<Ring> ring_from(const Link& start, int side) const;
  std::vector<Ring> rings(int side) const;
  Vec3d axis_of(const Ring& ring) const;
  bool is_round(const Ring& ring) const;
  double diameter_of(const Ring& ring) const;
  std::vector<Vec3d> corners_of(const Ring& ring) const;

  /// An edge of two faces that run along it in opposite directions.
  struct Edge {
    std::uint32_t from, to, left, right;  // vertices, and the face that it runs along and against
  };

  PolygonView mesh_;
  std::vector<Vec3d> area_;  // of each face, twice, along its normal
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> facet_;               // of each face
  std::vector<Vec3d> normal_;                      // of each facet
  std::vector<std::vector<std::uint32_t>> faces_;  // likewise
  std::vector<std::vector<Neighbour>> beside_;     // likewise
};

}  // namespace vdb_offset::io
