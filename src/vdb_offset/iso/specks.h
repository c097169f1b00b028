#pragma once

#include <cstddef>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Takes away the pieces of a closed mesh, joined over vertices, which enclose less than a volume (world units^3), as
/// cavities do too; the largest one stays in any case. Vertices keep their numbers, and may be left without a face.
/// Returns how many pieces there were.
std::size_t drop_specks(Polygons& mesh, double volume);

}  // namespace vdb_offset
