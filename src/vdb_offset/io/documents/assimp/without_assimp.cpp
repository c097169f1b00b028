// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/documents/documents.h"

namespace vdb_offset::io {

void parse_by_assimp(MeshFile& file) {
  throw ReadError(file.path +
                  ": expected a build with Assimp, which reads such files, got one without (VDB_OFFSET_ASSIMP)");
}

}  // namespace vdb_offset::io
