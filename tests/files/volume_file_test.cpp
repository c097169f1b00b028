// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/volume_file.h"

#include <cgnslib.h>
#include <sys/resource.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellSizeFilter.h>
#include <vtkFieldData.h>
#include <vtkMeshQuality.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <map>
#include <set>

#include "products/volume/cell_quality.h"
#include "support/folder.h"
#include "support/volume_meshes.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using Catch::Matchers::Contains;

namespace {

template <class Reader>
auto read_with(const std::string& path) {
  const auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(path.c_str());
  reader->Update();
  return vtkSmartPointer<std::remove_pointer_t<decltype(reader->GetOutput())>>(reader->GetOutput());
}

void check_field(vtkDataSetAttributes* read, const VolumeField& field) {
  vtkDataArray* const array = read->GetArray(field.name.c_str());
  REQUIRE(array);
  CHECK(array->GetDataType() == VTK_FLOAT);
  REQUIRE(static_cast<std::size_t>(array->GetNumberOfTuples()) == field.values.size());
  for (std::size_t i = 0; i < field.values.size(); ++i)
    CHECK(array->GetComponent(static_cast<vtkIdType>(i), 0) == static_cast<double>(field.values[i]));
}

void check_points(vtkPointSet* read, const std::vector<Vec3d>& points) {
  REQUIRE(static_cast<std::size_t>(read->GetNumberOfPoints()) == points.size());
  for (std::size_t p = 0; p < points.size(); ++p) CHECK(Vec3d(read->GetPoint(static_cast<vtkIdType>(p))) == points[p]);
}

/// VTK's number of a corner: its prism's triangles run the other way round.
std::size_t vtk_corner(CellType type, std::size_t k) {
  constexpr std::size_t kPrism[] = {0, 2, 1, 3, 5, 4};
  return type == CellType::Prism ? kPrism[k] : k;
}

/// Six times the volume, signed, that a cell's faces enclose as VTK knows them.
double within_vtk_faces(vtkCell* cell) {
  double volume = 0;
  for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
    vtkPoints* const points = cell->GetFace(f)->GetPoints();
    const auto at = [&](vtkIdType k) { return Vec3d(points->GetPoint(k)); };
    for (vtkIdType k = 2; k < points->GetNumberOfPoints(); ++k) volume += at(0).dot(at(k - 1).cross(at(k)));
  }
  return volume;
}

/// What VTK says of all cells' volumes, with their signs.
std::vector<double> vtk_volumes(vtkUnstructuredGrid* grid) {
  const auto filter = vtkSmartPointer<vtkCellSizeFilter>::New();
  filter->SetInputData(grid);
  filter->Update();
  vtkDataArray* const array = vtkDataSet::SafeDownCast(filter->GetOutput())->GetCellData()->GetArray("Volume");
  std::vector<double> volumes;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) volumes.push_back(array->GetComponent(c, 0));
  return volumes;
}

}  // namespace

TEST_CASE("volume file: formats by paths' ends", "[volume_file]") {
  CHECK(io::volume_format_of("a.b/c.VTU") == io::VolumeFormat::Vtu);
  CHECK(io::volume_format_of("c.msh") == io::VolumeFormat::Msh);
  CHECK(io::volume_format_of("c.cgns") == io::VolumeFormat::Cgns);
  CHECK(io::volume_format_of("c.su2") == io::VolumeFormat::Su2);
  CHECK(io::volume_format_of("polyMesh") == io::VolumeFormat::Foam);
  CHECK(io::volume_format_of("case/constant/polyMesh/") == io::VolumeFormat::Foam);
  CHECK_FALSE(io::volume_format_of("my_polyMesh"));
  CHECK_FALSE(io::volume_format_of("polyMesh/vtu"));
  CHECK_FALSE(io::volume_format_of(""));
  CHECK(io::structured_format_of("c.vts") == io::StructuredFormat::Vts);
  CHECK(io::structured_format_of("c.XYZ") == io::StructuredFormat::Plot3d);
  CHECK_FALSE(io::structured_format_of("vts"));
  CHECK(name(CellType::Prism) == std::string("prisms"));
  CHECK(name(CellType::Polyhedron) == std::string("polyhedra"));
}

TEST_CASE("volume file: vtu read back by VTK", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells();
  io::write_volume(folder.file("mesh.vtu"), mesh);
  const auto grid = read_with<vtkXMLUnstructuredGridReader>(folder.file("mesh.vtu"));
  check_points(grid, mesh.points);
  REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == mesh.cell_count());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    vtkCell* const cell = grid->GetCell(static_cast<vtkIdType>(c));
    const auto corners = mesh.cell(c);
    REQUIRE(static_cast<std::size_t>(cell->GetNumberOfPoints()) == corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k)
      CHECK(cell->GetPointId(static_cast<int>(vtk_corner(mesh.cell_types[c], k))) == corners[k]);
    if (cell->GetCellType() == VTK_TETRA) CHECK(vtkMeshQuality::TetScaledJacobian(cell) > 0.1);
    if (cell->GetCellType() == VTK_HEXAHEDRON) CHECK(vtkMeshQuality::HexScaledJacobian(cell) == Approx(1));
    const int types[] = {VTK_TETRA, VTK_PYRAMID, VTK_WEDGE, VTK_HEXAHEDRON};
    CHECK(cell->GetCellType() == types[static_cast<std::size_t>(mesh.cell_types[c])]);
  }
  check_field(grid->GetPointData(), mesh.point_fields[0]);
  check_field(grid->GetCellData(), mesh.cell_fields[0]);
  CHECK_FALSE(grid->GetPointData()->HasArray("nothing"));
  const auto* names = vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("patch_names"));
  REQUIRE(names);
  CHECK(names->GetNumberOfValues() == 3);
  CHECK(grid->GetFieldData()->GetArray("patch_faces")->GetComponent(0, 0) == 2);
}

TEST_CASE("volume file: vtu of polyhedra read back by VTK", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = with_polyhedra();
  io::write_volume(folder.file("mesh.vtu"), mesh);
  const auto grid = read_with<vtkXMLUnstructuredGridReader>(folder.file("mesh.vtu"));
  check_points(grid, mesh.points);
  REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == mesh.cell_count());
  const std::vector<double> volumes = volumes_of(mesh);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    vtkCell* const cell = grid->GetCell(static_cast<vtkIdType>(c));
    CHECK((cell->GetCellType() == VTK_POLYHEDRON) == (mesh.cell_types[c] == CellType::Polyhedron));
    if (cell->GetCellType() != VTK_POLYHEDRON) continue;
    std::vector<CornerList> faces(static_cast<std::size_t>(cell->GetNumberOfFaces()));
    for (int f = 0; f < cell->GetNumberOfFaces(); ++f)
      for (vtkIdType k = 0; k < cell->GetFace(f)->GetNumberOfPoints(); ++k)
        faces[static_cast<std::size_t>(f)].push_back(
            static_cast<std::uint32_t>(cell->GetFace(f)->GetPointId(static_cast<int>(k))));
    CHECK(faces == faces_of(CellType::Polyhedron, mesh.cell(c)));
    CHECK(volume_of(mesh.points, faces) == Approx(volumes[c]));
  }
}

TEST_CASE("volume file: VTK finds the volume of each type of cell, and its faces outward", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = GENERATE(mixed_cells(), with_polyhedra());
  io::write_volume(folder.file("mesh.vtu"), mesh);
  const auto grid = read_with<vtkXMLUnstructuredGridReader>(folder.file("mesh.vtu"));
  const std::vector<double> volumes = vtk_volumes(grid);
  REQUIRE(volumes.size() == mesh.cell_count());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    INFO(name(mesh.cell_types[c]));
    CHECK(volumes[c] == Approx(cell_volume(mesh, c)));
    CHECK(within_vtk_faces(grid->GetCell(static_cast<vtkIdType>(c))) == Approx(6 * cell_volume(mesh, c)));
  }
}

TEST_CASE("volume file: su2 parsed back", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells();
  io::write_volume(folder.file("mesh.su2"), mesh);
  std::ifstream in(folder.file("mesh.su2"));
  const auto count_of = [&in](const std::string& keyword) {
    std::string word;
    std::size_t count = 0;
    in >> word >> count;
    CHECK(word == keyword);
    return count;
  };
  const auto row = [&in](std::size_t size) {
    CornerList numbers(size);
    for (std::uint32_t& number : numbers) in >> number;
    return numbers;
  };
  CHECK(count_of("NDIME=") == 3);
  REQUIRE(count_of("NELEM=") == mesh.cell_count());
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    constexpr std::uint32_t kTypes[] = {10, 14, 13, 12};
    CornerList expected = {kTypes[static_cast<std::size_t>(mesh.cell_types[c])]};
    expected.insert(expected.end(), mesh.cell(c).begin(), mesh.cell(c).end());
    expected.push_back(c);
    CHECK(row(expected.size()) == expected);
  }
  REQUIRE(count_of("NPOIN=") == mesh.points.size());
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    Vec3d point;
    in >> point[0] >> point[1] >> point[2];
    CHECK(point == mesh.points[p]);
    CHECK(row(1) == CornerList{p});
  }
  REQUIRE(count_of("NMARK=") == mesh.patches.size());
  for (const BoundaryPatch& patch : mesh.patches) {
    std::string word, tag;
    in >> word >> tag;
    CHECK(word == "MARKER_TAG=");
    CHECK(tag == (patch.kind == BoundaryPatch::Kind::Wall ? "the__wall_" : patch.name));
    REQUIRE(count_of("MARKER_ELEMS=") == patch.face_count());
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      CornerList expected = {patch.face(f).size() == 3 ? 5u : 9u};
      expected.insert(expected.end(), patch.face(f).begin(), patch.face(f).end());
      CHECK(row(expected.size()) == expected);
    }
  }
  CHECK((in >> std::ws).eof());
}

namespace {

/// An OpenFOAM file's text behind its header.
std::ifstream open_foam(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line) && line != "}") CHECK(in);
  return in;
}

void expect_character(std::istream& in, char expected) {
  char got = 0;
  in >> got;
  REQUIRE(got == expected);
}

/// A list's length, then its items by read(in).
template <class Read>
auto foam_list(const std::string& path, Read read) {
  std::ifstream in = open_foam(path);
  std::size_t count = 0;
  in >> count;
  expect_character(in, '(');
  std::vector<decltype(read(in))> items;
  for (std::size_t i = 0; i < count; ++i) items.push_back(read(in));
  expect_character(in, ')');
  CHECK((in >> std::ws).eof());
  return items;
}

std::uint32_t read_label(std::istream& in) {
  std::uint32_t label = 0;
  REQUIRE(in >> label);
  return label;
}

Vec3d read_vector(std::istream& in) {
  Vec3d vector;
  expect_character(in, '(');
  in >> vector[0] >> vector[1] >> vector[2];
  expect_character(in, ')');
  return vector;
}

CornerList read_face(std::istream& in) {
  CornerList face(read_label(in));
  expect_character(in, '(');
  for (std::uint32_t& corner : face) corner = read_label(in);
  expect_character(in, ')');
  return face;
}

struct FoamPatch {
  std::string name, type;
  std::size_t faces = 0, start = 0;
};

FoamPatch read_patch(std::istream& in) {
  FoamPatch patch;
  std::string keyword, end;
  in >> patch.name;
  expect_character(in, '{');
  in >> keyword >> patch.type >> keyword >> patch.faces >> end >> keyword >> patch.start >> end;
  CHECK(keyword == "startFace");
  expect_character(in, '}');
  return patch;
}

/// A folder of OpenFOAM's holds the mesh's points, cells and patches, in the order that OpenFOAM asks for.
void check_foam(const std::string& path, const VolumeMesh& mesh) {
  const auto points = foam_list(path + "/points", read_vector);
  const auto faces = foam_list(path + "/faces", read_face);
  const auto owner = foam_list(path + "/owner", read_label), neighbour = foam_list(path + "/neighbour", read_label);
  CHECK(points == mesh.points);
  REQUIRE(owner.size() == faces.size());
  std::vector<std::vector<CornerList>> cells(mesh.cell_count());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    cells.at(owner[f]).push_back(faces[f]);
    if (f >= neighbour.size()) continue;
    CHECK(owner[f] < neighbour[f]);
    if (f > 0) CHECK(std::pair(owner[f - 1], neighbour[f - 1]) < std::pair(owner[f], neighbour[f]));
    cells.at(neighbour[f]).emplace_back(faces[f].rbegin(), faces[f].rend());
  }
  const std::vector<double> volumes = volumes_of(mesh);
  for (std::size_t c = 0; c < cells.size(); ++c)
    CHECK(volume_of(points, cells[c]) == Approx(volumes[c]).epsilon(1e-12));
  const auto patches = foam_list(path + "/boundary", read_patch);
  REQUIRE(patches.size() == mesh.patches.size());
  std::size_t next = neighbour.size();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    CHECK(patches[i].name == (i == 0 ? "the__wall_" : mesh.patches[i].name));
    CHECK(patches[i].type == (i == 0 ? "wall;" : "patch;"));
    CHECK(patches[i].start == next);
    REQUIRE(patches[i].faces == mesh.patches[i].face_count());
    for (std::size_t f = 0; f < patches[i].faces; ++f, ++next) {
      const auto face = mesh.patches[i].face(f);
      CHECK(faces.at(next) == CornerList(face.begin(), face.end()));
      CHECK(owner[next] == mesh.patches[i].cell[f]);
    }
  }
  CHECK(next == faces.size());
}

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

}  // namespace

TEST_CASE("volume file: polyMesh parsed back", "[volume_file]") {
  const Folder folder;
  const std::string path = folder.file("case/constant/polyMesh");
  const VolumeMesh mesh = GENERATE(mixed_cells(), with_polyhedra());
  io::write_volume(path, mesh);
  check_foam(path, mesh);
  CHECK_THAT(slurp(path + "/owner"), Contains("\"nPoints:17  nCells:7  nFaces:27  nInternalFaces:8\""));
  CHECK(names_in(path) == std::set<std::string>{"points", "faces", "owner", "neighbour", "boundary"});

  INFO("a folder that is there keeps what is not the mesh's");
  std::ofstream(path + "/cellZones") << "kept";
  std::ofstream(path + "/points") << "replaced";
  io::write_volume(path + "/", mesh);
  check_foam(path, mesh);
  CHECK(slurp(path + "/cellZones") == "kept");
  CHECK(names_in(path).size() == 6);
}

TEST_CASE("volume file: polyMesh refuses patches that are not the boundary", "[volume_file]") {
  const Folder folder;
  VolumeMesh mesh = mixed_cells();
  const auto refused = [&] {
    CHECK_THROWS_AS(io::write_volume(folder.file("polyMesh"), mesh), InvalidInput);
    CHECK_FALSE(std::filesystem::exists(folder.file("polyMesh")));
  };
  SECTION("a face left out") { mesh.patches.pop_back(); }
  SECTION("a face twice") { mesh.patches.push_back(mesh.patches[0]); }
  SECTION("another cell behind a face") { mesh.patches[0].cell[0] = 0; }
  SECTION("a face between cells") {
    mesh.patches[0].corners.insert(mesh.patches[0].corners.end(), {5, 6, 7, 8});
    mesh.patches[0].face_begin.push_back(static_cast<std::uint32_t>(mesh.patches[0].corners.size()));
    mesh.patches[0].cell.push_back(1);
  }
  SECTION("a face of three cells") {
    mesh.points.emplace_back(0.5, 0.5, 0.5);
    add_cell(mesh, CellType::Pyramid, {5, 6, 7, 8, 17});
    mesh.cell_fields.clear();
    mesh.point_fields.clear();
  }
  refused();
}

TEST_CASE("volume file: msh read by Gmsh", "[volume_file]") {
  const Folder folder;
  io::write_volume(folder.file("mesh.msh"), mixed_cells());
  CHECK_THAT(slurp(folder.file("mesh.msh")), Contains("3 4 \"layers\"") && Contains("2 1 \"the__wall_\""));
  if (!installed("gmsh")) return;
  folder.write("read.geo",
               "Merge \"mesh.msh\";\n"
               "Plugin(AnalyseMeshQuality).JacobianDeterminant = 1;\n"
               "Plugin(AnalyseMeshQuality).DimensionOfElements = 3;\n"
               "Plugin(AnalyseMeshQuality).Run;\n"
               "s[] = Physical Surface{:}; v[] = Physical Volume{:};\n"
               "Printf(\"groups: %g %g\", #s[], #v[]);\n");
  const std::string output = output_of(folder, "gmsh " + folder.file("read.geo") + " -parse_and_exit") +
                             output_of(folder, "gmsh -check " + folder.file("mesh.msh"));
  INFO(output);
  CHECK_THAT(output, !Contains("Warning") && !Contains("Error"));
  CHECK_THAT(output, Contains("17 nodes") && Contains("36 elements") && Contains("groups: 3 1"));
  const std::size_t at = output.find("minJ      =");
  REQUIRE(at != std::string::npos);
  CHECK(std::atof(output.c_str() + at + 11) > 0.1);
}

TEST_CASE("volume file: cgns read by cgnscheck", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = GENERATE(mixed_cells(), with_polyhedra());
  io::write_volume(folder.file("mesh.cgns"), mesh);
  if (!installed("cgnscheck")) return;
  const std::string output = output_of(folder, "cgnscheck -v " + folder.file("mesh.cgns"));
  INFO(output);
  CHECK_THAT(output,
             !Contains("ERROR"));  // It warns of lengths without units, and of names that are not the standard's.
  CHECK_THAT(output, Contains("the__wall_") && Contains("outer") && Contains("BCWall") && Contains("CellFields"));
}

TEST_CASE("volume file: cells of cgns by faces are closed and have the mesh's volumes", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = with_polyhedra();
  io::write_volume(folder.file("mesh.cgns"), mesh);
  int file = 0, sections = 0, parents = 0, boundary = 0;
  REQUIRE(cg_open(folder.file("mesh.cgns").c_str(), CG_MODE_READ, &file) == CG_OK);
  REQUIRE(cg_nsections(file, 1, 1, &sections) == CG_OK);
  std::vector<CornerList> faces;
  std::size_t cells = 0;
  for (int s = 1; s <= sections; ++s) {
    char name[33];
    CGNS_ENUMT(ElementType_t) type{};
    cgsize_t first = 0, last = 0, size = 0;
    REQUIRE(cg_section_read(file, 1, 1, s, name, &type, &first, &last, &boundary, &parents) == CG_OK);
    REQUIRE(cg_ElementDataSize(file, 1, 1, s, &size) == CG_OK);
    std::vector<cgsize_t> numbers(static_cast<std::size_t>(size)), begin(static_cast<std::size_t>(last - first) + 2);
    REQUIRE(cg_poly_elements_read(file, 1, 1, s, numbers.data(), begin.data(), nullptr) == CG_OK);
    for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
      std::vector<CornerList> of_cell;
      CornerList face;
      for (auto n = static_cast<std::size_t>(begin[i]); n < static_cast<std::size_t>(begin[i + 1]); ++n) {
        if (type == CGNS_ENUMV(NGON_n)) {
          face.push_back(static_cast<std::uint32_t>(numbers[n] - 1));
        } else {
          of_cell.push_back(faces.at(static_cast<std::size_t>(std::abs(numbers[n])) - 1));
          if (numbers[n] < 0) std::reverse(of_cell.back().begin(), of_cell.back().end());
        }
      }
      if (type == CGNS_ENUMV(NGON_n)) faces.push_back(face);
      else CHECK(volume_of(mesh.points, of_cell) == Approx(volumes_of(mesh)[cells++]));
    }
  }
  CHECK(cells == mesh.cell_count());
  cg_close(file);
}

namespace {

/// A bent block.
StructuredBlock structured_block() {
  StructuredBlock block{4, 3, 2, {}, {{"height", {}}, {"nothing", {}}}};
  for (std::uint32_t k = 0; k < block.nk; ++k)
    for (std::uint32_t j = 0; j < block.nj; ++j)
      for (std::uint32_t i = 0; i < block.ni; ++i) {
        block.points.emplace_back(i / 3., j + i / 7., k + j * i / 11.);
        block.point_fields[0].values.push_back(static_cast<float>(k) + 0.1f);
      }
  return block;
}

/// The block in the numbering of a mesh of hexahedra.
void check_structured(vtkStructuredGrid* grid, const StructuredBlock& block) {
  REQUIRE(grid);
  int sizes[3];
  grid->GetDimensions(sizes);
  CHECK(std::equal(sizes, sizes + 3, std::array{block.ni, block.nj, block.nk}.begin(),
                   [](int a, std::uint32_t b) { return a == static_cast<int>(b); }));
  check_points(grid, block.points);
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c)
    CHECK(vtkMeshQuality::HexScaledJacobian(grid->GetCell(c)) > 0.5);
}

/// No file of more than this many bytes can be written, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit lower{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &lower);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit before_{};
  void (*signal_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

template <class Write>
bool throws_write_error(const Write& write, const std::string& path) {
  try {
    write();
  } catch (const WriteError& error) {
    return std::string(error.what()).starts_with(path);
  }
  return false;
}

}  // namespace

TEST_CASE("volume file: vts and Plot3D read back by VTK", "[volume_file]") {
  const Folder folder;
  const StructuredBlock block = structured_block();
  io::write_structured(folder.file("block.vts"), block);
  const auto grid = read_with<vtkXMLStructuredGridReader>(folder.file("block.vts"));
  check_structured(grid, block);
  check_field(grid->GetPointData(), block.point_fields[0]);
  CHECK_FALSE(grid->GetPointData()->HasArray("nothing"));

  io::write_structured(folder.file("block.xyz"), block);
  const auto reader = vtkSmartPointer<vtkMultiBlockPLOT3DReader>::New();
  reader->SetXYZFileName(folder.file("block.xyz").c_str());
  reader->BinaryFileOff();
  reader->MultiGridOff();
  reader->DoublePrecisionOn();
  reader->Update();
  REQUIRE(reader->GetOutput()->GetNumberOfBlocks() == 1);
  check_structured(vtkStructuredGrid::SafeDownCast(reader->GetOutput()->GetBlock(0)), block);
}

TEST_CASE("volume file: where nothing can be written, nothing is left", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells();
  for (const std::string name : {"mesh.vtu", "mesh.msh", "mesh.cgns", "mesh.su2"}) {
    INFO(name);
    const auto write_to = [&](const std::string& path) { io::write_volume(path, mesh); };
    const std::string nowhere = folder.file("nowhere/" + name);
    CHECK(throws_write_error([&] { write_to(nowhere); }, nowhere));
    bool refused = false;
    {
      const FileSizeLimit full(512);
      refused = throws_write_error([&] { write_to(folder.file(name)); }, folder.file(name));
    }
    CHECK(refused);
  }
  const std::string foam = folder.write("file", "") + "/constant/polyMesh";
  CHECK(throws_write_error([&] { io::write_volume(foam, mesh); }, foam));
  for (const std::string name : {"block.vts", "block.xyz"}) {
    const std::string nowhere = folder.file("nowhere/" + name);
    CHECK(throws_write_error([&] { io::write_structured(nowhere, structured_block()); }, nowhere));
  }
  CHECK(names_in(folder.path) == std::set<std::string>{"file"});
}

TEST_CASE("volume file: a polyMesh whose files do not all fit is left as it was", "[volume_file]") {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells();
  const std::string fresh = folder.file("case/constant/polyMesh"), old = folder.file("polyMesh");
  std::filesystem::create_directory(old);
  std::ofstream(old + "/points") << "old";
  const auto write_to = [&](const std::string& path) {
    const FileSizeLimit full(640);  // The points and faces fit, the boundary does not.
    return throws_write_error([&] { io::write_volume(path, mesh); }, path);
  };
  CHECK(write_to(fresh));
  CHECK(write_to(old));
  CHECK(names_in(folder.path) == std::set<std::string>{"polyMesh"});
  CHECK(names_in(old) == std::set<std::string>{"points"});
  CHECK(slurp(old + "/points") == "old");
}

TEST_CASE("volume file: what a format cannot hold, and what does not fit", "[volume_file]") {
  const Folder folder;
  const auto refuses = [&](const std::string& name, const VolumeMesh& mesh, const char* reason) {
    INFO(name);
    CHECK_THROWS_WITH(io::write_volume(folder.file(name), mesh), Contains(name) && Contains(reason));
    CHECK_THROWS_AS(io::write_volume(folder.file(name), mesh), InvalidInput);
  };
  refuses("mesh.su2", with_polyhedra(), "polyhedra: .su2 has none");
  refuses("mesh.msh", with_polyhedra(), "polyhedra: .msh has none");
  refuses("mesh.obj", mixed_cells(), ".cgns");
  refuses("mesh.vtu", {}, "at least one cell");
  VolumeMesh mesh = mixed_cells();
  mesh.cell_fields[0].values.pop_back();
  refuses("mesh.vtu", mesh, "field layer: expected 7 values");
  mesh = mixed_cells();
  mesh.cell_types.pop_back();
  refuses("mesh.vtu", mesh, "corners end");
  mesh = mixed_cells();
  mesh.patches[2].cell.pop_back();
  refuses("mesh.vtu", mesh, "behind each face");
  mesh = mixed_cells();
  mesh.corners[12] = 17;
  refuses("mesh.vtu", mesh, "cell 2: expected the corners of one of the prisms");
  mesh = with_polyhedra();
  ++mesh.corners[mesh.cell_begin[1]];
  refuses("polyMesh", mesh, "cell 1: expected the corners of one of the polyhedra");
  mesh = with_polyhedra();
  mesh.corners[mesh.cell_begin[1] + 1] = 1000;
  refuses("polyMesh", mesh, "cell 1");
  StructuredBlock block = structured_block();
  CHECK_THROWS_AS(io::write_structured(folder.file("block.obj"), block), InvalidInput);
  block.point_fields[0].values.pop_back();
  CHECK_THROWS_AS(io::write_structured(folder.file("block.vts"), block), InvalidInput);
  block.points.pop_back();
  CHECK_THROWS_AS(io::write_structured(folder.file("block.vts"), block), InvalidInput);
  CHECK(names_in(folder.path).empty());
}

TEST_CASE("volume file: patches get names of their own", "[volume_file]") {
  const Folder folder;
  VolumeMesh mesh = mixed_cells();
  const std::string longest(40, 'x');
  mesh.patches[0].name = longest + "1";
  mesh.patches[1].name = longest + "2";
  mesh.patches[2].name = "3 \xc3\xa4";
  io::write_volume(folder.file("mesh.su2"), mesh);
  const std::string text = slurp(folder.file("mesh.su2"));
  CHECK_THAT(text, Contains(longest + "1\n") && Contains(longest + "2\n") && Contains("_3___\n"));
  io::write_volume(folder.file("mesh.cgns"), mesh);
  const std::string bytes = slurp(folder.file("mesh.cgns"));
  CHECK_THAT(bytes, Contains(std::string(22, 'x')) && Contains(std::string(20, 'x') + "_2"));
}
