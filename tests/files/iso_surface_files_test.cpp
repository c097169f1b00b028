// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include "ground/numbers/rounding.h"
#include "products/iso/iso_grid.h"
#include "products/iso/mend.h"
#include "products/iso/source_lookup.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace iso_surface_files {
namespace {

IsoResult captured(const Polygons& mesh, double distance, double voxel_size, double adaptivity = 0) {
  IsoOptions options;
  options.distance = distance;
  options.grid.voxel_size = voxel_size;
  options.adaptivity = adaptivity;
  return make_iso_surface(mesh.view(), options);
}

/// A sphere with texture coordinates in two charts that meet at a seam, colours that are its coordinates, and two
/// materials.
std::string textured_sphere() {
  const Polygons sphere = shapes::uv_sphere(1, 12, 8);
  std::string text = "mtllib some.mtl\n", faces[2];
  for (const Vec3d& p : sphere.positions) {
    text += "v";
    for (int k = 0; k < 3; ++k) text += " " + std::to_string(p[k]);
    for (int k = 0; k < 3; ++k) text += " " + std::to_string(0.5 + p[k] / 2.000001);
    text += "\n";
  }
  std::size_t coordinates = 0;
  for (std::size_t f = 0; f < sphere.face_count(); ++f) {
    double height = 0;
    for (const auto v : sphere.view().face(f)) height += sphere.positions[v][0];
    std::string& to = faces[height > 0];
    to += "f";
    for (const auto v : sphere.view().face(f)) {
      const Vec3d& p = sphere.positions[v];
      text += "vt " + std::to_string(p[1] + (height > 0 ? 10 : 0)) + " " + std::to_string(p[2]) + "\n";
      to += " " + std::to_string(v + 1) + "/" + std::to_string(++coordinates);
    }
    to += "\n";
  }
  return text + "usemtl left\n" + faces[0] + "usemtl right\n" + faces[1];
}

}  // namespace

TEST_CASE("transport: texture, colours and materials are those of the closest points", "[capture]") {
  const Folder folder;
  const io::MeshFile source = io::read_mesh(folder.write("sphere.obj", textured_sphere()));
  const IsoResult result = captured(source.polygons, 0.1, 0.1);
  const io::Transported transported = io::read_transported(source, {}, io::Format::Obj);
  io::write_iso_surface(io::target_of(folder.file("out.obj")), source, transported, result);
  const io::MeshFile written = io::read_mesh(folder.file("out.obj"));
  const Polygons& mesh = written.polygons;
  const io::Attributes with = io::read_attributes(written);
  const io::Materials materials = io::read_materials(written);
  REQUIRE(with.texture.of_corner.size() == mesh.corners.size());
  REQUIRE(with.colours.size() == mesh.positions.size());
  REQUIRE(with.normals.value.size() == mesh.positions.size());
  REQUIRE(materials.names == std::vector<std::string>{"left", "right"});
  CHECK(materials.libraries == std::vector<std::string>{"some.mtl"});
  CHECK(mesh.positions == result.polygons.positions);

  // The values are linear in the position, on every face; so those at the closest point are those of its position.
  Surface surface = build_surface(source.polygons.view(), {});
  to_local_frame(surface, 0.1);
  const auto closest_to = [&](const Vec3d& x) {
    TrianglePoint best = surface.closest_on(0, x - surface.origin);
    std::uint32_t face = surface.face[0];
    for (std::uint32_t t = 1; t < surface.triangles.size(); ++t)
      if (const TrianglePoint p = surface.closest_on(t, x - surface.origin); p.squared_distance < best.squared_distance)
        best = p, face = surface.face[t];
    return std::pair(best.point + surface.origin, face);
  };
  double worst = 0, worst_colour = 0;
  std::size_t across = 0, wrong_material = 0, right = 0;
  for (std::size_t t = 0; t < mesh.face_count(); ++t) {
    const auto face = mesh.view().face(t);
    const Vec3d centre = (mesh.positions[face[0]] + mesh.positions[face[1]] + mesh.positions[face[2]]) / 3.0;
    const bool is_right = materials.of_face[t] == 1;
    right += is_right;
    const Vec3d home = closest_to(centre).first;
    if (std::abs(home[0]) > 1e-6) wrong_material += is_right != (home[0] > 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const openvdb::math::Vec2d uv = with.texture.value[with.texture.of_corner[3 * t + k]];
      const Vec3d at = closest_to(mesh.positions[face[k]]).first;
      CHECK((uv[0] > 5) == is_right);  // one chart for all corners, that of the material
      if ((at[0] > 0) != is_right) {
        ++across;
        continue;
      }
      worst = std::max({worst, std::abs(uv[0] - (is_right ? 10 : 0) - at[1]), std::abs(uv[1] - at[2])});
    }
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d at = closest_to(mesh.positions[v]).first;
    for (int k = 0; k < 3; ++k)
      worst_colour = std::max(worst_colour, std::abs(with.colours[v][static_cast<std::size_t>(k)] - 0.5 - at[k] / 2));
  }
  CHECK(worst < 2e-6);  // the source has six decimals
  CHECK(worst_colour < 2e-6);
  CHECK(wrong_material == 0);
  CHECK(right > mesh.face_count() / 3);
  CHECK(across > 0);  // corners beyond the seam of their triangle's chart
  CHECK(across < mesh.corners.size() / 10);
}

TEST_CASE("transport: what is asked for must be there and have a place", "[capture]") {
  const Folder folder;
  const io::MeshFile textured = io::read_mesh(folder.write("sphere.obj", textured_sphere()));
  const io::MeshFile plain = io::read_mesh(folder.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  CHECK_THROWS_AS(io::read_transported(plain, {true, false, false, true}, io::Format::Obj), InvalidOption);
  CHECK_THROWS_AS(io::read_transported(textured, {false, false, true, true}, io::Format::Ply), InvalidOption);
  CHECK_THROWS_AS(io::read_transported(textured, {true, false, false, true}, io::Format::Stl), InvalidOption);
  const io::Transported only_colours = io::read_transported(textured, {false, true, false, true}, io::Format::Ply);
  CHECK(only_colours.attributes.texture.empty());
  CHECK(!only_colours.attributes.colours.empty());
  CHECK(only_colours.materials.of_face.empty());
}

}  // namespace iso_surface_files
