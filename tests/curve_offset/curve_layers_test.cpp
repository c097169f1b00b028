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

#include "support/curve_oracles.h"
#include "support/folder.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/layer_cells.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/volume/cell_quality.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using Catch::Matchers::Contains;

namespace {

struct GrownCurves {
  LayersResult layers;
  CurveCells cells;
  LayerReport report;
};

GrownCurves grow(const Curves& curves, std::vector<Distances> heights) {
  GrownCurves grown;
  grown.layers = grow_curve_layers(curves.view(), heights, {});
  grown.cells = make_curve_cells(curves.view(), grown.layers);
  grown.report = report_layers(grown.cells.segments.view(), grown.layers, {}, grown.cells.facts,
                               measure_curve_cells(grown.cells, grown.layers));
  return grown;
}

std::vector<Distances> rising(double total, int count) {
  std::vector<Distances> heights;
  for (int k = 1; k <= count; ++k) heights.emplace_back(total * k * (k + 1) / (count * (count + 1)));
  return heights;
}

/// Twice the area of a closed polygon.
double twice_area(const std::vector<Vec3d>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

/// What the report says is so by brute force: heights are exact by their shares, all cells turn the right way and fill
/// what the boundary encloses, and the boundary does not cross itself unless the curves do.
void check_layers(const Curves& curves, const GrownCurves& grown) {
  const LayersResult& layers = grown.layers;
  const double rounding = 1e-12 * layers.statistics.facts.diagonal;
  for (std::size_t p = 0; p < curves.positions.size(); ++p)
    for (std::size_t k = 0; k < layers.count(); ++k) {
      const double target = layers.share[p] * std::abs(layers.heights[k][p]);
      if (layers.share[p] < 1 && k + 1 == layers.count()) continue;  // may have come to rest a little beside
      CHECK(distance_to(curves, layers.stacks.of(p)[k + 1]) == Approx(target).epsilon(1e-6).margin(rounding));
    }
  const VolumeMesh& mesh = grown.cells.mesh;
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    CHECK(scaled_jacobian(mesh, c) > 0);
    sum += cell_volume(mesh, c);
  }
  CHECK(sum == Approx(grown.report.volume).epsilon(1e-9));
  CHECK(grown.report.all.inverted_cells == 0);
  CHECK(layers.statistics.limit.left.total() == 0);
  if (!meeting(curves, curves.positions).empty()) return;
  CHECK(new_crossings(curves, layers.stacks.surface(layers.count())) == 0);
  Curves boundary;
  boundary.positions = mesh.points;
  for (const BoundaryPatch& patch : mesh.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f) boundary.add_face({patch.face(f)[0], patch.face(f)[1]});
  CHECK(meeting(boundary, boundary.positions).empty());
}

}  // namespace

TEST_CASE("curves: layers around a circle are exact, whole and of the area in between", "[curves][layers]") {
  const int n = 64;
  Curves circle = star(n, [](double) { return 1.0; });
  for (const double total : {0.2, -0.2}) {
    const GrownCurves grown = grow(circle, rising(total, 5));
    check_layers(circle, grown);
    CHECK(grown.report.all.coverage == Approx(1));
    CHECK(grown.report.all.cells_by_type[static_cast<std::size_t>(CellType::Quadrilateral)] == 5 * n);
    CHECK(grown.report.points == 6 * n);
    const std::vector<Vec3d> wall = grown.layers.stacks.surface(0), outer = grown.layers.stacks.surface(5);
    CHECK(grown.report.volume == Approx(std::abs(twice_area(outer) - twice_area(wall)) / 2));
    CHECK(grown.cells.mesh.patches.size() == 2);
    CHECK(grown.report.all.wall_angle.most < 1e-4);
    // A mesh of quadrilaterals only, as a block: cut open, and right-handed.
    const StructuredBlock block = make_curve_block(circle.view(), grown.layers);
    REQUIRE(block.ni == n + 1);
    REQUIRE(block.nj == 6);
    CHECK(block.nk == 1);
    CHECK(block.points[0] == block.points[n]);
    for (std::size_t j = 0; j + 1 < block.nj; ++j)
      for (std::size_t i = 0; i + 1 < block.ni; ++i) {
        const Vec3d& x = block.points[j * block.ni + i];
        CHECK((block.points[j * block.ni + i + 1] - x).cross(block.points[(j + 1) * block.ni + i] - x)[2] > 0);
      }
  }
}

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

TEST_CASE("curves: where there is no room layers get thin, and stay valid", "[curves][layers]") {
  const auto wavy = [](double a) { return 1 + 0.3 * std::cos(7 * a); };
  struct Case {
    const char* name;
    Curves curves;
    double total, least_coverage;
  };
  Curves eight = curve_through({{-1, -1, 0}, {0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {0, 0, 0}, {-1, 1, 0}}, true);
  const std::vector<Case> cases = {{"star, outward", star(200, wavy), 0.2, 1},
                                   {"star, inward", star(200, wavy), -0.3, 0.7},
                                   {"star, far inward", star(200, wavy), -2, 0},
                                   {"comb, narrow slits", comb(4, 0.2, 0.05), 0.15, 0.5},
                                   {"comb, wide slits", comb(4, 0.5, 0.05), 0.15, 0.9},
                                   {"comb, inward", comb(4, 0.3, 0.04), -0.1, 0.8},
                                   {"eight", eight, 0.2, 0},
                                   {"eight, inward", eight, -0.2, 0}};
  for (const Case& c : cases) {
    INFO(c.name);
    const GrownCurves grown = grow(c.curves, rising(c.total, 6));
    check_layers(c.curves, grown);
    CHECK(grown.report.all.coverage >= c.least_coverage);
  }
}

TEST_CASE("curves: distances of layers are those of the curves as written", "[curves][layers]") {
  const Curves curves = star(60, [](double) { return 1.0; });
  OffsetOptions options;
  options.precision = {.kind = Precision::Kind::Digits, .digits = 3};
  const LayersResult layers = grow_curve_layers(curves.view(), rising(0.1, 3), options);
  double most_off = 0;
  for (std::size_t p = 0; p < curves.positions.size(); ++p) {
    const auto positions = layers.stacks.of(p);
    CHECK(positions[0] == curves.positions[p]);
    for (const std::size_t k : {1, 2, 3})
      CHECK((positions[k] - Rounding(options.precision)(positions[k])).length() < 1e-15);
    CHECK(layers.first_achieved[p] == Approx(distance_to(curves, positions[1])).epsilon(1e-9));
    CHECK(layers.achieved[p] == Approx(distance_to(curves, positions[3])).epsilon(1e-9));
    most_off = std::max(most_off, std::abs(layers.first_achieved[p] - 0.1 / 6) * 60);
  }
  CHECK(most_off > 1e-3);  // three digits are few
}

TEST_CASE("curves: layers do not depend on the number of threads", "[curves][layers]") {
  const Curves curves = comb(4, 0.3, 0.02);
  const std::vector<Distances> heights = rising(-0.4, 6);
  OffsetOptions options;
  options.threads = 1;
  const LayersResult one = grow_curve_layers(curves.view(), heights, options);
  CHECK(one.layer_statistics.thinned_vertices > 0);
  CHECK(one.statistics.limit.limited_vertices ==
        static_cast<std::size_t>(std::count(one.states.begin(), one.states.end(), VertexState::Limited)));
  options.threads = 4;
  const LayersResult four = grow_curve_layers(curves.view(), heights, options);
  for (std::size_t k = 0; k <= one.count(); ++k) CHECK(one.stacks.surface(k) == four.stacks.surface(k));
  CHECK(one.share == four.share);
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
