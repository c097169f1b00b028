// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// What reads meshes with Assimp: a module (see bytes/open_module.h).
struct AssimpModule {
  const char* version;
  void (*parse)(MeshFile&);
};

/// As parse_by_assimp(), inside the module.
void parse_with_assimp(MeshFile& file);

}  // namespace vdb_offset::io

// NOLINTNEXTLINE(readability-identifier-naming): found by its module's name
extern "C" VDB_OFFSET_API const vdb_offset::io::AssimpModule vdb_offset_assimp;
