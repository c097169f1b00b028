// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkSmartPointer.h>

#include <span>
#include <vector>

#include "vdb_offset/volume_mesh.h"
#include "volume/volume_writers.h"

class vtkDataSet;
class vtkDataSetAttributes;
class vtkPoints;
class vtkXMLWriter;

namespace vdb_offset::io {

/// A view of numbers as VTK's array. \pre the numbers outlive it; VTK never writes to them.
template <class Array, class Number>
vtkSmartPointer<Array> vtk_view(std::span<const Number> numbers) {
  using Value = typename Array::ValueType;
  static_assert(sizeof(Number) == sizeof(Value));
  auto array = vtkSmartPointer<Array>::New();
  auto* const memory = const_cast<Number*>(numbers.data());  // NOLINT: VTK knows no arrays of constants.
  array->SetArray(reinterpret_cast<Value*>(memory), static_cast<vtkIdType>(numbers.size()), 1);
  return array;
}

/// Points as VTK has them: a view, as vtk_view().
vtkSmartPointer<vtkPoints> vtk_points(std::span<const Vec3d> points);
/// Adds fields to a data set, as views.
void add_fields(vtkDataSetAttributes& attributes, const std::vector<VolumeField>& fields);

/// Writes `data`: raw appended, compressed. VTK prints nothing. \throw WriteError
void write_vtk(vtkXMLWriter& writer, vtkDataSet& data, const WrittenFile& file);

}  // namespace vdb_offset::io
