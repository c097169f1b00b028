// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "support/folder.h"
#include "vdb_offset/cells.h"

namespace vdb_offset::test {

using CornerList = std::vector<std::uint32_t>;

void add_cell(VolumeMesh& mesh, CellType type, const CornerList& corners);

/// The faces of a cell, seen from outside ccw.
std::vector<CornerList> faces_of(CellType type, std::span<const std::uint32_t> cell);

/// Two cubes one above the other with two prisms beside them, a pyramid on the upper cube, and two tetrahedra on the
/// pyramid, one of which stands on the upper prism, too. Cells are in no order.
VolumeMesh mixed_cells();

/// mixed_cells() with cubes and prisms as polyhedra.
VolumeMesh with_polyhedra();

/// Faces seen from outside ccw make a cell: they close it, and the volume is positive; it is returned.
double volume_of(const std::vector<Vec3d>& points, const std::vector<CornerList>& faces);

std::vector<double> volumes_of(const VolumeMesh& mesh);

bool installed(const std::string& program);

/// What a program prints; it must end well.
std::string output_of(const Folder& folder, const std::string& command);

/// What OpenFOAM's checkMesh prints of a mesh, the folder's subfolder of this name.
std::string check_mesh_of(const Folder& folder, const std::string& name);

/// Has OpenFOAM's gmshToFoam make that subfolder of a text of Gmsh's version 2.2, its cells as they are.
void gmsh_to_foam(const Folder& folder, const std::string& msh, const std::string& name);

}  // namespace vdb_offset::test
