// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Traits with positions of double precision, which keep the exact distance.
struct MeshTraits : OpenMesh::DefaultTraitsDouble {};

/// A half-edge mesh of double precision; polygons of any size.
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<MeshTraits>;

/// OpenMesh's half-edge meshes: PolyMesh or TriMesh of any kernel and traits, with points of float or double.
template <class M>
concept HalfEdgeMesh = std::derived_from<M, OpenMesh::BaseKernel> && requires(M& mesh, typename M::VertexHandle v) {
  { mesh.point(v)[2] } -> std::convertible_to<double>;
  mesh.set_point(v, typename M::Point());
  mesh.all_faces();
};

namespace detail {
[[noreturn]] VDB_OFFSET_API void refuse_deleted();
[[noreturn]] VDB_OFFSET_API void refuse_face(std::size_t face);
}  // namespace detail

/// Copies a mesh's vertices and faces in the order of their handles.
/// \throw InvalidInput if it has deleted elements: garbage_collection() makes them go
template <HalfEdgeMesh M>
Polygons to_polygons(const M& mesh) {
  Polygons polygons;
  polygons.positions.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.all_vertices()) {
    if (mesh.has_vertex_status() && mesh.status(vertex).deleted()) detail::refuse_deleted();
    const auto& p = mesh.point(vertex);
    polygons.positions.emplace_back(p[0], p[1], p[2]);
  }
  polygons.face_begin.reserve(mesh.n_faces() + 1);
  for (const auto face : mesh.all_faces()) {
    if (mesh.has_face_status() && mesh.status(face).deleted()) detail::refuse_deleted();
    for (auto vertex = mesh.cfv_begin(face); vertex.is_valid(); ++vertex)
      polygons.corners.push_back(static_cast<std::uint32_t>(vertex->idx()));
    polygons.close_face();
  }
  return polygons;
}

/// Makes a half-edge mesh with these vertices and faces, in their order. \pre a TriMesh gets triangles
/// \throw InvalidInput if a face cannot be added to a half-edge mesh (non-manifold or wrongly oriented).
template <HalfEdgeMesh M = Mesh>
M to_mesh(PolygonView polygons) {
  M mesh;
  mesh.reserve(polygons.positions.size(), polygons.corners.size(), polygons.face_count());
  using Scalar = typename M::Scalar;
  for (const Vec3d& p : polygons.positions)
    mesh.add_vertex(typename M::Point(static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])));
  std::vector<typename M::VertexHandle> handles;
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    handles.clear();
    for (const auto v : polygons.face(f)) handles.emplace_back(static_cast<int>(v));
    if (!mesh.add_face(handles).is_valid()) detail::refuse_face(f);
  }
  return mesh;
}

/// Offsets a half-edge mesh by offset() of offset.h, and replaces its points; all properties stay as they are, normals
/// among them. Points of single precision are rounded, and the result is valid as they are rounded.
/// \throw InvalidInput if it has deleted elements; else as that offset()
template <HalfEdgeMesh M>
OffsetResult offset(M& mesh, const OffsetOptions& options) {
  const Polygons polygons = to_polygons(mesh);
  OffsetOptions of_points = options;
  if constexpr (std::is_same_v<typename M::Scalar, float>) of_points.precision.kind = Precision::Kind::Single;
  OffsetResult result = offset(polygons.view(), of_points);
  using Scalar = typename M::Scalar;
  for (const auto vertex : mesh.all_vertices()) {
    const Vec3d& p = result.positions[static_cast<std::size_t>(vertex.idx())];
    mesh.set_point(vertex, {static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])});
  }
  return result;
}

}  // namespace vdb_offset
