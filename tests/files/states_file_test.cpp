// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/view_file.h"

#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "support/folder.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

vtkSmartPointer<vtkPolyData> read_vtp(const std::string& path) {
  const auto reader = vtkSmartPointer<vtkXMLPolyDataReader>::New();
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

void check_words(vtkPolyData* data, const char* name, const std::vector<std::string>& words) {
  auto* const array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name));
  REQUIRE(array);
  REQUIRE(array->GetNumberOfValues() == static_cast<vtkIdType>(words.size()));
  for (std::size_t i = 0; i < words.size(); ++i) CHECK(array->GetValue(static_cast<vtkIdType>(i)) == words[i]);
}

double value(vtkDataSetAttributes* attributes, const char* name, std::size_t i) {
  vtkDataArray* const array = attributes->GetArray(name);
  REQUIRE(array);
  return array->GetTuple1(static_cast<vtkIdType>(i));
}

OffsetResult offset_of(const Polygons& mesh, double distance, std::vector<std::uint8_t> only = {},
                       std::optional<Corners> corners = {}) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = corners;
  options.only = std::move(only);
  options.keep_face_errors = options.keep_paths = true;
  return offset(mesh.view(), options);
}

}  // namespace

TEST_CASE("states: VTK reads back what a viewer colours by", "[states][vtk]") {
  const Folder folder;
  const Polygons mesh = shapes::box({1, 1, 1}, 3, true);
  const OffsetResult result = offset_of(mesh, 0.1);
  WallNames groups{{"l\u00fcft", "", "with blank"}, {}};
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) groups.of_face.push_back(f % 3);
  const std::string path = folder.file("states.vtp");
  io::write_states(path, {result.positions, mesh.corners, mesh.face_begin},
                   {result.states, result.achieved, result.distances}, {result.face_errors, &groups, false});
  const auto read = read_vtp(path);
  REQUIRE(read->GetNumberOfPoints() == static_cast<vtkIdType>(mesh.positions.size()));
  REQUIRE(read->GetNumberOfPolys() == static_cast<vtkIdType>(mesh.face_count()));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) CHECK(read->GetPoint(static_cast<vtkIdType>(v))[k] == result.positions[v][k]);
    CHECK(value(read->GetPointData(), "state", v) == static_cast<double>(result.states[v]));
    CHECK(value(read->GetPointData(), "achieved", v) == Approx(result.achieved[v]));
    CHECK(value(read->GetPointData(), "target", v) == Approx(0.1));
    CHECK(value(read->GetPointData(), "share", v) == Approx(result.achieved[v] / 0.1));
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto cell = static_cast<vtkIdType>(f);
    REQUIRE(static_cast<std::size_t>(read->GetCell(cell)->GetNumberOfPoints()) == mesh.view().face(f).size());
    for (std::size_t i = 0; i < mesh.view().face(f).size(); ++i)
      CHECK(read->GetCell(cell)->GetPointId(static_cast<int>(i)) == mesh.view().face(f)[i]);
    CHECK(value(read->GetCellData(), "group", f) == static_cast<double>(f % 3));
    CHECK(value(read->GetCellData(), "face_error", f) == result.face_errors[f]);
  }
  check_words(read, "group_words", groups.names);
  check_words(read, "state_words", {"reached", "collision", "limited", "outside_field", "unused", "mitered", "cut"});
}

TEST_CASE("states: curves and paths are lines", "[states][vtk]") {
  const Folder folder;
  const Polygons mesh = shapes::box({1, 1, 1}, 2, true);
  const OffsetResult result = offset_of(mesh, 0.1);
  const io::VertexStates states{result.states, result.achieved, result.distances};
  io::write_path_lines(folder.file("paths.vtp"), result.paths, states);
  const auto lines = read_vtp(folder.file("paths.vtp"));
  REQUIRE(lines->GetNumberOfLines() == static_cast<vtkIdType>(mesh.positions.size()));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    CHECK(value(lines->GetCellData(), "vertex", v) == static_cast<double>(v));
    vtkCell* const line = lines->GetCell(static_cast<vtkIdType>(v));
    REQUIRE(static_cast<std::size_t>(line->GetNumberOfPoints()) == result.paths[v].size());
    for (int k = 0; k < 3; ++k) {
      CHECK(line->GetPoints()->GetPoint(0)[k] == mesh.positions[v][k]);
      CHECK(line->GetPoints()->GetPoint(line->GetNumberOfPoints() - 1)[k] == result.positions[v][k]);
    }
  }
  io::write_states(folder.file("curves.vtp"), mesh.view(), states, {{}, nullptr, true});
  const auto curves = read_vtp(folder.file("curves.vtp"));
  CHECK(curves->GetNumberOfLines() == static_cast<vtkIdType>(mesh.face_count()));
  CHECK(curves->GetNumberOfPolys() == 0);
  CHECK(curves->GetCellData()->GetNumberOfArrays() == 0);
}

TEST_CASE("states: each face's error is that of the report, face by face", "[states]") {
  // Of a box with 3 x 3 pairs of triangles a side, the middle ones are at the distance, and the others, at round
  // corners, are off.
  const Polygons mesh = shapes::box({1, 1, 1}, 3, true);
  const OffsetResult result = offset_of(mesh, 0.1, {}, Corners::Round);
  REQUIRE(result.face_errors.size() == mesh.face_count());
  double sum = 0, area = 0;
  std::size_t exact = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    const auto at = [&](std::size_t i) { return result.positions[face[i]]; };
    const double of_face = (at(1) - at(0)).cross(at(2) - at(0)).length();
    sum += of_face * result.face_errors[f];
    area += of_face;
    exact += result.face_errors[f] < 1e-6 ? 1 : 0;
  }
  CHECK(exact == 12);
  // By four points of each triangle, of which these are few and large.
  CHECK(sum / area == Approx(result.statistics.faces.mean).epsilon(0.15));
  CheckOptions check;
  check.distance = 0.1;
  check.corners = Corners::Round;
  check.keep_face_errors = true;
  const CheckResult found = check_offset(mesh.view(), result.positions, check);
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    CHECK(found.face_errors[f] == Approx(result.face_errors[f]).margin(1e-9));
  std::vector<std::uint8_t> only(mesh.face_count(), 0);
  only[4] = 1;
  const OffsetResult part = offset_of(mesh, 0.1, only);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) CHECK(std::isnan(part.face_errors[f]) == (f != 4));
  CHECK(offset_of(mesh, 0).face_errors.empty());
}

TEST_CASE("states: faults are told face by face", "[states][vtk]") {
  // One corner of a cube goes through the opposite side.
  const Polygons mesh = shapes::box({1, 1, 1}, 2, true);
  std::vector<Vec3d> positions = mesh.positions;
  positions[0] = positions[0] * -3.0;
  CheckOptions check;
  check.distance = 0.1;
  check.keep_face_errors = true;
  const CheckResult found = check_offset(mesh.view(), positions, check);
  REQUIRE(found.face_faults.size() == mesh.face_count());
  std::size_t inverted = 0, crossing = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    const bool has_moved = std::find(face.begin(), face.end(), 0u) != face.end();
    if (found.face_faults[f] == FaceFault::Inverted) CHECK(has_moved);
    inverted += found.face_faults[f] == FaceFault::Inverted ? 1 : 0;
    crossing += found.face_faults[f] == FaceFault::Crossing && !has_moved ? 1 : 0;
  }
  CHECK(inverted == found.faults.inverted);
  CHECK(inverted > 0);
  CHECK(crossing > 0);  // those that it goes through
  CHECK(check_offset(mesh.view(), offset_of(mesh, 0.1).positions, check).face_faults.empty());
  const Folder folder;
  io::write_states(folder.file("states.vtp"), mesh.view(), {found.states, found.achieved, found.distances},
                   {.fault = found.face_faults});
  const auto read = read_vtp(folder.file("states.vtp"));
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    CHECK(value(read->GetCellData(), "fault", f) == static_cast<double>(found.face_faults[f]));
  check_words(read, "fault_words", {"none", "inverted", "collapsed", "crowded", "crossing"});
}
