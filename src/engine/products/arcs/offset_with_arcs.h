// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/offset.h"

namespace vdb_offset {

/// What offset_to_tolerance() does with Corners::Arc.
RefinedOffset offset_with_arcs(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance);

}  // namespace vdb_offset
