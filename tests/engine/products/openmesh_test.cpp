// SPDX-License-Identifier: Apache-2.0
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "vdb_offset/openmesh.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

struct FloatTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using PolyDouble = Mesh;
using PolyFloat = OpenMesh::PolyMesh_ArrayKernelT<FloatTraits>;
using TriDouble = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;
using TriFloat = OpenMesh::TriMesh_ArrayKernelT<FloatTraits>;

template <class M>
Vec3d point_of(const M& mesh, typename M::VertexHandle v) {
  const auto& p = mesh.point(v);
  return Vec3d(p[0], p[1], p[2]);
}

/// What rounding to a mesh's scalars may do to coordinates near 1.
template <class M>
constexpr double kPointRounding = std::is_same_v<typename M::Scalar, float> ? 2e-7 : 1e-12;

}  // namespace

TEMPLATE_TEST_CASE("OpenMesh: vertices of a sphere go to another one, and nothing else changes", "[offset]", PolyDouble,
                   PolyFloat, TriDouble, TriFloat) {
  const Polygons sphere = shapes::icosphere(1, 4);
  auto mesh = to_mesh<TestType>(sphere.view());
  OpenMesh::VPropHandleT<int> number;
  OpenMesh::FPropHandleT<std::string> name;
  mesh.add_property(number, "number");
  mesh.add_property(name, "name");
  for (const auto v : mesh.vertices()) mesh.property(number, v) = 3 * v.idx();
  for (const auto f : mesh.faces()) mesh.property(name, f) = std::to_string(f.idx());
  mesh.request_vertex_normals();
  for (const auto v : mesh.vertices()) mesh.set_normal(v, typename TestType::Normal(0, 0, 1));
  const double distance = GENERATE(0.2, -0.3);
  const OffsetResult result = offset(mesh, {.distance = distance});
  CHECK(std::count(result.states.begin(), result.states.end(), VertexState::Reached) ==
        static_cast<std::ptrdiff_t>(result.states.size()));
  for (const auto v : mesh.vertices()) {
    const auto i = static_cast<std::size_t>(v.idx());
    // The closest point of a vertex's own position is a vertex, and its faces hang a little below the sphere.
    CHECK((point_of(mesh, v) - sphere.positions[i] * (1 + distance)).length() < 0.001);
    CHECK((point_of(mesh, v) - result.positions[i]).length() <= kPointRounding<TestType>);
    CHECK(mesh.property(number, v) == 3 * v.idx());
    CHECK(mesh.normal(v)[2] == 1);
  }
  for (const auto f : mesh.faces()) CHECK(mesh.property(name, f) == std::to_string(f.idx()));
  const Polygons after = to_polygons(mesh);
  CHECK(after.corners == sphere.corners);
  CHECK(after.face_begin == sphere.face_begin);
}

TEMPLATE_TEST_CASE("OpenMesh: corners of a cube go along its diagonals", "[offset]", PolyDouble, PolyFloat, TriDouble,
                   TriFloat) {
  const bool has_triangles = std::derived_from<TestType, OpenMesh::TriConnectivity>;
  const Polygons cube = shapes::box(Vec3d(1), 1, has_triangles);
  auto mesh = to_mesh<TestType>(cube.view());
  REQUIRE(mesh.n_vertices() == 8);
  REQUIRE(mesh.n_faces() == (has_triangles ? 12 : 6));
  offset(mesh, {.distance = 0.1, .corners = Corners::Round});
  for (const auto v : mesh.vertices())
    for (int k = 0; k < 3; ++k)
      CHECK(std::abs(point_of(mesh, v)[k]) == Approx(0.5 + 0.1 / std::sqrt(3.0)).margin(kPointRounding<TestType>));
  // By miters, as by default, each of its planes is at the distance.
  mesh = to_mesh<TestType>(cube.view());
  offset(mesh, {.distance = 0.1});
  for (const auto v : mesh.vertices())
    for (int k = 0; k < 3; ++k) CHECK(std::abs(point_of(mesh, v)[k]) == Approx(0.6).margin(kPointRounding<TestType>));
}

TEST_CASE("OpenMesh: deleted elements are refused until they are gone", "[offset]") {
  const Polygons sphere = shapes::icosphere(1, 2);
  auto mesh = to_mesh<PolyFloat>(sphere.view());
  mesh.request_edge_status();
  mesh.request_halfedge_status();
  mesh.delete_face(mesh.face_handle(3), true);
  CHECK_THROWS_AS(offset(mesh, {.distance = 0.1}), InvalidInput);
  mesh.garbage_collection();
  CHECK(offset(mesh, {.distance = 0.1}).positions.size() == mesh.n_vertices());
}
