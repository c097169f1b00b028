// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/volume/foam_measures.h"

#include <array>
#include <catch2/catch.hpp>
#include <numbers>

#include "support/volume_meshes.h"
#include "vdb_offset/io/volume_file.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// Hexahedra in a row along x, a unit high and deep; `across` is how far their faces at x = 0, 1, 2 ... are moved in y.
VolumeMesh row_of_cells(const std::vector<double>& across) {
  VolumeMesh mesh;
  const auto cells = static_cast<std::uint32_t>(across.size() - 1);
  for (std::size_t i = 0; i < across.size(); ++i)
    for (const auto& [y, z] : {std::pair(0., 0.), {1., 0.}, {1., 1.}, {0., 1.}})
      mesh.points.emplace_back(double(i), across[i] + y, z);
  BoundaryPatch patch{"all", BoundaryPatch::Kind::Wall, {}, {0}, {}};
  const auto add = [&](const CornerList& face, std::uint32_t c) {
    patch.corners.insert(patch.corners.end(), face.begin(), face.end());
    patch.face_begin.push_back(static_cast<std::uint32_t>(patch.corners.size()));
    patch.cell.push_back(c);
  };
  for (std::uint32_t c = 0; c < cells; ++c) {
    const std::uint32_t a = 4 * c, b = a + 4;
    add_cell(mesh, CellType::Hexahedron, {a, a + 1, a + 2, a + 3, b, b + 1, b + 2, b + 3});
    for (std::uint32_t k = 0; k < 4; ++k) add({a + k, a + (k + 1) % 4, b + (k + 1) % 4, b + k}, c);
  }
  add({0, 3, 2, 1}, 0);
  add({4 * cells, 4 * cells + 1, 4 * cells + 2, 4 * cells + 3}, cells - 1);
  mesh.patches = {patch};
  return mesh;
}

FoamQuality quality_of(const VolumeMesh& mesh) { return measure_foam(mesh, VolumeFaces(mesh)); }

/// The number behind a text.
double number_after(const std::string& output, const std::string& text) {
  const std::size_t at = output.find(text);
  REQUIRE(at != std::string::npos);
  return std::atof(output.c_str() + at + text.size());
}

}  // namespace

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

TEST_CASE("foam cells: non-orthogonality and skewness, by closed forms and by checkMesh", "[foam_cells]") {
  const FoamQuality straight = quality_of(row_of_cells({0, 0, 0}));
  CHECK(straight.wrong_faces == 0);
  CHECK(straight.non_orthogonality == 0);
  CHECK(straight.skewness == Approx(0).margin(1e-14));
  // The far end of the second cell is moved by 2 s: the way between the centres is (1, s, 0), and passes the middle of
  // the face between at s / 2 from it, where the face reaches 1/2 that way.
  const FoamQuality sheared = quality_of(row_of_cells({0, 0, 2}));
  CHECK(sheared.non_orthogonality == Approx(45));
  CHECK(sheared.mean_non_orthogonality == Approx(45));
  CHECK(sheared.non_orthogonal_faces == 0);
  CHECK(sheared.wrong_faces == 0);
  // Worst is the boundary: the far end is 1 wide, and the centre lies 1/2 before it and 1 beside it.
  CHECK(sheared.skewness == Approx(1 / 0.5));
  CHECK(sheared.skew_faces == 0);
  const VolumeMesh steep = row_of_cells({0, 0, 2, 12});
  const FoamQuality beyond = quality_of(steep);
  CHECK(beyond.non_orthogonality == Approx(std::atan(6) * 180 / std::numbers::pi));
  CHECK(beyond.mean_non_orthogonality ==
        Approx(std::acos((std::sqrt(0.5) + 1 / std::sqrt(37)) / 2) * 180 / std::numbers::pi));
  CHECK(beyond.non_orthogonal_faces == 1);
  CHECK(beyond.skewness == Approx(5 / 0.5));
  CHECK(beyond.skew_faces == 1);

  if (!installed("checkMesh")) return;
  const Folder folder;
  const FoamQuality written = *io::write_volume(folder.file("polyMesh"), steep).foam;
  CHECK(written.skewness == beyond.skewness);
  const std::string output = check_mesh_of(folder, "polyMesh");
  INFO(output);
  CHECK(number_after(output, "non-orthogonality Max:") == Approx(beyond.non_orthogonality).epsilon(1e-4));
  CHECK(number_after(output, "average:") == Approx(beyond.mean_non_orthogonality).epsilon(1e-4));
  CHECK(number_after(output, "Max skewness =") == Approx(beyond.skewness).epsilon(1e-4));
}
