// SPDX-License-Identifier: Apache-2.0
#include <vtkCell.h>
#include <vtkMeshQuality.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include "ground/numbers/rounding.h"
#include "products/volume/cell_quality.h"
#include "support/curve_oracles.h"
#include "support/folder.h"
#include "support/grown_curves.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using Catch::Matchers::Contains;

namespace curve_layers_files {
using namespace vdb_offset::test::grown_curves;

TEST_CASE("curves: layers are the same on any plane, and of both ends of an open curve", "[curves][layers][vtk]") {
  std::vector<Vec3d> points, tilted;
  const Vec3d u = Vec3d(1, 2, -1).unit(), v = u.cross(Vec3d(0, 0, 1)).unit(), origin(3, -2, 5);
  for (int i = 0; i <= 40; ++i) {
    points.emplace_back(i * 0.05, 0.2 * std::sin(i * 0.2), 0);
    tilted.push_back(origin + u * points.back()[0] + v * points.back()[1]);
  }
  const GrownCurves flat = grow(curve_through(points, false), rising(0.1, 4));
  const Curves other = curve_through(tilted, false);
  GrownCurves grown = grow(other, rising(0.1, 4));
  if (std::abs(grown.report.volume - flat.report.volume) > 1e-9)  // the other side of it is to the right
    grown = grow(other, rising(-0.1, 4));
  CHECK(grown.report.volume == Approx(flat.report.volume).epsilon(1e-9));
  check_layers(curve_through(points, false), flat);
  REQUIRE(grown.cells.mesh.patches.size() == 3);
  CHECK(grown.cells.mesh.patches[2].name == "sides");
  CHECK(grown.cells.mesh.patches[2].face_count() == 2 * 4);
  for (std::size_t c = 0; c < grown.cells.mesh.cell_count(); ++c) CHECK(scaled_jacobian(grown.cells.mesh, c) > 0);
  const Folder folder;
  CHECK_THROWS_WITH(io::write_volume(folder.file("a.su2"), grown.cells.mesh), Contains("constant z"));
  CHECK_THROWS_WITH(io::write_volume(folder.file("a.msh"), grown.cells.mesh), Contains(".vtu or .su2"));
  CHECK_NOTHROW(io::write_volume(folder.file("a.vtu"), grown.cells.mesh));
}

TEST_CASE("curve files: layers on real curves", "[.curve_files]") {
  const char* const folder = std::getenv("VDB_OFFSET_CURVES");
  REQUIRE(folder);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Curves curves = io::read_curves(entry.path().string()).file.polygons;
    for (const double percent : {0.5, -0.5, 2.0, -2.0}) {
      CAPTURE(entry.path().filename().string(), percent);
      check_layers(curves, grow(curves, rising(percent / 100 * used_diagonal(curves.view()), 10)));
    }
  }
}

TEST_CASE("curves: cells are read back as VTK's own, and by the numbers of SU2", "[curves][layers][vtk]") {
  const Curves curves = comb(3, 0.2, 0.1);
  const GrownCurves grown = grow(curves, rising(0.15, 3));
  const VolumeMesh& mesh = grown.cells.mesh;
  const Folder folder;
  io::write_volume(folder.file("a.vtu"), mesh);
  const auto reader = vtkSmartPointer<vtkXMLUnstructuredGridReader>::New();
  reader->SetFileName(folder.file("a.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* const grid = reader->GetOutput();
  REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == mesh.cell_count());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    vtkCell* const cell = grid->GetCell(static_cast<vtkIdType>(c));
    const bool quad = mesh.cell_types[c] == CellType::Quadrilateral;
    REQUIRE(cell->GetCellType() == (quad ? VTK_QUAD : VTK_TRIANGLE));
    const double theirs =
        quad ? vtkMeshQuality::QuadScaledJacobian(cell) : vtkMeshQuality::TriangleScaledJacobian(cell);
    CHECK(scaled_jacobian(mesh, c) == Approx(theirs).margin(1e-9));
  }
  io::write_volume(folder.file("a.su2"), mesh);
  std::ifstream text(folder.file("a.su2"));
  std::string word;
  std::size_t dimensions = 0, cells = 0, points = 0;
  text >> word >> dimensions >> word >> cells;
  CHECK(dimensions == 2);
  REQUIRE(cells == mesh.cell_count());
  for (std::size_t c = 0; c < cells; ++c) {
    unsigned type = 0, corner = 0;
    text >> type;
    CHECK(type == (mesh.cell_types[c] == CellType::Quadrilateral ? 9 : 5));
    for (const auto expected : mesh.cell(c)) CHECK((text >> corner && corner == expected));
    CHECK((text >> corner && corner == c));
  }
  text >> word >> points;
  REQUIRE(points == mesh.points.size());
  for (const Vec3d& point : mesh.points) {
    double x = 0, y = 0, number = 0;
    text >> x >> y >> number;
    CHECK((x == point[0] && y == point[1]));
  }
  std::size_t markers = 0;
  CHECK((text >> word >> markers && markers == mesh.patches.size()));
}

}  // namespace curve_layers_files
