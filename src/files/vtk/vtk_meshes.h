// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// What reads the meshes of VTK's files with VTK itself: a module (see bytes/open_module.h).
struct VtkMeshesModule {
  const char* version;
  void (*parse)(MeshFile&);
};

/// As parse_vtk(), inside the module.
void parse_with_vtk(MeshFile& file);

}  // namespace vdb_offset::io

// NOLINTNEXTLINE(readability-identifier-naming): found by its module's name
extern "C" VDB_OFFSET_API const vdb_offset::io::VtkMeshesModule vdb_offset_vtk_meshes;
