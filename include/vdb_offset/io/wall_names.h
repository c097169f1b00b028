// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/patch_names.h"

namespace vdb_offset::io {

/// What a file calls its faces. OBJ: by groups, a line's names joined by _; by materials if no face is in a group, and
/// by objects if none has a material either. ASCII STL: by solids. Names are in the order of their first faces; faces
/// without one are "wall". None if the file names nothing.
VDB_OFFSET_API WallNames wall_names(const MeshFile& mesh);

}  // namespace vdb_offset::io
