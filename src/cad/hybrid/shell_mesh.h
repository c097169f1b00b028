// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <span>
#include <unordered_map>
#include <vector>

#include "read/body_shape.h"
#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {

/// A triangle of a shell, counter-clockwise from outside.
struct ShellTriangle {
  std::array<std::uint32_t, 3> vertices;
  std::array<std::uint32_t, 3> nodes;  ///< Equal where triangles of a face share a corner in (u, v) as well.
  std::array<gp_Pnt2d, 3> origin;      ///< (u, v) in the source.
  int face = 0;                        ///< As TopExp_Explorer meets the shell's faces.
};

/// What of the source's edge an edge of triangles is, with the parameters at the lower vertex and at the other.
struct SourceEdge {
  int edge = -1;  ///< As TopExp::MapShapes numbers the shell's edges, from 0; -1: it is within a face.
  double lower = 0, upper = 0;
};

/// The offset mesh of a shell, in millimetres.
struct ShellMesh {
  std::vector<gp_Pnt> points;
  std::vector<ShellTriangle> triangles;
  std::unordered_map<std::uint64_t, SourceEdge> edges;  ///< By BodyMesh::key() of their vertices.

  SourceEdge edge(std::uint32_t a, std::uint32_t b) const {
    const auto found = edges.find(BodyMesh::key(a, b));
    return found == edges.end() ? SourceEdge{} : found->second;
  }
};

/// The offset mesh of each shell of a body, in the order of its shape's.
/// \param shape of the body, in the file's unit \param positions of all vertices of the tessellation, in that unit
/// \param millimetres how many that unit is
std::vector<ShellMesh> shell_meshes(const Body& body, const BodyShape& shape, const BodyMesh& mesh,
                                    std::span<const Vec3d> positions, double millimetres);

}  // namespace vdb_offset::cad
