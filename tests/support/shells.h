// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include "ground/numbers/index_set.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "valid/faults/rim_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::test::shells {

inline std::vector<Vec3d> raised(std::vector<Vec3d> positions, double by) {
  for (Vec3d& p : positions) p[2] += by;
  return positions;
}

/// Of triangle fans, which the shapes' flat or four-sided faces are split into.
inline double volume(const Polygons& mesh, std::span<const Vec3d> positions) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k)
      sum += positions[face[0]].dot(positions[face[k - 1]].cross(positions[face[k]])) / 6;
  }
  return sum;
}

/// The faces above z = 0 of a shape; the other vertices stay, unused.
inline Polygons upper_half(const Polygons& mesh) {
  Polygons half;
  half.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    double height = 0;
    for (const auto v : face) height += mesh.positions[v][2];
    if (height <= 0) continue;
    half.corners.insert(half.corners.end(), face.begin(), face.end());
    half.close_face();
  }
  return half;
}

inline Shell offset_shell(const Polygons& mesh, double distance) {
  OffsetOptions options;
  options.distance = distance;
  return shell_of(mesh.view(), offset(mesh.view(), options), options);
}

/// Judged by what reads meshes: every edge has two faces, which run through it in both directions and meet nowhere
/// else.
inline void check_solid(const Shell& shell) {
  CHECK(shell.facts.closed);
  CHECK(shell.facts.oriented);
  CHECK(shell.facts.border_edges_left == 0);
  CHECK(shell.facts.non_manifold_edges == 0);
  CHECK(shell.facts.volume > 0);
  const Surface surface = build_surface(shell.polygons.view(), {});
  CHECK(surface.facts.boundary_edges == 0);
  CHECK(surface.facts.non_manifold_edges == 0);
  CHECK(surface.facts.orientation_conflicts == 0);
  CHECK(surface.facts.inside_out_components == 0);
  CHECK(CrossingFinder(surface, surface.vertices).all().empty());
}

/// One face over four corners.
inline Polygons quad() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.add_face({0, 1, 2, 3});
  return mesh;
}

}  // namespace vdb_offset::test::shells
