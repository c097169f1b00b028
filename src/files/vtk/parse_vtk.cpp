// SPDX-License-Identifier: Apache-2.0
#include "bytes/open_module.h"
#include "document/format_readers.h"
#include "ground/system/memory.h"
#include "vtk/vtk_meshes.h"

namespace vdb_offset::io {

void parse_vtk(MeshFile& file) {
  static const auto& module =
      *static_cast<const VtkMeshesModule*>(open_module(file.path, "vdb_offset_vtk_meshes", ModuleUse::Read));
  // VTK's copy of the text, its arrays and ours. Here, as the module knows of no limit.
  require_memory(3 * file.text().size(), file.path);
  module.parse(file);
}

}  // namespace vdb_offset::io
