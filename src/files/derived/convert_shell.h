// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bytes/chunked_output.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// A shell of the source's mesh in another format. Both skins have the source's attributes; those that are the same for
/// all corners of a vertex, or of a border face, go to the rim as well. The pieces refer to `source` and `shell`.
Pieces convert(const MeshFile& source, Format target, const Shell& shell, const Rounding& precision, Normals normals,
               WriteResult& result);

/// A shell of a mesh that comes from no file.
Pieces convert(Format target, const Shell& shell, const Rounding& precision, WriteResult& result);

}  // namespace vdb_offset::io
