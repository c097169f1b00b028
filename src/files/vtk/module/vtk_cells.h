// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/polygons.h"

class vtkPointSet;

namespace vdb_offset::io {

/// The faces of a data set, and of which of its cells each is.
struct VtkFaces {
  Polygons mesh;                          ///< Its positions are the points.
  std::vector<std::int64_t> cell;         ///< Of each face; several triangles of a strip have one.
  std::size_t others = 0, of_strips = 0;  ///< Cells that are points and lines; faces of strips.
};

/// Reads the faces: polygons, then triangles of strips; or the cells of a grid in their order. Nothing of the data set
/// is believed. \throw InvalidInput for cells that are no faces, and for those of points that there are none of; `path`
/// is for messages.
VtkFaces read_vtk_faces(const std::string& path, vtkPointSet& data);

}  // namespace vdb_offset::io
