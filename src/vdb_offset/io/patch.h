#pragma once

#include <span>

#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/pieces.h"

namespace vdb_offset::io {

/// The source's own bytes, with other coordinates where a vertex moved and, if asked for, other normals where a face
/// did. The pieces refer to `source` and `positions`. `disagreeing` becomes the number of OBJ normals whose vertices
/// ask for different ones now; they get the mean.
Pieces patch(const MeshFile& source, std::span<const Vec3d> positions, const Precision& precision, Normals normals,
             std::size_t& disagreeing);

}  // namespace vdb_offset::io
