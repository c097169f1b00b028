// SPDX-License-Identifier: Apache-2.0
// Makes a data set of VTK's over a shell of its own faces. Points and cells are copies of those that they come from,
// with all that arrays have for them; inner normals have the other sign, or new values where faces moved. Points and
// lines keep their points, which come first, and stand in front of the faces. Triangles of strips are faces of their
// own. A cell array `part` says of which part a face is, as in a new file, unless one of that name is there.
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>

#include "derived/derived_mesh.h"
#include "vtk/module/vtk_document.h"

namespace vdb_offset::io {
namespace {

class VtkShell {
 public:
  VtkShell(const DerivedMesh& derived, vtkPointSet& from, const std::vector<std::int64_t>& cell)
      : derived_(derived), from_(from), cell_of_(cell), made_(vtkSmartPointer<vtkPointSet>::Take(from.NewInstance())) {}

  vtkSmartPointer<vtkPointSet> run(vtkDataArray* normals, std::vector<std::string>& lost) {
    made_->GetFieldData()->ShallowCopy(from_.GetFieldData());
    add_points();
    if (normals) turn(*made_->GetPointData()->GetArray(normals->GetName()), *normals);
    vtkCellData& cells = *made_->GetCellData();
    cells.CopyAllOn();
    cells.CopyAllocate(from_.GetCellData());
    add_others();
    for (std::uint32_t f = 0; f < derived_.face_count(); ++f) add_face(f);
    put_cells();
    if (std::any_of(cell_of_.begin(), cell_of_.end(),
                    [&](std::int64_t cell) { return from_.GetCellType(cell) == VTK_TRIANGLE_STRIP; }))
      lost.emplace_back("strips of triangles (the triangles are there, as faces)");
    if (from_.GetCellData()->HasArray("part"))
      lost.emplace_back("the parts of the shell (the cell array 'part' is taken)");
    else add_parts();
    return made_;
  }

 private:
  void add_points() {
    const auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetDataType(from_.GetPoints()->GetDataType());
    const auto count = static_cast<vtkIdType>(derived_.mesh().positions.size());
    points->SetNumberOfPoints(count);
    vtkPointData& data = *made_->GetPointData();
    data.CopyAllOn();
    data.CopyAllocate(from_.GetPointData(), count);
    for (std::uint32_t v = 0; v < derived_.mesh().positions.size(); ++v) {
      points->SetPoint(v, derived_.position(v).asPointer());
      data.CopyData(from_.GetPointData(), derived_.origin(v).vertex[0], v);
    }
    made_->SetPoints(points);
  }
  void turn(vtkDataArray& array, vtkDataArray& known) const {
    for (std::uint32_t v = 0; v < derived_.mesh().positions.size(); ++v) {
      Vec3d own;
      known.GetTuple(derived_.origin(v).vertex[0], own.asPointer());
      const auto normal = derived_.new_vertex_normal(v);
      if (normal || derived_.is_inner(v))
        array.SetTuple(v, normal ? normal->asPointer() : (own = Vec3d(0.0) - own).asPointer());
    }
  }

  /// Adds points and lines, with the points that they had.
  void add_others() {
    std::vector<std::uint8_t> is_face(static_cast<std::size_t>(from_.GetNumberOfCells()), 0);
    for (const std::int64_t cell : cell_of_) is_face[static_cast<std::size_t>(cell)] = 1;
    const auto points = vtkSmartPointer<vtkIdList>::New();
    for (vtkIdType cell = 0; cell < from_.GetNumberOfCells(); ++cell) {
      if (is_face[static_cast<std::size_t>(cell)]) continue;
      from_.GetCellPoints(cell, points);
      add_cell(from_.GetCellType(cell), cell, *points);
    }
    others_ = types_->GetNumberOfValues();
  }
  void add_face(std::uint32_t f) {
    const auto corners = derived_.mesh().face(f);
    const auto points = vtkSmartPointer<vtkIdList>::New();
    for (const std::uint32_t v : corners) points->InsertNextId(v);
    add_cell(corners.size() == 3   ? VTK_TRIANGLE
             : corners.size() == 4 ? VTK_QUAD
                                   : VTK_POLYGON,
             cell_of_[derived_.parent(f)], *points);
  }
  void add_cell(int type, vtkIdType like, vtkIdList& points) {
    (type == VTK_VERTEX || type == VTK_POLY_VERTEX ? vertices_
     : type < VTK_TRIANGLE                         ? lines_
                                                   : faces_)
        ->InsertNextCell(&points);
    all_->InsertNextCell(&points);
    made_->GetCellData()->CopyData(from_.GetCellData(), like,
                                   types_->InsertNextValue(static_cast<unsigned char>(type)));
  }
  void put_cells() {
    if (auto* const grid = vtkUnstructuredGrid::SafeDownCast(made_)) return grid->SetCells(types_, all_);
    auto* const polygons = vtkPolyData::SafeDownCast(made_);
    polygons->SetVerts(vertices_);
    polygons->SetLines(lines_);
    polygons->SetPolys(faces_);
  }

  void add_parts() {
    const auto parts = vtkSmartPointer<vtkUnsignedCharArray>::New();
    parts->SetName("part");
    for (vtkIdType cell = 0; cell < others_; ++cell) parts->InsertNextValue(0);
    for (std::uint32_t f = 0; f < derived_.face_count(); ++f)
      parts->InsertNextValue(static_cast<unsigned char>(derived_.part(f)));
    made_->GetCellData()->AddArray(parts);
    const auto names = vtkSmartPointer<vtkStringArray>::New();
    names->SetName("part names");
    for (const ShellPart part : {ShellPart::Outer, ShellPart::Inner, ShellPart::Rim})
      if (derived_.faces_of(part).size() > 0) names->InsertNextValue(name(part));
    made_->GetFieldData()->AddArray(names);
  }

  const DerivedMesh& derived_;
  vtkPointSet& from_;
  const std::vector<std::int64_t>& cell_of_;
  vtkSmartPointer<vtkPointSet> made_;
  vtkNew<vtkCellArray> vertices_, lines_, faces_, all_;
  vtkNew<vtkUnsignedCharArray> types_;
  vtkIdType others_ = 0;
};

}  // namespace

WrittenDocument VtkDocument::derive(const SharedDerived& derived, const std::string& path) const {
  std::vector<std::string> lost;
  const vtkSmartPointer<vtkPointSet> made = VtkShell(*derived, *data_, cell_).run(normals(), lost);
  WrittenDocument written = as_new_file(*made, path);
  lost.insert(lost.end(), written.lost.begin(), written.lost.end());
  written.lost = std::move(lost);
  return written;
}

}  // namespace vdb_offset::io
