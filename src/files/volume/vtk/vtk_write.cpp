// SPDX-License-Identifier: Apache-2.0
#include "volume/vtk/vtk_write.h"

#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkXMLWriter.h>

#include "vdb_offset/error.h"

namespace vdb_offset::io {
namespace {

/// Keeps VTK from printing errors while it lives. The setting is one for the whole program, and is put back.
struct QuietVtk {
  int before = vtkObject::GetGlobalWarningDisplay();
  QuietVtk() { vtkObject::GlobalWarningDisplayOff(); }
  QuietVtk(const QuietVtk&) = delete;
  QuietVtk& operator=(const QuietVtk&) = delete;
  ~QuietVtk() { vtkObject::SetGlobalWarningDisplay(before); }
};

}  // namespace

vtkSmartPointer<vtkPoints> vtk_points(std::span<const Vec3d> points) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  const std::span numbers(points.empty() ? nullptr : points.front().asPointer(), 3 * points.size());
  const auto array = vtk_view<vtkDoubleArray>(std::span<const double>(numbers));
  array->SetNumberOfComponents(3);
  auto result = vtkSmartPointer<vtkPoints>::New();
  result->SetData(array);
  return result;
}

void add_fields(vtkDataSetAttributes& attributes, const std::vector<VolumeField>& fields) {
  for (const VolumeField& field : fields) {
    if (field.values.empty()) continue;
    const auto array = vtk_view<vtkFloatArray>(std::span(field.values));
    array->SetName(field.name.c_str());
    attributes.AddArray(array);
  }
}

void write_vtk(vtkXMLWriter& writer, vtkDataSet& data, const WrittenFile& file) {
  const QuietVtk quiet;
  writer.SetInputDataObject(&data);
  writer.SetDataModeToAppended();
  writer.EncodeAppendedDataOff();
  writer.SetHeaderTypeToUInt64();
  writer.SetCompressorTypeToLZ4();
  // Larger blocks than VTK's 32 KiB, in which a compressor finds little. Not measured beside other sizes.
  writer.SetBlockSize(1 << 20);
  writer.SetFileName(file.temporary.c_str());
  if (writer.Write() == 0 || writer.GetErrorCode() != vtkErrorCode::NoError)
    throw WriteError(file.path + ": cannot be written: " + vtkErrorCode::GetStringFromErrorCode(writer.GetErrorCode()));
}

}  // namespace vdb_offset::io
