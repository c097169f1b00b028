// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "products/curves/curve_faults.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Measures how far the segments of an offset are off their distance, at points evenly spread over their length: what
/// measure_faces() does for meshes. The result does not depend on the number of threads.
/// \param positions of the polyline's vertices, in the plane
/// \param states of the polyline's vertices; empty: none falls short
FaceError measure_segments(const PlaneCurves& curves, std::span<const Vec2d> positions,
                           std::span<const VertexState> states);

}  // namespace vdb_offset
