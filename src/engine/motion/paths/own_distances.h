// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "space/surface/surface.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The distances of triangles at their corners, where faces have others than the vertices that they share.
class OwnDistances {
 public:
  /// \pre `surface` is of the faces of `mesh` that `only` marks (of all, if it is empty), and there is a number for
  /// each corner of the mesh
  OwnDistances(std::span<const double> at_corner, PolygonView mesh, std::span<const std::uint8_t> only,
               const Surface& surface);
  /// Nothing if the distances have none for corners.
  static std::optional<OwnDistances> of(const Distances& distances, PolygonView mesh,
                                        std::span<const std::uint8_t> only, const Surface& surface);

  /// Whether the triangles around a vertex have different ones there.
  bool differ(std::uint32_t vertex) const { return differ_[vertex] != 0; }
  /// Of a triangle at one of its vertices.
  double at(std::uint32_t triangle, std::uint32_t vertex) const;
  /// Of a triangle at its corner k.
  double at_corner_of(std::uint32_t triangle, std::size_t k) const { return own_[3 * triangle + k]; }
  /// The least around a vertex, without its sign.
  double least(std::uint32_t vertex) const;
  /// Of each corner of the mesh.
  std::span<const double> at_corner() const { return at_corner_; }

 private:
  const Surface& surface_;
  std::span<const double> at_corner_;
  std::vector<double> own_;           // three a triangle
  std::vector<std::uint8_t> differ_;  // of each vertex
};

}  // namespace vdb_offset
