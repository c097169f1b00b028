// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include "space/sheets/sheet_sides.h"
#include "support/folder.h"
#include "support/rooms.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

namespace shell_junctions_files {
using namespace vdb_offset::test::rooms;

TEST_CASE("shell: of a part and of walls, in every format", "[shell]") {
  const Folder folder;
  const std::string obj =
      "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\ng lid\nf 5 6 7 8\ng side\n"
      "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\ng bottom\nf 1 4 3 2\n";
  io::write_mesh(folder.file("walls.obj"), walls(four_rooms()).view());
  for (const std::string from : {"obj", "ply", "off", "stl"})
    for (const bool part : {true, false}) {
      INFO(from << ", " << part);
      const io::MeshFile first =
          part ? io::parse_mesh("a.obj", io::Format::Obj, obj) : io::read_mesh(folder.file("walls.obj"));
      io::write_mesh(folder.file("source." + from), first.polygons.view());
      const io::MeshFile source = io::read_mesh(folder.file("source." + from));
      std::vector<std::uint8_t> only;
      if (part) {
        only.assign(source.polygons.face_count(), 1);
        only[0] = 0;
        if (from == "stl") only[1] = 0;
      }
      const Made made = made_of(source.polygons, part ? -0.25 : 0.5, only);
      check_one_solid(made.shell);
      for (const std::string to : {"obj", "ply", "off", "stl"}) {
        io::write_shell(folder.file("shell." + to), source, made.shell);
        const io::MeshFile back = io::read_mesh(folder.file("shell." + to));
        const MeshFacts facts = build_surface(back.polygons.view(), {}).facts;
        CHECK(facts.closed());
        CHECK(facts.oriented());
        CHECK(facts.orientation_conflicts == 0);
        if (to == "stl") continue;
        CHECK(back.polygons.corners == made.shell.polygons.corners);
        CHECK(back.polygons.face_begin == made.shell.polygons.face_begin);
      }
      if (from == "obj" && part) {
        io::write_shell(folder.file("cup.obj"), first, made_of(first.polygons, -0.25, only).shell);
        const std::string text = slurp(folder.file("cup.obj"));
        CHECK_THAT(text, Catch::Contains("g outer lid\ng outer side\nf 1 2 6 5\n") && Catch::Contains("\ng rim\n"));
        CHECK_THAT(text, !Catch::Contains("f 5 6 7 8"));
      }
    }
}

}  // namespace shell_junctions_files
