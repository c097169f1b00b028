// SPDX-License-Identifier: Apache-2.0
#include "products/volume/foam_measures.h"

#include <array>
#include <catch2/catch.hpp>
#include <numbers>

#include "support/cell_rows.h"
#include "support/volume_meshes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using namespace vdb_offset::test::cell_rows;

TEST_CASE("foam cells: areas and centres of faces and cells, by closed forms", "[foam_cells]") {
  VolumeMesh mesh;
  // An L of area 3: squares around (0.5, 0.5), (1.5, 0.5) and (0.5, 1.5).
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  const FoamFace concave = foam_face(mesh, CornerList{0, 1, 2, 3, 4, 5});
  CHECK((concave.area - Vec3d(0, 0, 3)).length() < 1e-14);
  // OpenFOAM weights triangles by their areas without signs. None is turned round here, seen from the mean (1, 1):
  // that lies on a corner.
  CHECK((concave.centre - Vec3d(2.5 / 3, 2.5 / 3, 0)).length() < 1e-14);
  const FoamFace triangle = foam_face(mesh, CornerList{0, 1, 5});
  CHECK((triangle.area - Vec3d(0, 0, 2)).length() < 1e-14);
  CHECK((triangle.centre - Vec3d(2 / 3., 2 / 3., 0)).length() < 1e-14);

  const VolumeMesh mixed = mixed_cells();
  for (std::size_t c = 0; c < mixed.cell_count(); ++c) {
    INFO(name(mixed.cell_types[c]));
    // The cells are convex: their centroids, by pyramids from the first corner.
    const Vec3d apex = mixed.points[mixed.cell(c)[0]];
    Vec3d sum(0.0);
    double volumes = 0;
    for (const CornerList& corners : faces_of(mixed.cell_types[c], mixed.cell(c))) {
      const FoamFace face = foam_face(mixed, corners);
      const double volume = face.area.dot(face.centre - apex) / 3;
      sum += volume * (0.75 * face.centre + 0.25 * apex);
      volumes += volume;
    }
    CHECK((foam_centre(mixed, c) - sum / volumes).length() < 1e-12);
    CHECK(has_foam_pyramids(mixed, c));
  }
}

TEST_CASE("foam cells: a face that the centre does not see from inside", "[foam_cells]") {
  // A prism over an arrow whose tip is so thin that the centre lies outside, behind its notch.
  const auto arrow = [](double notch) {
    VolumeMesh mesh;
    for (const double z : {0., 1.})
      for (const auto& [x, y] : {std::pair(0., 0.), {1., notch}, {2., 0.}, {1., 1.}}) mesh.points.emplace_back(x, y, z);
    add_cell(mesh, CellType::Polyhedron,
             {6, 4, 3, 2, 1, 0, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7});
    return mesh;
  };
  CHECK(has_foam_pyramids(arrow(0), 0));
  CHECK(has_foam_pyramids(arrow(0.4), 0));
  // The planes of the notch's sides pass above the centre, which lies at 0.43.
  CHECK_FALSE(has_foam_pyramids(arrow(0.6), 0));
  // Inside out.
  VolumeMesh turned = row_of_cells({0, 0});
  for (Vec3d& p : turned.points) p[0] = -p[0];
  CHECK_FALSE(has_foam_pyramids(turned, 0));
  CHECK(quality_of(turned).wrong_faces == 6);
}
