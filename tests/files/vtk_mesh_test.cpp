// SPDX-License-Identifier: Apache-2.0
// Surfaces in VTK's formats: what is written is read by VTK itself.
//
// Files of other programs that were tried, and are not here: .vtk and .vtp of OpenFOAM 1912's surfaceConvert (values of
// attributes in single quotes, legacy version 2.0 in ASCII), .vtk of Gmsh 4.8 (an unstructured grid with points and
// lines among its cells), .vtk and .vtu of meshio 5.0 (legacy version 5.1 in binary and ASCII; zlib, base64, big
// blocks).
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkPolyDataWriter.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "bytes/chunked_output.h"
#include "document/convert.h"
#include "ground/numbers/rounding.h"
#include "support/folder.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

template <class Array>
vtkSmartPointer<Array> named_array(const char* name, int components, vtkIdType tuples) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  for (vtkIdType i = 0; i < tuples; ++i)
    for (int k = 0; k < components; ++k)
      array->SetComponent(i, k, std::fmod(0.37 * static_cast<double>(i) + k, 1.0) * 100);
  return array;
}

/// A tetrahedron of odd coordinates with a point and a line beside it, normals, colours and arrays of all kinds.
vtkSmartPointer<vtkPolyData> tetrahedron(int type) {
  auto data = vtkSmartPointer<vtkPolyData>::New();
  auto points = vtkSmartPointer<vtkPoints>::Take(vtkPoints::New(type));
  for (const Vec3d& p : {Vec3d(0, 0, 0.1), Vec3d(1.0 / 3, 0, 0), Vec3d(0, 1e-3 / 7, 2), Vec3d(0.7, 5.0 / 9, 0)})
    points->InsertNextPoint(p[0], p[1], p[2]);
  data->SetPoints(points);
  auto polygons = vtkSmartPointer<vtkCellArray>::New(), verts = vtkSmartPointer<vtkCellArray>::New(),
       lines = vtkSmartPointer<vtkCellArray>::New();
  for (const auto& face : {std::vector<vtkIdType>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    polygons->InsertNextCell(3, face.data());
  const vtkIdType line[] = {3, 0};
  verts->InsertNextCell(1, line);
  lines->InsertNextCell(2, line);
  data->SetVerts(verts);
  data->SetLines(lines);
  data->SetPolys(polygons);
  data->GetPointData()->SetNormals(named_array<vtkFloatArray>("Normals", 3, 4));
  data->GetPointData()->AddArray(named_array<vtkDoubleArray>("thickness", 1, 4));
  data->GetPointData()->AddArray(named_array<vtkUnsignedCharArray>("RGB", 3, 4));
  data->GetCellData()->AddArray(named_array<vtkIntArray>("part", 1, 6));
  auto note = vtkSmartPointer<vtkStringArray>::New();
  note->SetName("note");
  note->InsertNextValue("<as it was> & so on");
  data->GetFieldData()->AddArray(note);
  return data;
}

/// Runs a writer as it is set up by `set`.
template <class Writer, class Set>
std::string written(vtkDataObject* data, Set&& set) {
  auto writer = vtkSmartPointer<Writer>::New();
  writer->SetInputDataObject(data);
  set(*writer);
  writer->SetWriteToOutputString(true);
  writer->Write();
  if constexpr (requires { writer->GetOutputStdString(); }) return writer->GetOutputStdString();
  else return writer->GetOutputString();
}

template <class Reader>
vtkSmartPointer<vtkPointSet> read_xml(const std::string& bytes) {
  auto reader = vtkSmartPointer<Reader>::New();
  reader->ReadFromInputStringOn();
  reader->SetInputString(bytes);
  reader->Update();
  return reader->GetOutput();
}

template <class Reader>
vtkSmartPointer<vtkPointSet> read_legacy(const std::string& bytes) {
  auto reader = vtkSmartPointer<Reader>::New();
  reader->ReadFromInputStringOn();
  reader->SetBinaryInputString(bytes.data(), static_cast<int>(bytes.size()));
  reader->Update();
  return reader->GetOutput();
}

vtkSmartPointer<vtkPointSet> read_back(io::Format format, bool grid, const std::string& bytes) {
  if (format == io::Format::Vtp) return read_xml<vtkXMLPolyDataReader>(bytes);
  if (format == io::Format::Vtu) return read_xml<vtkXMLUnstructuredGridReader>(bytes);
  return grid ? read_legacy<vtkUnstructuredGridReader>(bytes) : read_legacy<vtkPolyDataReader>(bytes);
}

void check_fields(vtkFieldData* was, vtkFieldData* is) {
  REQUIRE(is->GetNumberOfArrays() == was->GetNumberOfArrays());
  for (int i = 0; i < was->GetNumberOfArrays(); ++i) {
    vtkAbstractArray* const before = was->GetAbstractArray(i);
    const std::string name = before->GetName();
    INFO(name);
    vtkAbstractArray* const after = is->GetAbstractArray(name.c_str());
    REQUIRE(after);
    REQUIRE(after->GetDataType() == before->GetDataType());
    REQUIRE(after->GetNumberOfValues() == before->GetNumberOfValues());
    if (name == "Normals") continue;
    for (vtkIdType v = 0; v < before->GetNumberOfValues(); ++v)
      REQUIRE(after->GetVariantValue(v).ToString() == before->GetVariantValue(v).ToString());
  }
}

/// Requires that a file keeps its bytes where nothing moves, and all but points and normals where something does.
void check_file(io::Format format, const std::string& bytes, const std::string& storage) {
  const io::MeshFile file = io::parse_mesh("a", format, bytes);
  CHECK(file.polygons.face_count() == 4);
  CHECK(file.polygons.corners == std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3});
  CHECK(io::patched_bytes(file, file.polygons.positions) == bytes);

  std::vector<Vec3d> moved = file.polygons.positions;
  for (std::size_t v = 0; v < 3; ++v) moved[v] = Rounding(file.precision)(moved[v] + Vec3d(0.1, -1.0 / 3, 1e-7));
  const std::string after = io::patched_bytes(file, moved);
  CHECK(after.find(storage) != std::string::npos);
  const io::MeshFile back = io::parse_mesh("b", format, after);
  CHECK(back.polygons.positions == moved);
  const bool grid = bytes.find("UNSTRUCTURED") != std::string::npos;
  const auto before_data = read_back(format, grid, bytes), after_data = read_back(format, grid, after);
  REQUIRE(after_data->GetNumberOfCells() == before_data->GetNumberOfCells());
  check_fields(before_data->GetPointData(), after_data->GetPointData());
  check_fields(before_data->GetCellData(), after_data->GetCellData());
  check_fields(before_data->GetFieldData(), after_data->GetFieldData());
  // The normal of a face at vertex 3, which did not move but lies in faces that did, is that of what is written.
  const io::CornerValues<Vec3d> normals = io::read_attributes(back).normals;
  REQUIRE(normals.value.size() == 4);
  for (const Vec3d& normal : normals.value) CHECK(normal.length() == Approx(1).epsilon(1e-6));
}

io::MeshFile parsed(io::Format format, const std::string& text) { return io::parse_mesh("file", format, text); }

const std::string kLegacy = "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\n";

}  // namespace

TEST_CASE("VTK meshes: XML of polygons keeps its storage and all that it holds", "[vtk][documents]") {
  for (const int type : {VTK_FLOAT, VTK_DOUBLE}) {
    const auto data = tetrahedron(type);
    const auto xml = [&](auto&& set) { return written<vtkXMLPolyDataWriter>(data, set); };
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetDataModeToAscii(); }), "format=\"ascii\"");
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetDataModeToBinary(); }), "format=\"binary\"");
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetCompressorTypeToNone(), w.SetHeaderTypeToUInt64(); }), "UInt64");
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetCompressorTypeToLZMA(); }), "vtkLZMADataCompressor");
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetCompressorTypeToLZ4(); }), "vtkLZ4DataCompressor");
    check_file(io::Format::Vtp, xml([](auto& w) { w.SetEncodeAppendedData(false), w.SetByteOrderToBigEndian(); }),
               "BigEndian");
  }
}

TEST_CASE("VTK meshes: legacy files keep every other byte, in digits, too", "[vtk][documents]") {
  for (const int type : {VTK_FLOAT, VTK_DOUBLE})
    for (const bool ascii : {false, true}) {
      const std::string bytes = written<vtkPolyDataWriter>(tetrahedron(type), [&](auto& w) {
        if (ascii) w.SetFileTypeToASCII();
        else w.SetFileTypeToBinary();
      });
      check_file(io::Format::Vtk, bytes, ascii ? "ASCII" : "BINARY");
      const io::MeshFile file = parsed(io::Format::Vtk, bytes);
      std::vector<Vec3d> moved = file.polygons.positions;
      moved[1][1] = 0.5;
      const std::string after = io::patched_bytes(file, moved);
      const std::size_t cells = after.find("\nVERTICES"), was = bytes.find("\nVERTICES");
      REQUIRE(cells != std::string::npos);
      CHECK(after.substr(cells, after.find("NORMALS") - cells) == bytes.substr(was, bytes.find("NORMALS") - was));
    }
}

TEST_CASE("VTK meshes: faces of grids, strips and pixels", "[vtk][documents]") {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  auto points = vtkSmartPointer<vtkPoints>::Take(vtkPoints::New(VTK_DOUBLE));
  for (int i = 0; i < 6; ++i) points->InsertNextPoint(i % 2, i / 2, 0.1 * i);
  grid->SetPoints(points);
  const vtkIdType ids[] = {0, 1, 2, 3, 4, 5};
  grid->InsertNextCell(VTK_VERTEX, 1, ids);
  grid->InsertNextCell(VTK_PIXEL, 4, ids);
  grid->InsertNextCell(VTK_TRIANGLE_STRIP, 4, ids + 2);
  grid->GetCellData()->AddArray(named_array<vtkIntArray>("group", 1, 3));
  for (const io::Format format : {io::Format::Vtu, io::Format::Vtk}) {
    const std::string bytes = format == io::Format::Vtu ? written<vtkXMLUnstructuredGridWriter>(grid, [](auto&) {})
                                                        : written<vtkUnstructuredGridWriter>(grid, [](auto&) {});
    const io::MeshFile file = parsed(format, bytes);
    CHECK(file.polygons.corners == std::vector<std::uint32_t>{0, 1, 3, 2, 2, 3, 4, 4, 3, 5});
    CHECK(io::wall_names(file).of_face == std::vector<std::uint32_t>{0, 1, 1});
    const auto chosen = io::select_faces(file, std::vector{io::Selector{io::Selector::By::Group, "37"}});
    CHECK(chosen == std::vector<std::uint8_t>{1, 0, 0});
  }
  grid->InsertNextCell(VTK_TETRA, 4, ids);
  grid->GetCellData()->AddArray(named_array<vtkIntArray>("group", 1, 4));
  CHECK_THROWS_WITH(parsed(io::Format::Vtu, written<vtkXMLUnstructuredGridWriter>(grid, [](auto&) {})),
                    Catch::Contains("cell 3: expected a face") && Catch::Contains("a solid"));
}

TEST_CASE("VTK meshes: a shell keeps the arrays of points and cells", "[vtk][documents][shell]") {
  const Folder folder;
  const auto polygons = tetrahedron(VTK_DOUBLE);
  polygons->GetCellData()->GetArray("part")->SetName("zone");
  const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(polygons->GetPoints());
  for (vtkIdType cell = 0; cell < 6; ++cell)
    grid->InsertNextCell(polygons->GetCellType(cell), polygons->GetCell(cell)->GetPointIds());
  grid->GetPointData()->ShallowCopy(polygons->GetPointData());
  grid->GetCellData()->ShallowCopy(polygons->GetCellData());
  grid->GetFieldData()->ShallowCopy(polygons->GetFieldData());
  const auto check = [&](io::Format format, bool is_grid, const std::string& bytes, const std::string& lost) {
    const io::MeshFile file = parsed(format, bytes);
    std::vector<Vec3d> inner = file.polygons.positions;
    for (Vec3d& p : inner) p += Vec3d(0.25, 0, 0.5);
    const std::vector<std::uint8_t> three{1, 1, 1, 0};
    const Shell shell = make_shell(file.polygons.view(), file.polygons.positions, inner, {}, {}, three);
    const std::string path = folder.file(std::string("s.") + io::name(format));
    CHECK(io::write_shell(path, file, shell, {.normals = io::Normals::Keep}).lost == lost);
    const auto was = read_back(format, is_grid, bytes), is = read_back(format, is_grid, slurp(path));
    CHECK(io::read_mesh(path).polygons.positions == shell.polygons.positions);
    CHECK(io::read_mesh(path).polygons.corners == shell.polygons.corners);
    // A point, a line, three faces on each side, and the rim of three quads; all that they come from is before them.
    REQUIRE(is->GetNumberOfCells() == 11);
    CHECK(is->GetCellType(1) == VTK_LINE);
    vtkFieldData &points = *is->GetPointData(), &cells = *is->GetCellData();
    for (const char* const name : {"thickness", "RGB"}) {
      REQUIRE(points.GetArray(name));
      CHECK(points.GetArray(name)->GetDataType() == was->GetPointData()->GetArray(name)->GetDataType());
      for (vtkIdType v = 0; v < 8; ++v)
        CHECK(points.GetArray(name)->GetComponent(v, 0) == was->GetPointData()->GetArray(name)->GetComponent(v % 4, 0));
    }
    REQUIRE(cells.GetArray("zone"));
    const vtkIdType from[] = {0, 1, 2, 3, 4, 2, 3, 4, 2, 3, 4};
    for (vtkIdType cell = 0; cell < 8; ++cell)
      CHECK(cells.GetArray("zone")->GetComponent(cell, 0) ==
            was->GetCellData()->GetArray("zone")->GetComponent(from[cell], 0));
    REQUIRE(cells.GetArray("part"));
    CHECK(cells.GetArray("part")->GetComponent(4, 0) == 0);
    CHECK(cells.GetArray("part")->GetComponent(5, 0) == 1);
    CHECK(cells.GetArray("part")->GetComponent(10, 0) == 2);
    CHECK(is->GetFieldData()->GetAbstractArray("note")->GetVariantValue(0).ToString() == "<as it was> & so on");
    vtkDataArray& normals = *points.GetArray("Normals");
    for (vtkIdType v = 0; v < 4; ++v) CHECK(Vec3d(normals.GetTuple3(v + 4)) == -Vec3d(normals.GetTuple3(v)));
    // Computed anew, the inner ones are of length 1.
    io::write_shell(path, file, shell);
    const auto anew = read_back(format, is_grid, slurp(path));
    CHECK(Vec3d(anew->GetPointData()->GetArray("Normals")->GetTuple3(4)).length() == Approx(1).epsilon(1e-6));
  };
  check(io::Format::Vtp, false, written<vtkXMLPolyDataWriter>(polygons, [](auto&) {}), "");
  check(io::Format::Vtu, true, written<vtkXMLUnstructuredGridWriter>(grid, [](auto&) {}), "");
  check(io::Format::Vtk, false, written<vtkPolyDataWriter>(polygons, [](auto& w) { w.SetFileTypeToBinary(); }),
        "the layout of the text");
  check(io::Format::Vtk, true, written<vtkUnstructuredGridWriter>(grid, [](auto& w) { w.SetFileTypeToBinary(); }),
        "the layout of the text");
}

TEST_CASE("VTK meshes: distances are arrays of points", "[vtk][documents]") {
  const io::MeshFile file =
      parsed(io::Format::Vtp, written<vtkXMLPolyDataWriter>(tetrahedron(VTK_DOUBLE), [](auto&) {}));
  const std::vector<double> thickness = io::vertex_property(file, "thickness");
  REQUIRE(thickness.size() == 4);
  CHECK(thickness[1] == Approx(37));
  CHECK_THROWS_WITH(io::vertex_property(file, "thicknes"), Catch::Contains("among thickness, got 'thicknes'"));
  CHECK_THROWS_WITH(io::vertex_property(file, "Normals"), Catch::Contains("got 'Normals'"));
}

TEST_CASE("VTK meshes: VTK reads new files", "[vtk][documents]") {
  const io::MeshFile source = io::parse_mesh(
      "a.obj", io::Format::Obj,
      "v 0 0 0.1 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0.3 0 0 1\nv 0 1 0 0.2 0.2 0.2\nv 0.5 0.5 2 1 1 1\nvn 0 0 1\n"
      "vt 0.25 0.5\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf 1/1/1 2/1/1 5/1/1\nf 2/1/1 3/1/1 4/1/1 1/1/1 5/1/1\n");
  const auto& positions = source.polygons.positions;
  for (const io::Format format : {io::Format::Vtp, io::Format::Vtk, io::Format::Vtu}) {
    io::WriteResult result;
    const std::string bytes = io::join(io::convert(source, format, positions, {}, io::Normals::Keep, result));
    CHECK(result.lost.empty());
    const auto data = read_back(format, false, bytes);
    REQUIRE(data->GetNumberOfPoints() == 5);
    REQUIRE(data->GetNumberOfCells() == 3);
    for (vtkIdType v = 0; v < 5; ++v) CHECK(Vec3d(data->GetPoint(v)) == positions[static_cast<std::size_t>(v)]);
    CHECK(data->GetCell(1)->GetPointId(2) == 4);
    CHECK(data->GetCell(2)->GetNumberOfPoints() == 5);
    vtkPointData& with = *data->GetPointData();
    REQUIRE(with.GetNormals());
    CHECK(with.GetNormals()->GetComponent(3, 2) == 1);
    REQUIRE(with.GetTCoords());
    CHECK(with.GetTCoords()->GetComponent(2, 1) == 0.5);
    REQUIRE(with.GetScalars());
    CHECK(with.GetScalars()->GetDataType() == VTK_UNSIGNED_CHAR);
    CHECK(with.GetScalars()->GetComponent(1, 1) == 255);
    const io::MeshFile back = parsed(format, bytes);
    CHECK(back.polygons.corners == source.polygons.corners);
    CHECK(io::read_attributes(back).colours == io::read_attributes(source).colours);
  }
}

TEST_CASE("VTK meshes: what is wrong with a file is told", "[vtk][documents]") {
  const auto check = [](io::Format format, const std::string& text, const std::string& words) {
    INFO(text.substr(0, 200));
    CHECK_THROWS_WITH(parsed(format, text), Catch::Contains(words));
  };
  const std::string points = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
  check(io::Format::Vtk, "solid a\n", "byte 0: expected '# vtk DataFile Version'");
  check(io::Format::Vtk, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_GRID\n", "STRUCTURED_GRID");
  check(io::Format::Vtk, kLegacy + points, "at least one face");
  check(io::Format::Vtk, kLegacy + points + "POLYGONS 1 4\n3 0 1 7\n", "cell 0: expected points from 0 to 2, got 7");
  check(io::Format::Vtk, kLegacy + points + "POLYGONS 1 4\n3 0 1 -1\n", "expected points from 0 to 2, got -1");
  check(io::Format::Vtk, kLegacy + points + "POLYGONS 1 3\n2 0 1\n", "a face of 3 corners or more, got 2");
  check(io::Format::Vtk, kLegacy + "POINTS 3 int\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n", "floating numbers");
  check(io::Format::Vtk, kLegacy + "POINTS 3 float\n0 0 nan 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n", "that VTK reads");
  check(io::Format::Vtk, kLegacy + "POINTS 9999999999 float\n0 0 0\n", "byte 58: expected no more than");
  check(io::Format::Vtk, kLegacy + points + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nFIELD f 1\na 65536 65536 double\n",
        "no more than the file has bytes for");
  const std::string xml =
      written<vtkXMLPolyDataWriter>(tetrahedron(VTK_DOUBLE), [](auto& w) { w.SetDataModeToAscii(); });
  check(io::Format::Vtu, xml, "expected VTK's XML of an unstructured grid, got polygons (.vtp)");
  check(io::Format::Vtk, xml, "expected a legacy file of VTK's");
  const auto with = [&](const std::string& was, const std::string& is) {
    std::string text = xml;
    const std::size_t at = text.find(was);
    REQUIRE(at != std::string::npos);
    return text.replace(at, was.size(), is);
  };
  check(io::Format::Vtp, with("NumberOfPoints=\"4\"", "NumberOfPoints=\"400000000000\""), "NumberOfPoints");
  check(io::Format::Vtp, with("NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\""), "NumberOfPoints");
  check(io::Format::Vtp, with("</Piece>", "</Pie>"), "a file that VTK reads");
  check(io::Format::Vtp, xml.substr(0, xml.size() / 2), "a file that VTK reads");
  CHECK_THROWS_AS(parsed(io::Format::Vtp, with("PolyData\"", "Table\"")), InvalidInput);
}
