// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "space/surface/surface.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// What is known of the exact surface at the corners of a Surface's triangles.
class ExactCorners {
 public:
  /// Keeps references to both surfaces. \pre `surface` is of the faces of `mesh` that `only` marks (of all, if it is
  /// empty), and `exact` is of that mesh
  ExactCorners(const ExactSurface& exact, PolygonView mesh, std::span<const std::uint8_t> only, const Surface& surface);

  /// The mesh's face that a triangle is of.
  std::uint32_t face_of(std::uint32_t triangle) const {
    const std::uint32_t f = surface_.face[triangle];
    return marked_.empty() ? f : marked_[f];
  }

  /// Whether the exact normals around a vertex are known; of one at which several of the mesh's vertices meet, they
  /// are not.
  bool knows(std::uint32_t vertex) const { return known_[vertex] != 0; }
  /// Whether pieces of the surface meet at a vertex, at an edge or a corner.
  bool is_sharp(std::uint32_t vertex) const;
  /// The exact normal of a triangle at one of its vertices. \pre knows(vertex)
  const Vec3d& normal(std::uint32_t triangle, std::uint32_t vertex) const;
  /// Whether a point on a triangle, the closest one to the offset of a vertex, is of the surface around the vertex, and
  /// so is nearer than asked only as triangles are flat.
  /// \param distance of the vertex, world units, not 0
  bool is_own(std::uint32_t vertex, const Vec3d& end, double distance, std::uint32_t triangle,
              const Vec3d& point) const;
  double deflection() const { return exact_.deflection(); }

  /// As ExactSurface's, for vertices and points of the Surface.
  void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                          std::span<const double> at_corner, std::span<Vec3d> points) const;

 private:
  void find_known(PolygonView mesh);

  const ExactSurface& exact_;
  const Surface& surface_;
  std::vector<std::uint32_t> marked_;  // faces of the mesh; empty: all
  std::vector<Vec3d> normals_;         // three for each triangle
  std::vector<std::uint8_t> known_;    // of each vertex
};

}  // namespace vdb_offset
