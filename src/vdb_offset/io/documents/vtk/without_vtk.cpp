// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/documents/documents.h"

namespace vdb_offset::io {

void parse_vtk(MeshFile& file) {
  throw ReadError(file.path + ": expected a build with VTK, which reads such files, got one without (VDB_OFFSET_VTK)");
}

}  // namespace vdb_offset::io
