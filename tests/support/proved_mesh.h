// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

#include "support/oracles.h"
#include "valid/proof/offset_prover.h"

namespace vdb_offset::test {

/// A mesh, and what a proof needs of it.
struct ProvedMesh {
  explicit ProvedMesh(Polygons polygons) : mesh(std::move(polygons)), surface(local(mesh)), query(surface) {}
  ProvedMesh(const ProvedMesh&) = delete;

  static Surface local(const Polygons& mesh) {
    Surface surface = build_surface(mesh.view(), {});
    to_local_frame(surface, surface.facts.diagonal / 50);
    return surface;
  }
  /// By brute force; `x` in the frame of the surface.
  double distance(const Vec3d& x) const { return brute_force_distance(mesh.view(), x + surface.origin); }
  Proof prove(OffsetTriangle triangle) const {
    for (Vec3d& corner : triangle.corners) corner -= surface.origin;
    return OffsetProver(query)(triangle);
  }

  Polygons mesh;
  Surface surface;
  ClosestQuery query;
};

/// A triangle in world coordinates, with one distance and one tolerance.
inline OffsetTriangle even_triangle(const std::array<Vec3d, 3>& corners, double asked, double tolerance) {
  OffsetTriangle triangle;
  triangle.corners = corners;
  triangle.asked = {asked, asked, asked};
  triangle.tolerance = {tolerance, tolerance, tolerance};
  return triangle;
}

}  // namespace vdb_offset::test
