// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/openmesh.h"

#include <string>

#include "vdb_offset/run.h"

namespace vdb_offset::detail {

void refuse_deleted() {
  throw InvalidInput("mesh: expected no deleted elements, got some (call garbage_collection() before)");
}

void refuse_face(std::size_t face) {
  throw InvalidInput("mesh: expected a face that a half-edge mesh can hold, got face " + std::to_string(face) +
                     " (non-manifold or oriented against its neighbours; use spans instead)");
}

}  // namespace vdb_offset::detail
