// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// The triangles around a vertex, in their order, and the ridges that part them into sectors.
struct RidgeFan {
  std::uint32_t vertex;
  int side;                              ///< 1 if the vertex goes outward, -1 inward.
  std::vector<std::uint32_t> triangles;  ///< Counter-clockwise, as seen from outside.
  std::vector<std::uint32_t> across;     ///< Of each of them: the other end of its edge to the next one.
  std::vector<std::uint8_t> is_open;     ///< Of each of these edges: it is a ridge, and is opened here.
  std::vector<std::uint32_t> sector;     ///< Of each triangle.
  std::uint32_t sectors = 0;
  bool is_at_border = false;  ///< The first and the last triangle are on a border; else they are neighbours.

  std::size_t next(std::size_t i) const { return i + 1 < triangles.size() ? i + 1 : 0; }
  /// Numbers the sectors anew, from the edges that are open.
  void part();
};

/// Finds ridges: edges that are convex on the side to which they go, and bend by more than a given angle.
class RidgeFinder {
 public:
  /// Keeps references. \param distances of all vertices \param least_bend above which an edge is a ridge, radians
  /// \param at_borders whether vertices on borders can be opened
  RidgeFinder(const PreparedMesh& mesh, const Distances& distances, double least_bend, bool at_borders);

  /// The fan of a vertex that can be opened, whose ridges are open; nothing if the vertex lies on the edge of what
  /// moves, or where borders meet, if more than one fan meets there, or a face without an area.
  std::optional<RidgeFan> operator()(std::uint32_t vertex) const;
  /// The angle between the triangles at an edge of a fan; below 0 if the edge is concave, 0 inside of a face.
  double bend(const RidgeFan& fan, std::size_t edge) const;
  /// The bend above which an edge is a ridge.
  double least_bend() const { return least_bend_; }

 private:
  bool walk_around(RidgeFan& fan) const;
  bool is_corner_once(std::uint32_t face, std::uint32_t vertex) const;

  const PreparedMesh& mesh_;
  const Distances& distances_;
  double least_bend_;
  bool at_borders_;
  std::vector<std::uint8_t> is_left_out_;  // of each vertex: a face there has not all of its triangles
};

}  // namespace vdb_offset
