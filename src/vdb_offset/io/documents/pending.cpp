// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/documents/documents.h"

namespace vdb_offset::io {
void parse_gltf(MeshFile& f) { throw InvalidInput(f.path + ": pending"); }
Pieces to_glb(const SharedContent&) { throw InvalidInput("pending"); }
Pieces to_gltf(const SharedContent&) { throw InvalidInput("pending"); }
}  // namespace vdb_offset::io
