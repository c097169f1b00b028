// SPDX-License-Identifier: Apache-2.0
#include "assimp/assimp_meshes.h"
#include "bytes/open_module.h"
#include "document/format_readers.h"
#include "ground/system/memory.h"

namespace vdb_offset::io {

void parse_by_assimp(MeshFile& file) {
  static const auto& module =
      *static_cast<const AssimpModule*>(open_module(file.path, "vdb_offset_assimp", ModuleUse::Read));
  // Its own copy and ours. Here, as the module knows of no limit.
  require_memory(3 * file.text().size(), file.path);
  module.parse(file);
}

}  // namespace vdb_offset::io
