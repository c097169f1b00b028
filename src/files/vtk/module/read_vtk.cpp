// SPDX-License-Identifier: Apache-2.0
// Reads surfaces by VTK's own readers.
#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <new>
#include <utility>

#include "document/trial.h"
#include "vdb_offset/run.h"
#include "vtk/module/vtk_cells.h"
#include "vtk/module/vtk_complaint.h"
#include "vtk/module/vtk_document.h"
#include "vtk/vtk_meshes.h"

namespace vdb_offset::io {
namespace {

/// Runs a reader on the file's bytes. \throw InvalidInput if it finds anything wrong
template <class Reader, class GiveBytes>
vtkSmartPointer<vtkPointSet> read_by(const MeshFile& file, GiveBytes&& give) {
  const auto reader = vtkSmartPointer<Reader>::New();
  const VtkComplaint complaint;
  give(*reader);
  reader->Update();
  if (!complaint.empty() || reader->GetErrorCode() != 0)
    throw InvalidInput(fmt::format("{}: expected a file that VTK reads, got: {}", file.path,
                                   complaint.empty() ? "an error without a text" : complaint.in_short()));
  return reader->GetOutput();
}

vtkSmartPointer<vtkPointSet> read_data(const MeshFile& file, const VtkHeader& header) {
  const std::string_view bytes = file.text();
  const auto xml = [&](auto& reader) {
    reader.ReadFromInputStringOn();
    reader.SetInputString(std::string(bytes));
  };
  const auto legacy = [&](auto& reader) {
    reader.ReadFromInputStringOn();
    reader.SetBinaryInputString(bytes.data(), static_cast<int>(bytes.size()));
    reader.ReadAllScalarsOn();
    reader.ReadAllVectorsOn();
    reader.ReadAllNormalsOn();
    reader.ReadAllTensorsOn();
    reader.ReadAllColorScalarsOn();
    reader.ReadAllTCoordsOn();
    reader.ReadAllFieldsOn();
  };
  if (header.legacy)
    return header.grid ? read_by<vtkUnstructuredGridReader>(file, legacy) : read_by<vtkPolyDataReader>(file, legacy);
  return header.grid ? read_by<vtkXMLUnstructuredGridReader>(file, xml) : read_by<vtkXMLPolyDataReader>(file, xml);
}

void require_fit(const MeshFile& file, const VtkHeader& header) {
  const bool is_xml = file.format != Format::Vtk;
  if (is_xml == header.legacy || (is_xml && header.grid != (file.format == Format::Vtu)))
    throw InvalidInput(fmt::format("{}: expected {}, got {}", file.path,
                                   file.format == Format::Vtp   ? "VTK's XML of polygons"
                                   : file.format == Format::Vtu ? "VTK's XML of an unstructured grid"
                                                                : "a legacy file of VTK's",
                                   header.legacy ? "a legacy file (.vtk)"
                                   : header.grid ? "an unstructured grid (.vtu)"
                                                 : "polygons (.vtp)"));
  constexpr std::size_t kMostLegacy = std::size_t{1} << 31;  // VTK counts the bytes of a text by an int
  if (header.legacy && file.text().size() >= kMostLegacy)
    throw InvalidInput(fmt::format("{}: expected at most {} bytes of a legacy file, got {} (.vtp may have more)",
                                   file.path, kMostLegacy - 1, file.text().size()));
}

// Most memory that reading may take: what a file of this size can hold, and enough for small ones.
constexpr std::size_t kMostPerByte = 64, kAtLeast = std::size_t{1} << 30;

std::size_t count_of(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

}  // namespace

void parse_with_vtk(MeshFile& file) {
  const VtkHeader header = read_vtk_header(file);
  require_fit(file, header);
  try_in_child(file.path, kMostPerByte * file.text().size() + kAtLeast, [&] {
    const vtkSmartPointer<vtkPointSet> data = read_data(file, header);
    read_vtk_faces(file.path, *data);
  });
  try {
    vtkSmartPointer<vtkPointSet> data = read_data(file, header);
    VtkFaces faces = read_vtk_faces(file.path, *data);
    const int type = data->GetPoints()->GetDataType();
    if (type != VTK_FLOAT && type != VTK_DOUBLE)
      throw InvalidInput(file.path + ": expected points of floating numbers, got whole ones");
    file.polygons = std::move(faces.mesh);
    file.encoding = Encoding::LittleEndian;  // the digits of a text are VTK's own affair
    if (type == VTK_FLOAT) file.precision = {Precision::Kind::Single};
    auto document = std::make_shared<VtkDocument>(header, data, std::move(faces.cell));
    file.extras = document->arrays_in_words();
    if (faces.others > 0) file.extras.emplace_back("cells that are points or lines");
    if (faces.of_strips > 0) file.remarks.emplace_back("strips of triangles are read as triangles");
    if (count_of(file.text().substr(0, file.text().find("<AppendedData")), "<Piece") > 1)
      file.remarks.emplace_back("has several pieces, which are written as one");
    if (document->normals()) file.normal_count = file.polygons.positions.size();
    file.document = std::move(document);
  } catch (const std::bad_alloc&) {
    throw OutOfBudget(file.path + ": expected a file whose arrays fit into memory, got one that asks for more");
  }
}

}  // namespace vdb_offset::io
