#pragma once

#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/pieces.h"

namespace vdb_offset::io {

/// The source as a file of another format, with other positions and, if asked for, other normals where a face moved:
/// all that the format can hold. `result` receives the rest. The pieces refer to `source` and `positions`.
Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Precision& precision,
               Normals normals, WriteResult& result);

}  // namespace vdb_offset::io
