// SPDX-License-Identifier: Apache-2.0
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "ground/system/parallel.h"
#include "volume/volume_writers.h"
#include "volume/vtk/vtk_write.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kMostInt32 = std::numeric_limits<std::int32_t>::max();

vtkSmartPointer<vtkUnsignedCharArray> vtk_types(const VolumeMesh& mesh) {
  constexpr unsigned char kTypes[kCellTypeCount] = {VTK_TETRA,      VTK_PYRAMID,  VTK_WEDGE, VTK_HEXAHEDRON,
                                                    VTK_POLYHEDRON, VTK_TRIANGLE, VTK_QUAD};
  auto types = vtkSmartPointer<vtkUnsignedCharArray>::New();
  types->SetNumberOfValues(static_cast<vtkIdType>(mesh.cell_count()));
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    types->SetValue(static_cast<vtkIdType>(c), kTypes[static_cast<std::size_t>(mesh.cell_types[c])]);
  });
  return types;
}

template <class Array, class Number>
vtkSmartPointer<Array> vtk_copy(const std::vector<Number>& numbers) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetNumberOfValues(static_cast<vtkIdType>(numbers.size()));
  auto* const to = array->GetPointer(0);
  for_each_index(numbers.size(), [&](std::size_t i) { to[i] = static_cast<typename Array::ValueType>(numbers[i]); });
  return array;
}

/// Gives prisms VTK's order of corners: the normal of the first triangle points away from the other one, so that two
/// corners of each are exchanged. All other cells have VTK's order already.
void turn_prisms(VolumeMesh& mesh) {
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    if (mesh.cell_types[c] != CellType::Prism) return;
    std::uint32_t* const corners = mesh.corners.data() + mesh.cell_begin[c];
    std::swap(corners[1], corners[2]);
    std::swap(corners[4], corners[5]);
  });
}

/// The corners of all cells: a view of the mesh's memory if 31 bits, VTK's 32 without the sign, can count them; else a
/// copy.
vtkSmartPointer<vtkCellArray> vtk_corners(const VolumeMesh& mesh) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  if (mesh.points.size() <= kMostInt32 && mesh.corners.size() <= kMostInt32)
    cells->SetData(vtk_copy<vtkTypeInt32Array>(mesh.cell_begin).Get(),
                   vtk_view<vtkTypeInt32Array>(std::span(mesh.corners)).Get());
  else
    cells->SetData(vtk_copy<vtkTypeInt64Array>(mesh.cell_begin).Get(), vtk_copy<vtkTypeInt64Array>(mesh.corners).Get());
  return cells;
}

/// What VTK wants of polyhedra: the list of points, each once, and a stream of faces, which is the mesh's own.
struct FaceStreams {
  vtkSmartPointer<vtkCellArray> points = vtkSmartPointer<vtkCellArray>::New();
  vtkSmartPointer<vtkIdTypeArray> begin = vtkSmartPointer<vtkIdTypeArray>::New();
  vtkSmartPointer<vtkIdTypeArray> faces = vtkSmartPointer<vtkIdTypeArray>::New();
};

void points_of_polyhedron(std::span<const std::uint32_t> stream, std::vector<vtkIdType>& points) {
  points.clear();
  for (std::size_t at = 1; at < stream.size(); at += stream[at] + 1)
    points.insert(points.end(), stream.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                  stream.begin() + static_cast<std::ptrdiff_t>(at) + 1 + stream[at]);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

FaceStreams vtk_face_streams(const VolumeMesh& mesh) {
  FaceStreams result;
  std::vector<vtkIdType> points;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    if (mesh.cell_types[c] == CellType::Polyhedron) {
      points_of_polyhedron(cell, points);
      result.begin->InsertNextValue(result.faces->GetNumberOfValues());
      for (const std::uint32_t number : cell) result.faces->InsertNextValue(number);
    } else {
      points.assign(cell.begin(), cell.end());
      result.begin->InsertNextValue(-1);
    }
    result.points->InsertNextCell(static_cast<vtkIdType>(points.size()), points.data());
  }
  return result;
}

void add_patches(vtkFieldData& data, const VolumeMesh& mesh) {
  const auto names = vtkSmartPointer<vtkStringArray>::New();
  const auto faces = vtkSmartPointer<vtkIntArray>::New();
  names->SetName("patch_names");
  faces->SetName("patch_faces");
  for (const BoundaryPatch& patch : mesh.patches) {
    names->InsertNextValue(patch.name);
    faces->InsertNextValue(static_cast<int>(patch.face_count()));
  }
  data.AddArray(names);
  data.AddArray(faces);
}

}  // namespace

void write_vtu(const WrittenFile& file, VolumeMesh& mesh) {
  turn_prisms(mesh);
  const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(vtk_points(mesh.points));
  if (has_polyhedra(mesh)) {
    const FaceStreams streams = vtk_face_streams(mesh);
    grid->SetCells(vtk_types(mesh), streams.points, streams.begin, streams.faces);
  } else {
    grid->SetCells(vtk_types(mesh), vtk_corners(mesh));
  }
  add_fields(*grid->GetPointData(), mesh.point_fields);
  add_fields(*grid->GetCellData(), mesh.cell_fields);
  if (!mesh.patches.empty()) add_patches(*grid->GetFieldData(), mesh);
  const auto writer = vtkSmartPointer<vtkXMLUnstructuredGridWriter>::New();
  write_vtk(*writer, *grid, file);
}

}  // namespace vdb_offset::io
