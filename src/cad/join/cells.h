// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/offset_solid.h"

namespace vdb_offset::cad {

/// The offset of a solid from the cells into which the enlarged offsets of its faces divide space: those that lie
/// within the offset are joined. For solids whose offset has another topology; takes no notice of the source's. \throw
/// Standard_Failure
OffsetCadResult cells_offset(const OffsetCadRequest& request);

}  // namespace vdb_offset::cad
