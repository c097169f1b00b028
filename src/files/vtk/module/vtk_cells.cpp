// SPDX-License-Identifier: Apache-2.0
// Takes the faces out of a data set that VTK has read, and believes nothing of it: offsets of cells have to rise within
// their corners, corners have to be points that are there, each cell needs a type, and positions have to be finite. Of
// polygons the faces come first and then the triangles of strips; of a grid all cells come in their order. Every other
// triangle of a strip is turned round, and the corners of pixels are put in order around them. Points and lines are
// counted and passed over; cells of any other type, as solids and curved faces, are refused with their number. For each
// face the number of its cell is kept, as names of faces are found by it. Points that no face uses stay.
#include "vtk/module/vtk_cells.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <span>
#include <string>

#include "document/require_format.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// The cells of an array of VTK's, without its own functions, which believe what they find.
class VtkCells {
 public:
  VtkCells(const std::string& path, vtkCellArray* cells, vtkIdType points)
      : path_(path), cells_(*cells), points_(points), count_(cells->GetNumberOfCells()) {
    const vtkIdType corners = cells_.GetConnectivityArray()->GetNumberOfValues();
    vtkIdType last = 0;
    for (vtkIdType i = 0; i <= count_ && cells_.GetOffsetsArray()->GetNumberOfValues() > i; ++i) {
      const vtkIdType offset = this->offset(i);
      if (offset < last || offset > corners)
        throw InvalidInput(
            fmt::format("{}: expected cells whose corners follow each other, got corner {} behind {} of {}", path_,
                        offset, last, corners));
      last = offset;
    }
  }

  vtkIdType count() const { return count_; }

  /// The corners of a cell, valid until the next call.
  std::span<const std::uint32_t> corners(vtkIdType cell) {
    corners_.clear();
    for (vtkIdType i = offset(cell); i < offset(cell + 1); ++i) {
      const vtkIdType point = cells_.IsStorage64Bit()
                                  ? static_cast<vtkIdType>(cells_.GetConnectivityArray64()->GetValue(i))
                                  : cells_.GetConnectivityArray32()->GetValue(i);
      if (point < 0 || point >= points_)
        throw InvalidInput(
            fmt::format("{}: cell {}: expected points from 0 to {}, got {}", path_, cell, points_ - 1, point));
      corners_.push_back(static_cast<std::uint32_t>(point));
    }
    return corners_;
  }

 private:
  vtkIdType offset(vtkIdType i) const {
    return cells_.IsStorage64Bit() ? static_cast<vtkIdType>(cells_.GetOffsetsArray64()->GetValue(i))
                                   : cells_.GetOffsetsArray32()->GetValue(i);
  }

  const std::string& path_;
  vtkCellArray& cells_;
  vtkIdType points_, count_;
  std::vector<std::uint32_t> corners_;
};

class FaceCollector {
 public:
  FaceCollector(const std::string& path, VtkFaces& faces) : path_(path), faces_(faces) {}

  void add_polygon(std::span<const std::uint32_t> corners, vtkIdType cell) {
    if (corners.size() < 3)
      throw InvalidInput(
          fmt::format("{}: cell {}: expected a face of 3 corners or more, got {}", path_, cell, corners.size()));
    faces_.mesh.corners.insert(faces_.mesh.corners.end(), corners.begin(), corners.end());
    faces_.mesh.close_face();
    faces_.cell.push_back(cell);
  }
  void add_strip(std::span<const std::uint32_t> corners, vtkIdType cell) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const std::uint32_t turned[] = {corners[k - 2 + k % 2], corners[k - 1 - k % 2], corners[k]};
      add_polygon(turned, cell);
      ++faces_.of_strips;
    }
  }

 private:
  const std::string& path_;
  VtkFaces& faces_;
};

void add_cells_of(const std::string& path, vtkPolyData& data, VtkFaces& faces) {
  FaceCollector collector(path, faces);
  const vtkIdType points = data.GetNumberOfPoints();
  faces.others = static_cast<std::size_t>(data.GetNumberOfVerts() + data.GetNumberOfLines());
  auto cell = static_cast<vtkIdType>(faces.others);
  VtkCells polygons(path, data.GetPolys(), points), strips(path, data.GetStrips(), points);
  for (vtkIdType i = 0; i < polygons.count(); ++i) collector.add_polygon(polygons.corners(i), cell++);
  for (vtkIdType i = 0; i < strips.count(); ++i) collector.add_strip(strips.corners(i), cell++);
}

void add_cells_of(const std::string& path, vtkUnstructuredGrid& data, VtkFaces& faces) {
  if (!data.GetCells() || !data.GetCellTypesArray()) return;
  FaceCollector collector(path, faces);
  VtkCells cells(path, data.GetCells(), data.GetNumberOfPoints());
  const vtkUnsignedCharArray& types = *data.GetCellTypesArray();
  if (types.GetNumberOfValues() < cells.count())
    throw InvalidInput(fmt::format("{}: expected a type for each of {} cells, got {}", path, cells.count(),
                                   types.GetNumberOfValues()));
  for (vtkIdType i = 0; i < cells.count(); ++i) {
    const int type = const_cast<vtkUnsignedCharArray&>(types).GetValue(i);
    const auto corners = cells.corners(i);
    if (type >= VTK_VERTEX && type <= VTK_POLY_LINE) {
      ++faces.others;
    } else if (type == VTK_TRIANGLE_STRIP) {
      collector.add_strip(corners, i);
    } else if (type == VTK_PIXEL && corners.size() == 4) {
      const std::uint32_t around[] = {corners[0], corners[1], corners[3], corners[2]};
      collector.add_polygon(around, i);
    } else if (type == VTK_TRIANGLE || type == VTK_POLYGON || type == VTK_QUAD) {
      collector.add_polygon(corners, i);
    } else {
      throw InvalidInput(fmt::format(
          "{}: cell {}: expected a face of straight edges (a triangle, a quad or a polygon), got VTK's type {}{}", path,
          i, type, type == VTK_TETRA || type == VTK_HEXAHEDRON || type == VTK_WEDGE ? ", a solid" : ""));
    }
  }
}

}  // namespace

VtkFaces read_vtk_faces(const std::string& path, vtkPointSet& data) {
  VtkFaces faces;
  vtkPoints* const points = data.GetPoints();
  const vtkIdType count = points ? points->GetNumberOfPoints() : 0;
  if (count > static_cast<vtkIdType>(kMostVertices))
    throw InvalidInput(fmt::format("{}: expected at most {} points, got {}", path, kMostVertices, count));
  faces.mesh.positions.resize(static_cast<std::size_t>(count));
  for (vtkIdType v = 0; v < count; ++v) {
    Vec3d& position = faces.mesh.positions[static_cast<std::size_t>(v)];
    points->GetPoint(v, position.asPointer());
    if (!position.isFinite())
      throw InvalidInput(fmt::format("{}: point {}: expected finite numbers, got {}, {}, {}", path, v, position[0],
                                     position[1], position[2]));
  }
  if (auto* const polygons = vtkPolyData::SafeDownCast(&data)) add_cells_of(path, *polygons, faces);
  else add_cells_of(path, *vtkUnstructuredGrid::SafeDownCast(&data), faces);
  if (faces.cell.empty()) throw InvalidInput(path + ": expected a mesh of at least one face, got none");
  return faces;
}

}  // namespace vdb_offset::io
