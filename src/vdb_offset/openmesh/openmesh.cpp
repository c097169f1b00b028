// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/openmesh.h"

#include "vdb_offset/error.h"
#include "vdb_offset/offset.h"

namespace vdb_offset {

Polygons to_polygons(const Mesh& mesh) {
  Polygons polygons;
  polygons.positions.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.all_vertices()) {
    const auto& p = mesh.point(vertex);
    polygons.positions.emplace_back(p[0], p[1], p[2]);
  }
  polygons.face_begin.reserve(mesh.n_faces() + 1);
  for (const auto face : mesh.all_faces()) {
    for (const auto vertex : mesh.fv_range(face)) polygons.corners.push_back(static_cast<std::uint32_t>(vertex.idx()));
    polygons.close_face();
  }
  return polygons;
}

Mesh to_mesh(PolygonView polygons) {
  Mesh mesh;
  mesh.reserve(polygons.positions.size(), polygons.corners.size(), polygons.face_count());
  for (const Vec3d& p : polygons.positions) mesh.add_vertex({p[0], p[1], p[2]});
  std::vector<Mesh::VertexHandle> handles;
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    handles.clear();
    for (const auto v : polygons.face(f)) handles.emplace_back(static_cast<int>(v));
    if (!mesh.add_face(handles).is_valid())
      throw InvalidInput("mesh: expected a face that a half-edge mesh can hold, got face " + std::to_string(f) +
                         " (non-manifold or oriented against its neighbours; use spans instead)");
  }
  return mesh;
}

OffsetResult offset(Mesh& mesh, const OffsetOptions& options) {
  const Polygons polygons = to_polygons(mesh);
  OffsetResult result = offset(polygons.view(), options);
  for (const auto vertex : mesh.all_vertices()) {
    const Vec3d& p = result.positions[static_cast<std::size_t>(vertex.idx())];
    mesh.set_point(vertex, {p[0], p[1], p[2]});
  }
  return result;
}

}  // namespace vdb_offset
