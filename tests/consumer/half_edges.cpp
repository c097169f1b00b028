// SPDX-License-Identifier: Apache-2.0
// A half-edge mesh whose points are moved to their distance.
#include <vdb_offset/openmesh.h>

int main() {
  vdb_offset::Mesh mesh;
  const auto a = mesh.add_vertex({0, 0, 0}), b = mesh.add_vertex({1, 0, 0}), c = mesh.add_vertex({0, 1, 0}),
             d = mesh.add_vertex({0, 0, 1});
  mesh.add_face(a, c, b);
  mesh.add_face(a, b, d);
  mesh.add_face(b, c, d);
  mesh.add_face(c, a, d);
  const auto result = vdb_offset::offset(mesh, {.distance = 0.1});
  // Each coordinate of the corner at the origin goes as far outward.
  const auto& p = mesh.point(a);
  return result.achieved[0] > 0.0999 && p[0] < -0.05 && p[0] == p[1] && p[1] == p[2] ? 0 : 1;
}
