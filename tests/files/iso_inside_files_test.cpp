// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include "products/iso/mend.h"
#include "products/iso/merge_flats.h"
#include "products/iso/solid_boundary.h"
#include "products/iso/specks.h"
#include "space/surface/holes.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

namespace iso_inside_files {
namespace {

Polygons moved(Polygons mesh, const Vec3d& by) {
  for (Vec3d& p : mesh.positions) p += by;
  return mesh;
}

IsoOptions options_of(double distance, double voxel_size) {
  IsoOptions options;
  options.distance = distance;
  options.grid.voxel_size = voxel_size;
  return options;
}

}  // namespace

TEST_CASE("iso: a hollow solid is the source and a cavity, or two clean skins", "[iso]") {
  const Polygons box = shapes::box({1, 1, 1}, 2, false);
  const IsoResult cavity = make_iso_surface(box.view(), options_of(-0.1, 0.05));
  const Hollow inward = make_hollow(box.view(), cavity.polygons.view(), Hollow::Source::Outer);
  CHECK(inward.facts.closed);
  CHECK(inward.facts.oriented);
  CHECK(inward.facts.crossings + inward.facts.source_crossings == 0);
  CHECK(inward.facts.volume == Approx(1 - 0.512).epsilon(1e-6));
  for (std::size_t f = 0; f < box.face_count(); ++f) {
    const auto face = box.view().face(f), kept = inward.polygons.view().face(f);
    CHECK(std::equal(face.begin(), face.end(), kept.begin(), kept.end()));
  }
  const IsoResult skin = make_iso_surface(box.view(), options_of(0.1, 0.05));
  const Hollow outward = make_hollow(skin.polygons.view(), box.view(), Hollow::Source::Inner);
  CHECK(outward.facts.closed);
  CHECK(outward.facts.oriented);
  CHECK(outward.facts.volume == Approx(test::enclosed_volume(skin.polygons) - 1));
  const Hollow both = make_hollow(skin.polygons.view(), cavity.polygons.view(), Hollow::Source::Neither);
  CHECK(both.facts.volume == Approx(test::enclosed_volume(skin.polygons) - 0.512).epsilon(1e-6));
  // A cavity that meets the skin is told.
  CHECK(make_hollow(box.view(), moved(cavity.polygons, {0.15, 0, 0}).view(), Hollow::Source::Outer).facts.crossings >
        0);

  const Folder folder;
  const io::MeshFile source = io::read_mesh(folder.write(
      "box.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0.5 0.25\n"
      "usemtl red\nf 1/1 4/1 3/1 2/1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nusemtl blue\nf 4 1 5 8\n"));
  const IsoResult inside = make_iso_surface(source.polygons.view(), options_of(-0.1, 0.05));
  const Hollow hollow = make_hollow(source.polygons.view(), inside.polygons.view(), Hollow::Source::Outer);
  for (const char* name : {"out.obj", "out.ply", "out.stl", "out.off"}) {
    io::write_hollow(io::target_of(folder.file(name)), &source, hollow, inside);
    const io::MeshFile written = io::read_mesh(folder.file(name));
    CHECK(test::enclosed_volume(written.polygons) == Approx(1 - 0.512).epsilon(1e-6));
    if (std::string(name) == "out.obj") {
      CHECK(written.polygons.positions == hollow.polygons.positions);
      CHECK(written.polygons.corners == hollow.polygons.corners);
      CHECK(io::read_attributes(written).texture.of_corner[0] == 0);
      CHECK(io::read_materials(written).of_face[5] == 1);
    }
  }
}

}  // namespace iso_inside_files
