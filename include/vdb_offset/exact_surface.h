// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The surface that a mesh is a tessellation of, as far as an offset needs it: that of a CAD model. All spans are as
/// long as the mesh asks for.
class VDB_OFFSET_API ExactSurface {
 public:
  ExactSurface() = default;
  ExactSurface(const ExactSurface&) = delete;
  ExactSurface& operator=(const ExactSurface&) = delete;
  virtual ~ExactSurface() = default;

  /// The surface's normal at each corner of each face: of unit length, outward; zero where it has none.
  virtual std::span<const Vec3d> corner_normals() const = 0;
  /// Of each face the piece of the surface that it is of. Pieces end at sharp edges, not at smooth ones.
  virtual std::span<const std::uint32_t> piece_of_face() const = 0;
  /// The most distance between a face and the surface, world units, > 0.
  virtual double deflection() const = 0;
  /// Moves points that are near the offset of vertices to where they are at the vertices' distances from all faces of
  /// the model that these are on, each measured to the face as it goes on beyond its edges; or as near to that as one
  /// point can be.
  /// \param vertices of the mesh
  /// \param distances of each of them, world units; negative is inward
  /// \param at_corner of each corner of the mesh the distance from its face that counts in place of the vertex's; or
  /// empty
  /// \param points of each of them: where to begin, and where it ends
  virtual void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                  std::span<const double> at_corner, std::span<Vec3d> points) const = 0;
  /// Of each point, the most by which its distance from one of these faces is another than the vertex's, or the
  /// corner's, world units.
  virtual std::vector<double> distance_errors(std::span<const std::uint32_t> vertices,
                                              std::span<const double> distances, std::span<const double> at_corner,
                                              std::span<const Vec3d> points) const = 0;
  /// Of each point, by how much its distance from the model's face that a face of the mesh is of is another than asked,
  /// world units.
  /// \param feet points of the mesh's faces, near which the closest ones of the model's are
  virtual std::vector<double> distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d> feet,
                                                   std::span<const double> distances,
                                                   std::span<const Vec3d> points) const = 0;
};

}  // namespace vdb_offset
