// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/api.h"
#include "vtk/vtk_meshes.h"

const vdb_offset::io::VtkMeshesModule vdb_offset_vtk_meshes = {VDB_OFFSET_VERSION, vdb_offset::io::parse_with_vtk};
