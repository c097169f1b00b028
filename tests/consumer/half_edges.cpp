// SPDX-License-Identifier: Apache-2.0
// Half-edge meshes whose points are moved to their distance.
#include <vdb_offset/openmesh.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>

int main() {
  vdb_offset::Mesh mesh;
  const auto a = mesh.add_vertex({0, 0, 0}), b = mesh.add_vertex({1, 0, 0}), c = mesh.add_vertex({0, 1, 0}),
             d = mesh.add_vertex({0, 0, 1});
  mesh.add_face(a, c, b);
  mesh.add_face(a, b, d);
  mesh.add_face(b, c, d);
  mesh.add_face(c, a, d);
  // Single precision, and OpenMesh's own traits.
  auto triangles = vdb_offset::to_mesh<OpenMesh::TriMesh_ArrayKernelT<>>(vdb_offset::to_polygons(mesh).view());
  vdb_offset::offset(triangles, {.distance = 0.1});
  const auto result = vdb_offset::offset(mesh, {.distance = 0.1});
  if (std::abs(triangles.point(triangles.vertex_handle(0))[0] - mesh.point(a)[0]) > 1e-6) return 1;
  // Each coordinate of the corner at the origin goes as far outward.
  const auto& p = mesh.point(a);
  return result.achieved[0] > 0.0999 && p[0] < -0.05 && p[0] == p[1] && p[1] == p[2] ? 0 : 1;
}
