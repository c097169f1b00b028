// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Takes away the pieces of a closed mesh, connected over vertices, that enclose less than a volume (world units^3),
/// small cavities included; the largest piece stays in any case. Vertices keep their numbers, and may be left without a
/// face. Returns the number of pieces taken away.
std::size_t drop_specks(Polygons& mesh, double volume);

}  // namespace vdb_offset
