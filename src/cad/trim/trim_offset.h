// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/offset_solid.h"

namespace vdb_offset::cad {

/// Trims the offset of a solid whose faces cross, as they do where the offsets of two parts of the source meet: faces
/// are cut along all curves in which they meet, and what is nearer to the source than the distance goes. What is left
/// has to be closed; else the result has no shape, and `gaps` says why.
OffsetCadResult trim_offset(const TopoDS_Shape& source, OffsetCadResult offset, double distance);

}  // namespace vdb_offset::cad
