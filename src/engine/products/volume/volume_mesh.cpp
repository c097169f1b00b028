// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cells.h"

namespace vdb_offset {

const char* name(CellType type) {
  constexpr const char* kNames[kCellTypeCount] = {"tetrahedra", "pyramids",  "prisms",        "hexahedra",
                                                  "polyhedra",  "triangles", "quadrilaterals"};
  return kNames[static_cast<std::size_t>(type)];
}

bool VolumeMesh::plane() const { return normal.lengthSqr() > 0; }

}  // namespace vdb_offset
