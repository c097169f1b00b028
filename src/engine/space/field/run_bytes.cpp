// SPDX-License-Identifier: Apache-2.0
#include "space/field/run_bytes.h"

#include <algorithm>

namespace vdb_offset {
namespace {

// Bytes for a triangle and a vertex of a surface, for a vertex of the input, and for a triangle while its result is
// made valid.
constexpr std::size_t kTriangleBytes = 130, kVertexBytes = 260, kInputVertexBytes = 12, kJudgedTriangleBytes = 90;
// Bytes that each further result takes for a vertex: positions, paths, states and what a warm start of a nearer one
// needs; and while it is made valid. And for itself, whatever the mesh.
constexpr std::size_t kResultVertexBytes = 105, kJudgedVertexBytes = 95, kResultBytes = 4500;
// Bytes that a layer takes for a vertex of the surface: its position and that of the cells' point. For a face: what its
// cells have beside corners. And for a vertex of the input, however many layers there are.
constexpr std::size_t kLayerVertexBytes = 24 + 24, kLayerFaceBytes = 1 + 8 + 5 * 4, kLayersInputBytes = 27;
// Bytes of a vertex's path with the file's text.
constexpr std::size_t kPathBytes = 520;
// Bytes of a shell for a vertex of the input and for a triangle.
constexpr std::size_t kShellVertexBytes = 230, kShellTriangleBytes = 120;
// Bytes for a vertex of the input and for a triangle of a mesh whose faces are split.
constexpr std::size_t kRefinedVertexBytes = 250, kRefinedTriangleBytes = 520;
// Bytes of a vertex on an exact surface: a miter, the path that it stands for, and normals of six triangles' corners.
constexpr std::size_t kExactBytes = 500;

}  // namespace

std::size_t surface_bytes(const Surface& surface) {
  return kTriangleBytes * surface.triangles.size() + kVertexBytes * surface.vertices.size() +
         kInputVertexBytes * surface.facts.vertices;
}

std::size_t result_bytes(const Surface& surface) { return kJudgedTriangleBytes * surface.triangles.size(); }

std::size_t further_bytes(std::size_t vertices, std::size_t results) {
  return (results - 1) * (vertices * kResultVertexBytes + kResultBytes) +
         (std::min(results, kResultsTogether) - 1) * vertices * kJudgedVertexBytes;
}

std::size_t layers_bytes(PolygonView mesh, const Surface& surface, std::size_t layers) {
  if (layers == 0) return 0;
  std::size_t cells = mesh.face_count() * kLayerFaceBytes;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t corners = mesh.face(f).size();
    // The cell over a polygon of n > 4 corners is a polyhedron: its faces, a base, a top and n quads, list their
    // corners.
    cells += 4 * (corners > 4 ? 3 + 7 * corners : 2 * corners);
  }
  return kCellModuleBytes + layers * (cells + surface.vertices.size() * kLayerVertexBytes) +
         mesh.positions.size() * kLayersInputBytes;
}

std::size_t paths_bytes(std::size_t vertices, std::size_t results) { return results * vertices * kPathBytes; }

std::size_t shell_bytes(PolygonView mesh, const Surface& surface) {
  return mesh.positions.size() * kShellVertexBytes + surface.triangles.size() * kShellTriangleBytes;
}

std::size_t refinement_bytes(PolygonView mesh, const Surface& surface) {
  return mesh.positions.size() * kRefinedVertexBytes + surface.triangles.size() * kRefinedTriangleBytes;
}

std::size_t exact_bytes(std::size_t vertices) { return vertices * kExactBytes; }

}  // namespace vdb_offset
