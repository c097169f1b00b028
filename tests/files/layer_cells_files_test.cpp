// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include "products/cells/make_cells.h"
#include "products/volume/cell_faces.h"
#include "products/volume/cell_quality.h"
#include "products/volume/prism_quality_columns.h"
#include "support/oracles.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace layer_cells_files {

TEST_CASE("layer cells: a file's groups, materials, objects and solids name walls", "[layer_cells]") {
  const std::string triangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto names = [&](const std::string& rest, io::Format format = io::Format::Obj) {
    return io::wall_names(io::parse_mesh("test", format, format == io::Format::Obj ? triangles + rest : rest));
  };
  const WallNames groups = names("f 1 2 3\nusemtl red\ng left wing\nf 1 2 3\ng tail\nf 1 2 3\ng left wing\nf 1 2 3\n");
  CHECK(groups.names == std::vector<std::string>{"wall", "left_wing", "tail"});
  CHECK(groups.of_face == std::vector<std::uint32_t>{0, 1, 2, 1});
  const WallNames materials = names("o car\nusemtl red paint\nf 1 2 3\nusemtl blue\nf 1 2 3\n");
  CHECK(materials.names == std::vector<std::string>{"red paint", "blue"});
  CHECK(names("o car\nf 1 2 3\n").names == std::vector<std::string>{"car"});
  CHECK(names("f 1 2 3\n").names.empty());
  CHECK(names("f 1 2 3\n").of_face.empty());
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const WallNames solids =
      names("solid one\n" + facet + "endsolid one\nsolid two\n" + facet + "endsolid two\n", io::Format::Stl);
  CHECK(solids.names == std::vector<std::string>{"one", "two"});
  CHECK(solids.of_face == std::vector<std::uint32_t>{0, 1});
}

}  // namespace layer_cells_files
