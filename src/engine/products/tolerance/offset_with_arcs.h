// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/offset.h"

namespace vdb_offset {

/// What offset_to_tolerance() does with Corners::Arc. \pre some vertex moves; `options` are those of miters, which
/// vertices have that are not opened, and have no exact surface
RefinedOffset offset_with_arcs(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance);

}  // namespace vdb_offset
