// SPDX-License-Identifier: Apache-2.0
// Half-edge meshes whose points are moved to their distance.
#include <vdb_offset/openmesh.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>

int main() {
  OpenMesh::TriMesh_ArrayKernelT<> mesh;
  const auto a = mesh.add_vertex({0, 0, 0}), b = mesh.add_vertex({1, 0, 0}), c = mesh.add_vertex({0, 1, 0}),
             d = mesh.add_vertex({0, 0, 1});
  mesh.add_face(a, c, b);
  mesh.add_face(a, b, d);
  mesh.add_face(b, c, d);
  mesh.add_face(c, a, d);
  // The same with points of double precision.
  vdb_offset::Mesh doubles = vdb_offset::to_mesh(vdb_offset::to_polygons(mesh).view());
  vdb_offset::offset(doubles, {.distance = 0.1});
  const auto result = vdb_offset::offset(mesh, {.distance = 0.1});
  // Each coordinate of the corner at the origin goes as far outward.
  const auto& p = mesh.point(a);
  if (std::abs(doubles.point(a)[0] - p[0]) > 1e-6) return 1;
  return result.achieved[0] > 0.0999 && p[0] < -0.05 && p[0] == p[1] && p[1] == p[2] ? 0 : 1;
}
