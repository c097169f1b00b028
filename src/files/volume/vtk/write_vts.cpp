// SPDX-License-Identifier: Apache-2.0
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStructuredGrid.h>
#include <vtkXMLStructuredGridWriter.h>

#include "volume/volume_writers.h"
#include "volume/vtk/vtk_write.h"

namespace vdb_offset::io {

void write_vts(const WrittenFile& file, const StructuredBlock& block) {
  const auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(static_cast<int>(block.ni), static_cast<int>(block.nj), static_cast<int>(block.nk));
  grid->SetPoints(vtk_points(block.points));
  add_fields(*grid->GetPointData(), block.point_fields);
  const auto writer = vtkSmartPointer<vtkXMLStructuredGridWriter>::New();
  write_vtk(*writer, *grid, file);
}

}  // namespace vdb_offset::io
